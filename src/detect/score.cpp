#include "detect/score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/statistics.h"

namespace chromeball::detecting {
namespace {

constexpr int kRings = 5;  // of equal area
constexpr int kSectors = 12;

/// Part of the radius within which the rim's own blur does not reach.
double inside_of(const Outline& o) { return std::min(0.95, 1 - 3 / o.b); }

/// Running mean and mean square.
struct Moments {
    double weight = 0, sum = 0, squares = 0;
    void add(double v) { weight += 1, sum += v, squares += v * v; }
    double mean() const { return weight > 0 ? sum / weight : 0; }
    double variance() const {
        return weight > 0 ? std::max(0.0, squares / weight - mean() * mean()) : 0;
    }
    double rms() const { return weight > 0 ? std::sqrt(squares / weight) : 0; }
};

/// The level around an outline: grey, its fine structure and its slopes.
struct Patch {
    cv::Rect box;
    cv::Mat grey, fine, gx, gy;
    cv::Mat soft;  ///< strength of the slopes when blurred
};

Patch patch_of(const Level& level, const Outline& o) {
    const double reach = 1.35 * o.a + 3;
    const cv::Rect all(0, 0, level.grey.size.width, level.grey.size.height);
    Patch patch;
    const int left = static_cast<int>(std::floor(o.cx - reach));
    const int top = static_cast<int>(std::floor(o.cy - reach));
    const int side = static_cast<int>(std::ceil(2 * reach));
    patch.box = cv::Rect(left, top, side, side) & all;
    if (patch.box.empty()) return patch;
    const cv::Mat whole(all.height, all.width, CV_32F,
                        const_cast<float*>(level.grey.values.data()));
    patch.grey = whole(patch.box);
    cv::Mat coarse, smooth;
    cv::GaussianBlur(patch.grey, coarse, cv::Size(0, 0), std::max(1.5, 0.04 * o.b));
    cv::GaussianBlur(patch.grey, smooth, cv::Size(3, 3), 0.7);
    patch.fine = smooth - coarse;
    cv::Sobel(smooth, patch.gx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(smooth, patch.gy, CV_32F, 0, 1, 3, 0.125);
    cv::Mat softer, sx, sy;
    cv::GaussianBlur(patch.grey, softer, cv::Size(11, 11), 2);
    cv::Sobel(softer, sx, CV_32F, 1, 0, 3, 0.125);
    cv::Sobel(softer, sy, CV_32F, 0, 1, 3, 0.125);
    cv::magnitude(sx, sy, patch.soft);
    return patch;
}

/// What is counted in one part of the inside.
struct Cell {
    Moments grey, fine, radial, tangential;
};

/// The patch sorted into cells of the disk, and sectors outside of it.
struct Survey {
    std::array<std::array<Cell, kSectors>, kRings> cells;
    std::array<Moments, kSectors> rim_inside, rim_outside;
    std::vector<float> greys;
};

Survey survey_of(const Patch& patch, const Outline& o) {
    Survey survey;
    const double inside = inside_of(o), gap = std::max(1.5, 0.03 * o.b);
    const double c = std::cos(o.angle * std::numbers::pi / 180);
    const double s = std::sin(o.angle * std::numbers::pi / 180);
    for (int y = 0; y < patch.box.height; ++y)
        for (int x = 0; x < patch.box.width; ++x) {
            const double dx = patch.box.x + x + 0.5 - o.cx, dy = patch.box.y + y + 0.5 - o.cy;
            const double u = (c * dx + s * dy) / o.a, v = (c * dy - s * dx) / o.b;
            const double rho2 = u * u + v * v;
            if (rho2 > 1.7) continue;
            const double rho = std::sqrt(rho2), turn = std::atan2(dy, dx);
            const int sector =
                std::clamp(static_cast<int>((turn / (2 * std::numbers::pi) + 0.5) * kSectors), 0,
                           kSectors - 1);
            const auto k = static_cast<std::size_t>(sector);
            const double grey = patch.grey.at<float>(y, x), fine = patch.fine.at<float>(y, x);
            const double off = (rho - 1) * o.b;
            if (off > gap && off < 3 * gap) survey.rim_outside[k].add(grey);
            if (off < -gap && off > -3 * gap) survey.rim_inside[k].add(grey);
            if (rho >= inside) continue;
            survey.greys.push_back(static_cast<float>(grey));
            const int ring =
                std::min(kRings - 1, static_cast<int>(kRings * rho * rho / (inside * inside)));
            Cell& cell = survey.cells[static_cast<std::size_t>(ring)][k];
            cell.grey.add(grey);
            cell.fine.add(fine);
            const double r = std::max(std::hypot(dx, dy), 1e-6);
            const double gx = patch.gx.at<float>(y, x), gy = patch.gy.at<float>(y, x);
            cell.radial.add((gx * dx + gy * dy) / r);
            cell.tangential.add((gy * dx - gx * dy) / r);
        }
    return survey;
}

double range_of(std::vector<float>& values) {
    if (values.size() < 10) return 0;
    const auto at = [&](double part) {
        const auto i = values.begin() +
                       static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
        std::nth_element(values.begin(), i, values.end());
        return *i;
    };
    const float low = at(0.05);
    return at(0.95) - low;
}

/// What is left of a slope's or a detail's size without the part that noise makes.
double without(double rms, double noise) {
    return std::sqrt(std::max(rms * rms - noise * noise, 0.25 * noise * noise));
}

/// Radial over tangential slopes of one ring: median over sectors, so that one lamp or one stand
/// does not decide.
double squeeze_of(const std::array<Cell, kSectors>& ring, double noise) {
    std::vector<double> ratios;
    for (const Cell& cell : ring)
        if (cell.grey.weight > 3)
            ratios.push_back(std::log2(without(cell.radial.rms(), noise) /
                                       without(cell.tangential.rms(), noise)));
    return median(ratios);
}

/// How alike the edges inside are. Something painted has few tones, and so edges of one strength
/// (half as strong in the shade); the world has edges of all strengths.
struct Edges {
    double sameness = 1, crispness = 0;
};
Edges edges_of(const Patch& patch, const Outline& o, double least) {
    std::vector<double> strengths, ratios;
    const auto strength = [&](int x, int y) {
        return std::hypot(patch.gx.at<float>(y, x), patch.gy.at<float>(y, x));
    };
    for (int y = 1; y + 1 < patch.box.height; ++y)
        for (int x = 1; x + 1 < patch.box.width; ++x) {
            const double dx = patch.box.x + x + 0.5 - o.cx, dy = patch.box.y + y + 0.5 - o.cy;
            if (std::hypot(dx, dy) > 0.85 * o.b) continue;
            const double m = strength(x, y);
            if (m < least) continue;
            const double nx = patch.gx.at<float>(y, x) / m, ny = patch.gy.at<float>(y, x) / m;
            const int ix = nx > 0.38 ? 1 : nx < -0.38 ? -1 : 0;
            const int iy = ny > 0.38 ? 1 : ny < -0.38 ? -1 : 0;
            if (strength(x + ix, y + iy) <= m && strength(x - ix, y - iy) < m) {
                strengths.push_back(m);
                ratios.push_back(m / std::max<double>(patch.soft.at<float>(y, x), 0.1 * m));
            }
        }
    if (strengths.size() < 20) return {};
    // Of the stronger half of the edges: weak ones are noise and gentle shading.
    std::vector<double> sorted = strengths, strong;
    std::sort(sorted.begin(), sorted.end());
    const double middle = sorted[sorted.size() / 2];
    for (std::size_t i = 0; i < ratios.size(); ++i)
        if (strengths[i] >= middle) strong.push_back(ratios[i]);
    return {middle / sorted[sorted.size() * 95 / 100], std::log2(median(strong))};
}

/// Variance between rings over all variance between cells.
double rings_of(const Survey& survey) {
    Moments all, between;
    for (const auto& ring : survey.cells) {
        Moments own;
        for (const Cell& cell : ring)
            if (cell.grey.weight > 3) own.add(cell.grey.mean()), all.add(cell.grey.mean());
        if (own.weight > 0) between.add(own.mean());
    }
    return all.variance() > 0 ? between.variance() / all.variance() : 1;
}

}  // namespace

Evidence evidence_of(const Level& level, const Outline& outline, const Rim& rim) {
    Evidence e;
    e.rim = rim;
    e.radius = std::sqrt(outline.a * outline.b);
    e.noise = level.noise;
    const Patch patch = patch_of(level, outline);
    if (patch.box.width < 8 || patch.box.height < 8) return e;
    Survey survey = survey_of(patch, outline);
    e.contrast = range_of(survey.greys);

    // White noise of 1 comes out of the smoothing and differences of patch_of() as about these.
    const double fine_noise = 0.45 * e.noise, slope_noise = 0.25 * e.noise;
    const Edges edges = edges_of(patch, outline, 3 * slope_noise + 0.01 * e.contrast);
    e.sameness = edges.sameness;
    e.crispness = edges.crispness;
    std::vector<double> fine;
    for (const auto& ring : survey.cells)
        for (const Cell& cell : ring)
            if (cell.grey.weight > 3) fine.push_back(cell.fine.rms());
    e.detail = median(fine);
    const double least = 0.02 * e.contrast + 1.5 * fine_noise;
    const auto sharp = std::count_if(fine.begin(), fine.end(), [&](double f) { return f > least; });
    e.detailed = fine.empty() ? 0 : static_cast<double>(sharp) / static_cast<double>(fine.size());
    e.squeeze = squeeze_of(survey.cells[kRings - 1], slope_noise);
    e.squeeze_before = squeeze_of(survey.cells[kRings - 2], slope_noise);
    e.rings = rings_of(survey);

    Moments steps;
    for (std::size_t k = 0; k < kSectors; ++k)
        if (survey.rim_inside[k].weight > 3 && survey.rim_outside[k].weight > 3)
            steps.add(survey.rim_inside[k].mean() - survey.rim_outside[k].mean());
    e.step = steps.rms() / std::max(e.contrast, 1e-6);
    return e;
}

namespace {

/// Log2 of a soft step from 0 to 1 that is a half at `half`.
double gate(double value, double half, double width) {
    return -std::log2(1 + std::exp(std::min(-(value - half) / width, 20.0)));
}

/// What a mirror ball shows all at once: log2 of soft steps, 0 where it does. The halves lie about
/// half-way between what mirror balls and other round things show, in logarithms where the quantity
/// is a ratio.
std::array<double, kGates> gates_of(const Evidence& e, double rim_shows) {
    return {rim_shows, gate(std::log(std::max(e.rim.significance, 1e-4)), std::log(12.0), 0.35),
            // A mirror squeezes the world by 1 / cos^2 of the normal's angle, paint on a ball is
            // squeezed by 1 / cos: at 0.8 of the radius log2 of it is 1.5 and 0.75. Flat round
            // things show 0.
            gate(0.6 * e.squeeze + 0.4 * e.squeeze_before, 0.55, 0.09),
            gate(e.squeeze_before, -0.3, 0.12), gate(e.detailed, 0.40, 0.07),
            gate(-e.sameness, -0.47, 0.03), gate(-e.rings, -0.6, 0.06),
            // At grazing angles a mirror shows what lies behind it.
            gate(-e.step, -1.8, 0.2)};
}

double gate_of_rough(const Rim& rim) {
    const double clear = rim.visible / std::max(rim.inside_picture, 0.01);
    return gate(0.5 * (rim.coverage + clear), 0.55, 0.05);
}

/// In the photo's own pixels along the last fit more of it shows, of what is no rim, too.
double gate_of_fine(const LastFit& last) {
    return gate(0.5 * (last.coverage + last.visible), 0.735, 0.02);
}

}  // namespace

double score_of(const Evidence& e) {
    const auto gates = gates_of(e, gate_of_rough(e.rim));
    return std::exp2(std::accumulate(gates.begin(), gates.end(), 0.0));
}

std::vector<double> signs_of(const Evidence& e, const LastFit& last) {
    const double r = std::max(e.photo_radius, 1.0);
    const auto log2 = [](double v) { return std::log2(std::max(v, 1e-9)); };
    // A faint, soft or partly hidden rim shows in parts only on the search's levels.
    const auto gates = gates_of(e, std::max(gate_of_rough(e.rim), gate_of_fine(last)));
    std::vector<double> signs(gates.begin(), gates.end());
    // The last fit's deviation as if all of the ball were inside the picture: how well each part of
    // the rim is known. A fit of an arc, a part f of the circle, is off by about f^-1.6 as much if
    // it is a circle and f^-3.6 if any ellipse, near a half. As good as nothing where there was no
    // such fit.
    const double whole =
        last.deviation > 0
            ? last.deviation / r * std::pow(std::clamp(e.rim.inside_picture, 0.1, 1.0), 2.5)
            : 1;
    for (const double sign : {e.rim.coverage, last.visible, e.rings, log2(r), log2(e.contrast),
                              log2(e.detail / std::max(e.contrast, 1e-6)), e.squeeze, e.crispness,
                              e.crispness, log2(whole), log2(last.change / r)})
        signs.push_back(sign);
    return signs;
}

}  // namespace chromeball::detecting
