#include "render/patch_match.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/sampling.h"

namespace chromeball {
namespace {

constexpr int kReach = 3;  // patches of 7 x 7
/// The coarsest picture's hole is that small: a few patches, so that there are many around it.
constexpr int kSmallHole = 24;
/// What a distance of the picture's width and height counts, as a sum of squares over a patch.
constexpr float kFar = 5;

bool within(const Image& image, int x, int y) {
    return x >= 0 && y >= 0 && x < image.width() && y < image.height();
}

enum class UnknownIf { any, all };

/// Means of 2 x 2 pixels, of those that are known; unknown where any or all of them are.
Holed halved(const Holed& fine, UnknownIf unknown) {
    const Size size{(fine.look.width() + 1) / 2, (fine.look.height() + 1) / 2};
    const int channels = fine.look.channels();
    Holed coarse{Image(size, channels), std::vector<char>(size.pixels())};
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            int known = 0, all = 0;
            float* to = coarse.look.pixel(x, y);
            for (int k = 0; k < 4; ++k) {
                const int fx = 2 * x + k % 2, fy = 2 * y + k / 2;
                if (!within(fine.look, fx, fy)) continue;
                ++all;
                if (fine.hole[fine.at(fx, fy)]) continue;
                ++known;
                for (int c = 0; c < channels; ++c) to[c] += fine.look.pixel(fx, fy)[c];
            }
            for (int c = 0; c < channels && known > 0; ++c) to[c] /= static_cast<float>(known);
            coarse.hole[coarse.at(x, y)] = unknown == UnknownIf::any ? known < all : known == 0;
        }
    return coarse;
}

/// One size of the picture while its hole is being filled.
class Level {
public:
    explicit Level(Holed picture) : picture_(std::move(picture)) {
        const Image& look = picture_.look;
        source_.resize(picture_.hole.size());
        target_.resize(picture_.hole.size());
        from_.resize(picture_.hole.size());
        off_.resize(picture_.hole.size());
        for (int y = 0; y < look.height(); ++y)
            for (int x = 0; x < look.width(); ++x) {
                bool touches = false;
                for (int j = -kReach; j <= kReach; ++j)
                    for (int i = -kReach; i <= kReach; ++i)
                        touches = touches || (within(look, x + i, y + j) &&
                                              picture_.hole[picture_.at(x + i, y + j)]);
                const bool whole = x >= kReach && y >= kReach && x + kReach < look.width() &&
                                   y + kReach < look.height();
                target_[picture_.at(x, y)] = touches;
                source_[picture_.at(x, y)] = whole && !touches;
                if (whole && !touches) sources_.push_back({x, y});
                if (touches) targets_.push_back({x, y});
            }
    }

    bool has_sources() const { return !sources_.empty(); }

    /// Layer by layer from the hole's edge inwards, by what is known or laid already: what lies
    /// around goes on into the hole, and a hole filled smoothly would call for smooth things.
    void start() {
        std::vector<char> known(picture_.hole.size());
        for (std::size_t i = 0; i < known.size(); ++i) known[i] = !picture_.hole[i];
        const auto edge = [&](const GridPlace& t) {
            if (known[at(t)]) return false;
            for (const GridPlace& by : {GridPlace{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                const GridPlace next{t.x + by.x, t.y + by.y};
                if (within(picture_.look, next.x, next.y) && known[at(next)]) return true;
            }
            return false;
        };
        for (const GridPlace& t : targets_)
            if (known[at(t)]) from_[at(t)] = likest(t, known);
        while (true) {
            std::vector<GridPlace> layer;
            for (const GridPlace& t : targets_)
                if (edge(t)) layer.push_back(t);
            if (layer.empty()) return;
            for (const GridPlace& t : layer) from_[at(t)] = likest(t, known);
            for (const GridPlace& t : layer) {
                const GridPlace f = from_[at(t)];
                std::copy_n(picture_.look.pixel(f.x, f.y), picture_.look.channels(),
                            picture_.look.pixel(t.x, t.y));
                known[at(t)] = 1;
            }
        }
    }

    void start_from(const Level& coarse) {
        for (std::size_t i = 0; i < targets_.size(); ++i) {
            const auto [x, y] = targets_[i];
            const GridPlace before{x / 2, y / 2};
            GridPlace place{-1, -1};
            if (coarse.target_[coarse.at(before)]) {
                const GridPlace f = coarse.from_[coarse.at(before)];
                place = {2 * f.x + x % 2, 2 * f.y + y % 2};
            }
            from_[at(targets_[i])] =
                is_source(place) ? place : any(static_cast<std::uint32_t>(i), 1);
        }
        vote(false);
    }

    void improve(int rounds) {
        for (int round = 0; round < rounds; ++round) {
            for (const GridPlace& t : targets_)
                off_[at(t)] = distance(t, from_[at(t)], std::numeric_limits<float>::infinity());
            for (int sweep = 0; sweep < 2; ++sweep)
                search(sweep % 2 == 1, static_cast<std::uint32_t>(2 * round + sweep));
            vote(true);
        }
    }

    std::vector<std::optional<GridPlace>> result() const {
        std::vector<std::optional<GridPlace>> places(from_.size());
        for (const GridPlace& t : targets_) places[at(t)] = from_[at(t)];
        return places;
    }

private:
    std::size_t at(const GridPlace& p) const { return picture_.at(p.x, p.y); }
    bool is_source(const GridPlace& p) const {
        return within(picture_.look, p.x, p.y) && source_[at(p)];
    }
    GridPlace any(std::uint32_t i, std::uint32_t salt) const {
        return sources_[hashed(i + hashed(salt)) % sources_.size()];
    }

    /// Of two places alike the nearer one is more likely of the same thing.
    float far(const GridPlace& target, const GridPlace& source) const {
        const auto side = static_cast<float>(picture_.look.width() + picture_.look.height());
        const float x = static_cast<float>(target.x - source.x) / side;
        const float y = static_cast<float>(target.y - source.y) / side;
        return kFar * (x * x + y * y);
    }

    /// The sum of squares between two patches, as far as the picture goes; more than `enough` is as
    /// good as infinite.
    float distance(const GridPlace& target, const GridPlace& source, float enough) const {
        const Image& look = picture_.look;
        const int low = std::max(-kReach, -target.x),
                  high = std::min(kReach, look.width() - 1 - target.x);
        const auto count = static_cast<std::size_t>((high - low + 1) * look.channels());
        float sum = far(target, source);
        for (int j = -kReach; j <= kReach; ++j) {
            if (target.y + j < 0 || target.y + j >= look.height()) continue;
            const float* a = look.pixel(target.x + low, target.y + j);
            const float* b = look.pixel(source.x + low, source.y + j);
            for (std::size_t i = 0; i < count; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
            if (sum > enough) return sum;
        }
        return sum;
    }

    /// The source whose patch is most like what is known of a target's.
    GridPlace likest(const GridPlace& target, const std::vector<char>& known) const {
        const Image& look = picture_.look;
        GridPlace best = sources_.front();
        float least = std::numeric_limits<float>::infinity();
        for (const GridPlace& s : sources_) {
            float sum = far(target, s);
            for (int j = -kReach; j <= kReach && sum < least; ++j)
                for (int i = -kReach; i <= kReach; ++i) {
                    const GridPlace t{target.x + i, target.y + j};
                    if (!within(look, t.x, t.y) || !known[at(t)]) continue;
                    const float *a = look.pixel(t.x, t.y), *b = look.pixel(s.x + i, s.y + j);
                    for (int c = 0; c < look.channels(); ++c) sum += (a[c] - b[c]) * (a[c] - b[c]);
                }
            if (sum >= least) continue;
            least = sum;
            best = s;
        }
        return best;
    }

    void try_place(const GridPlace& target, const GridPlace& place) {
        if (!is_source(place) || place == from_[at(target)]) return;
        float& best = off_[at(target)];
        const float off = distance(target, place, best);
        if (off >= best) return;
        best = off;
        from_[at(target)] = place;
    }

    /// What suits a neighbour suits here, moved along; then places at random around the best.
    void search(bool backwards, std::uint32_t round) {
        const int step = backwards ? 1 : -1;
        const int widest = std::max(picture_.look.width(), picture_.look.height());
        for (std::size_t n = 0; n < targets_.size(); ++n) {
            const std::size_t i = backwards ? targets_.size() - 1 - n : n;
            const GridPlace t = targets_[i];
            for (const GridPlace& by : {GridPlace{step, 0}, GridPlace{0, step}}) {
                const GridPlace next{t.x + by.x, t.y + by.y};
                if (!within(picture_.look, next.x, next.y) || !target_[at(next)]) continue;
                const GridPlace f = from_[at(next)];
                try_place(t, {f.x - by.x, f.y - by.y});
            }
            std::uint32_t seed = hashed(static_cast<std::uint32_t>(i) + hashed(round));
            for (int reach = widest; reach >= 1; reach /= 2) {
                const auto side = static_cast<std::uint32_t>(2 * reach + 1);
                const GridPlace best = from_[at(t)];
                seed = hashed(seed + 1);
                const int dx = static_cast<int>(seed % side) - reach;
                seed = hashed(seed + 1);
                const int dy = static_cast<int>(seed % side) - reach;
                try_place(t, {best.x + dx, best.y + dy});
            }
        }
    }

    /// Each pixel of the hole becomes what the patches over it say, the better they fit the more.
    void vote(bool weighted) {
        float usual = 0;
        if (weighted && !targets_.empty()) {
            std::vector<float> all;
            for (const GridPlace& t : targets_) all.push_back(off_[at(t)]);
            // So that a quarter of the patches counts for little.
            const auto at_three_quarters =
                all.begin() + static_cast<std::ptrdiff_t>(all.size() * 3 / 4);
            std::nth_element(all.begin(), at_three_quarters, all.end());
            usual = *at_three_quarters;
        }
        Image& look = picture_.look;
        const int channels = look.channels();
        std::vector<float> sums(targets_.size() * static_cast<std::size_t>(channels));
        for (std::size_t n = 0; n < targets_.size(); ++n) {
            const auto [x, y] = targets_[n];
            if (!picture_.hole[picture_.at(x, y)]) continue;
            float* sum = &sums[n * static_cast<std::size_t>(channels)];
            float weights = 0;
            for (int j = -kReach; j <= kReach; ++j)
                for (int i = -kReach; i <= kReach; ++i) {
                    const GridPlace patch{x + i, y + j};
                    if (!within(look, patch.x, patch.y) || !target_[at(patch)]) continue;
                    const GridPlace f = from_[at(patch)];
                    const float w = usual > 0 ? std::exp(-2 * off_[at(patch)] / usual) : 1;
                    const float* p = look.pixel(f.x - i, f.y - j);
                    for (int c = 0; c < channels; ++c) sum[c] += w * p[c];
                    weights += w;
                }
            // All of them can be bad.
            const bool none = !(weights > 1e-12F);
            const GridPlace own = from_[picture_.at(x, y)];
            for (int c = 0; c < channels; ++c)
                sum[c] = none ? look.pixel(own.x, own.y)[c] : sum[c] / weights;
        }
        for (std::size_t n = 0; n < targets_.size(); ++n) {
            const auto [x, y] = targets_[n];
            if (picture_.hole[picture_.at(x, y)])
                std::copy_n(&sums[n * static_cast<std::size_t>(channels)], channels,
                            look.pixel(x, y));
        }
    }

    Holed picture_;
    std::vector<char> source_, target_;         // may be copied from; is to be found a source for
    std::vector<GridPlace> sources_, targets_;  // row by row
    std::vector<GridPlace> from_;               // of the targets
    std::vector<float> off_;                    // their distance
};

int hole_width(const Holed& picture) {
    int least = picture.look.width(), most = -1;
    for (int y = 0; y < picture.look.height(); ++y)
        for (int x = 0; x < picture.look.width(); ++x)
            if (picture.hole[picture.at(x, y)]) {
                least = std::min(least, x);
                most = std::max(most, x);
            }
    return most - least + 1;
}

}  // namespace

void fill_smoothly(Holed& picture) {
    const Size size = picture.look.size();
    if (size.width == 1 && size.height == 1) return;
    if (std::find(picture.hole.begin(), picture.hole.end(), 1) == picture.hole.end()) return;
    const int channels = picture.look.channels();
    Holed coarse = halved(picture, UnknownIf::all);
    fill_smoothly(coarse);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            if (!picture.hole[picture.at(x, y)]) continue;
            // Bilinear between the coarse pixels' centres: 3/4 of the one, 1/4 of the next.
            const int x0 = x / 2, y0 = y / 2;
            const int x1 = std::clamp(x0 + (x % 2 == 0 ? -1 : 1), 0, coarse.look.width() - 1);
            const int y1 = std::clamp(y0 + (y % 2 == 0 ? -1 : 1), 0, coarse.look.height() - 1);
            const float *a = coarse.look.pixel(x0, y0), *b = coarse.look.pixel(x1, y0);
            const float *c = coarse.look.pixel(x0, y1), *d = coarse.look.pixel(x1, y1);
            for (int k = 0; k < channels; ++k)
                picture.look.pixel(x, y)[k] =
                    0.75F * (0.75F * a[k] + 0.25F * b[k]) + 0.25F * (0.75F * c[k] + 0.25F * d[k]);
        }
}

std::vector<std::optional<GridPlace>> likest_places(Holed picture) {
    const std::size_t pixels = picture.hole.size();
    std::vector<Level> levels;
    while (true) {
        const bool small = hole_width(picture) <= kSmallHole;
        Holed next = small ? Holed{} : halved(picture, UnknownIf::any);
        levels.emplace_back(std::move(picture));
        const bool usable = levels.back().has_sources();
        if (!usable) levels.pop_back();
        if (small || !usable) break;
        picture = std::move(next);
    }
    if (levels.empty()) return std::vector<std::optional<GridPlace>>(pixels);
    for (std::size_t i = levels.size(); i-- > 0;) {
        const bool coarsest = i + 1 == levels.size();
        coarsest ? levels[i].start() : levels[i].start_from(levels[i + 1]);
        levels[i].improve(coarsest ? 12 : i == 0 ? 3 : 5);
    }
    return levels.front().result();
}

}  // namespace chromeball
