#include "detect/candidates.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace chromeball::detecting {
namespace {

constexpr int kLongestSearched = 1200;   // long side of the finest level that is searched
constexpr double kSmallestRadius = 6.5;  // of that level; below, a rim is all corners
constexpr double kOtherSmallest = 12;    // of the coarser ones, where the finer one saw it already
constexpr double kFinestLargest = 34;    // it is the costly one
constexpr double kLargestRadius = 68;    // by then a coarser level sees it too
constexpr double kRadiusStep = 1.12;
constexpr double kCentreSpread = 0.09;  // of the radius: half a radius step and a slight ellipse
constexpr float kLeastWeight = 0.35f;   // an edge weaker than its surroundings
constexpr double kLeastVotes = 0.2;
constexpr std::size_t kSeedsALevel = 40;
constexpr std::size_t kSeeds = 160;

struct Edge {
    float x, y;    // continuous position in the level
    float nx, ny;  // unit gradient
    float weight;
};

/// Thinned edges. Their weight compares the gradient with the neighbourhood's, not with one global
/// threshold: a weak rim before a plain wall counts as much as a strong one among leaves.
std::vector<Edge> edges_of(const Level& level) {
    const Size size = level.grey.size;
    const cv::Mat grey(size.height, size.width, CV_32F,
                       const_cast<float*>(level.grey.values.data()));
    cv::Mat smooth, gx, gy, strength, around;
    cv::GaussianBlur(grey, smooth, cv::Size(5, 5), 0.9);
    cv::Sobel(smooth, gx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(smooth, gy, CV_32F, 0, 1, 3, 0.125);
    cv::magnitude(gx, gy, strength);
    cv::blur(strength, around, cv::Size(15, 15));

    std::vector<Edge> edges;
    for (int y = 1; y + 1 < size.height; ++y) {
        const float* here = strength.ptr<float>(y);
        for (int x = 1; x + 1 < size.width; ++x) {
            const float m = here[x];
            if (m < level.noise) continue;
            const float nx = gx.at<float>(y, x) / m, ny = gy.at<float>(y, x) / m;
            const int dx = nx > 0.38f ? 1 : nx < -0.38f ? -1 : 0;
            const int dy = ny > 0.38f ? 1 : ny < -0.38f ? -1 : 0;
            if (strength.at<float>(y + dy, x + dx) > m || strength.at<float>(y - dy, x - dx) >= m)
                continue;
            const float weight = m / (m + 0.5f * around.at<float>(y, x) + level.noise);
            if (weight < kLeastWeight) continue;
            edges.push_back(
                {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, nx, ny, weight});
        }
    }
    return edges;
}

/// The votes of one radius on a grid of half the level's resolution, with a margin for centres
/// outside the picture.
class Ballot {
public:
    Ballot(Size level, double radius) : radius_(radius), margin_(0.6 * radius) {
        const auto cells = [&](int n) { return static_cast<int>((n + 2 * margin_) / 2) + 1; };
        votes_ = cv::Mat::zeros(cells(level.height), cells(level.width), CV_32F);
    }

    void count(const std::vector<Edge>& edges) {
        const auto r = static_cast<float>(radius_), m = static_cast<float>(margin_);
        for (const Edge& e : edges)
            for (const float side : {-r, r}) {
                const int x = static_cast<int>(std::floor((e.x + side * e.nx + m) * 0.5f));
                const int y = static_cast<int>(std::floor((e.y + side * e.ny + m) * 0.5f));
                if (x >= 0 && y >= 0 && x < votes_.cols && y < votes_.rows)
                    votes_.at<float>(y, x) += e.weight;
            }
    }

    /// Local maxima, in pixels of the level.
    std::vector<Seed> peaks() const {
        const int spread = std::max(1, static_cast<int>(std::lround(kCentreSpread * radius_ / 2)));
        cv::Mat sum, soft;
        const int k = 2 * spread + 1;
        cv::boxFilter(votes_, sum, CV_32F, cv::Size(k, k), cv::Point(-1, -1), false,
                      cv::BORDER_CONSTANT);
        cv::blur(sum, soft, cv::Size(3, 3));
        std::vector<Seed> found;
        const double full = 2 * std::numbers::pi * radius_ * 0.55;  // a clean edge weighs about .55
        const auto least = static_cast<float>(kLeastVotes * full);
        for (int y = 1; y + 1 < soft.rows; ++y) {
            const float *above = soft.ptr<float>(y - 1), *here = soft.ptr<float>(y),
                        *below = soft.ptr<float>(y + 1);
            for (int x = 1; x + 1 < soft.cols; ++x) {
                const float v = here[x];
                if (v < least || v < here[x - 1] || v <= here[x + 1] || v < above[x] ||
                    v <= below[x])
                    continue;
                found.push_back({2 * x + 1 - margin_, 2 * y + 1 - margin_, radius_, v / full});
            }
        }
        return found;
    }

private:
    double radius_;
    double margin_;
    cv::Mat votes_;
};

bool alike(const Seed& one, const Seed& other) {
    const double r = std::min(one.radius, other.radius);
    return std::hypot(one.x - other.x, one.y - other.y) < 0.12 * r &&
           std::abs(one.radius - other.radius) < 0.08 * r;
}

void keep_best(std::vector<Seed>& seeds, std::size_t most) {
    std::stable_sort(seeds.begin(), seeds.end(),
                     [](const Seed& a, const Seed& b) { return a.votes > b.votes; });
    std::vector<Seed> kept;
    for (const Seed& seed : seeds) {
        if (kept.size() == most) break;
        if (std::none_of(kept.begin(), kept.end(), [&](const Seed& k) { return alike(k, seed); }))
            kept.push_back(seed);
    }
    seeds = std::move(kept);
}

}  // namespace

std::vector<Seed> find_seeds(const std::vector<Level>& levels,
                             const std::optional<std::array<double, 2>>& radii,
                             const Watch& watch) {
    const auto wanted = [&](double radius) {
        return !radii || (radius > (*radii)[0] / kRadiusStep && radius < (*radii)[1] * kRadiusStep);
    };
    std::vector<Seed> all;
    bool finest = true;
    for (const Level& level : levels) {
        const int longest = std::max(level.grey.size.width, level.grey.size.height);
        if (longest > kLongestSearched && &level != &levels.back()) continue;
        watch.check();
        const double largest = std::min(finest ? kFinestLargest : kLargestRadius, 0.9 * longest);
        std::vector<double> sizes;
        for (double r = finest ? kSmallestRadius : kOtherSmallest; r < largest; r *= kRadiusStep)
            if (wanted(r * level.scale())) sizes.push_back(r);
        finest = false;
        if (sizes.empty()) continue;
        const auto edges = edges_of(level);
        std::vector<Seed> seeds;
        for (const double r : sizes) {
            Ballot ballot(level.grey.size, r);
            ballot.count(edges);
            const auto found = ballot.peaks();
            seeds.insert(seeds.end(), found.begin(), found.end());
        }
        keep_best(seeds, kSeedsALevel);
        for (Seed& seed : seeds)
            all.push_back({seed.x * level.scale_x, seed.y * level.scale_y,
                           seed.radius * level.scale(), seed.votes});
    }
    keep_best(all, kSeeds);
    return all;
}

}  // namespace chromeball::detecting
