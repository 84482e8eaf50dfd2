#include "light/merge.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <mutex>

#include "core/luminance.h"
#include "core/parallel.h"
#include "light/merge_ghosts.h"

namespace chromeball {
namespace {

/// Up to where stored numbers count fully and from where on they do not, as parts of white. Encoded
/// pictures have gone through JPEG and the camera's tone curve, whose shoulders are flat.
struct Top {
    float full, none;
};
constexpr Top kEncoded{0.80f, 0.94f};
constexpr Top kLinear{0.90f, 0.97f};
/// From here on a number is clipped and not only too near to it.
constexpr float kClipped = 0.98f;

/// One photo's rows as they lie on the merged picture: per pixel and channel light in the photo's
/// own unit, light per stored number, and how far it counts by being below white.
struct Rows {
    Image light, slope, usable, clipped;

    explicit Rows(Size size) : light(size, 3), slope(size, 3), usable(size, 3), clipped(size, 1) {}
};

float smooth(float t) { return t * t * (3 - 2 * t); }

/// 1 up to the top, 0 beyond.
float below_white(float stored, float white, Top top) {
    const float t = (top.none * white - stored) / ((top.none - top.full) * white);
    return smooth(std::clamp(t, 0.0f, 1.0f));
}

/// Catmull and Rom's weights at t in [0, 1) for the samples at -1, 0, 1, 2.
std::array<float, 4> cubic(float t) {
    const float t2 = t * t, t3 = t2 * t;
    return {0.5f * (-t3 + 2 * t2 - t), 0.5f * (3 * t3 - 5 * t2 + 2), 0.5f * (-3 * t3 + 4 * t2 + t),
            0.5f * (t3 - t2)};
}

/// Reads one photo so that it lies on the merged picture.
class Reader {
public:
    Reader(const MergePhoto& photo, const Response& response)
        : photo_(photo), response_(response), top_(response.is_linear() ? kLinear : kEncoded) {
        // A few hundredths of a pixel are not worth the blur of a filter.
        constexpr double kNone = 0.05;
        const auto split = [&](double shift, int& whole, float& part) {
            double floor = std::floor(shift + kNone);
            double rest = shift - floor;
            if (rest > 1 - kNone) floor += 1, rest = 0;
            if (rest < kNone) rest = 0;
            whole = static_cast<int>(floor);
            part = static_cast<float>(rest);
        };
        split(photo.shift.x, dx_, u_);
        split(photo.shift.y, dy_, v_);
    }

    /// Rows first to last of the merged picture.
    void read(int first, int last, Rows& out) const {
        const Size size = photo_.photo.size;
        const bool whole = u_ == 0 && v_ == 0;
        const int margin = whole ? 0 : 2;
        const int top = std::clamp(first + dy_ - margin, 0, size.height);
        const int bottom = std::clamp(last + dy_ + margin + 1, top, size.height);
        Image stored({size.width, std::max(1, bottom - top)}, 3);
        if (bottom > top)
            photo_.photo.read(top, bottom,
                              {stored.view().data,
                               {size.width, bottom - top},
                               3,
                               static_cast<std::ptrdiff_t>(size.width) * 3});
        const Rows decoded = decode(stored, bottom - top);
        for (int y = first; y < last; ++y)
            for (int x = 0; x < size.width; ++x) put(decoded, top, bottom, x, y, y - first, out);
    }

private:
    Rows decode(const Image& stored, int count) const {
        Rows rows({stored.width(), std::max(1, count)});
        const auto white = static_cast<float>(photo_.photo.white);
        const bool clips = std::isfinite(photo_.photo.white);
        for (int y = 0; y < count; ++y)
            for (int x = 0; x < stored.width(); ++x) {
                const float* z = stored.pixel(x, y);
                float least = 1;
                float* usable = rows.usable.pixel(x, y);
                float most = 0;
                for (int c = 0; c < 3; ++c) {
                    const bool finite = std::isfinite(z[c]);
                    rows.light.pixel(x, y)[c] = finite ? response_.light(z[c]) : 0;
                    rows.slope.pixel(x, y)[c] = response_.slope(z[c]);
                    usable[c] = !finite ? 0 : clips ? below_white(z[c], white, top_) : 1;
                    least = std::min(least, usable[c]);
                    most = std::max(most, z[c]);
                }
                if (photo_.photo.mixed) std::fill_n(usable, 3, least);
                rows.clipped.pixel(x, y)[0] = clips && !(most < kClipped * white) ? 1 : 0;
            }
        return rows;
    }

    void put(const Rows& in, int top, int bottom, int x, int y, int row, Rows& out) const {
        const int width = photo_.photo.size.width;
        float* light = out.light.pixel(x, row);
        float* slope = out.slope.pixel(x, row);
        float* usable = out.usable.pixel(x, row);
        float* clipped = out.clipped.pixel(x, row);
        const int i = x + dx_, j = y + dy_;
        const bool inside = i >= 0 && j >= top && i + (u_ > 0) < width && j + (v_ > 0) < bottom;
        if (!inside) {
            std::fill_n(light, 3, 0.0f);
            std::fill_n(slope, 3, 0.0f);
            std::fill_n(usable, 3, -1.0f);
            *clipped = 0;
            return;
        }
        std::copy_n(in.slope.pixel(i, j - top), 3, slope);
        if (u_ == 0 && v_ == 0) {
            std::copy_n(in.light.pixel(i, j - top), 3, light);
            std::copy_n(in.usable.pixel(i, j - top), 3, usable);
            *clipped = *in.clipped.pixel(i, j - top);
            return;
        }
        const auto a = cubic(u_), b = cubic(v_);
        std::fill_n(light, 3, 0.0f);
        for (int n = 0; n < 4; ++n)
            for (int m = 0; m < 4; ++m) {
                const float w = a[static_cast<std::size_t>(m)] * b[static_cast<std::size_t>(n)];
                const float* from = in.light.pixel(std::clamp(i - 1 + m, 0, width - 1),
                                                   std::clamp(j - 1 + n, top, bottom - 1) - top);
                for (int c = 0; c < 3; ++c) light[c] += w * from[c];
            }
        // Where a neighbour clips the mean is as good as clipped.
        std::fill_n(usable, 3, 1.0f);
        *clipped = 0;
        for (int n = 0; n <= (v_ > 0); ++n)
            for (int m = 0; m <= (u_ > 0); ++m) {
                for (int c = 0; c < 3; ++c) {
                    usable[c] = std::min(usable[c], in.usable.pixel(i + m, j + n - top)[c]);
                    light[c] = std::max(light[c], 0.0f);
                }
                *clipped = std::max(*clipped, *in.clipped.pixel(i + m, j + n - top));
            }
    }

    const MergePhoto& photo_;
    const Response& response_;
    Top top_;
    int dx_ = 0, dy_ = 0;
    float u_ = 0, v_ = 0;  ///< parts of a pixel
};

/// The mean of one channel of one pixel, from the shortest exposure to the longest.
class Mean {
public:
    /// usable below 0: the photo does not reach there; variance: of light
    void add(float light, float variance, float exposure, float usable, float allowed) {
        if (usable < 0 || allowed <= 0) return;
        const float unit = 1 / exposure;
        const float radiance = light * unit;
        // A shorter exposure says that this one must be clipped; then it is, whatever it shows.
        const bool must_clip = bound_ * exposure > 1;
        float weight = must_clip ? 0 : usable * allowed;
        if (weight > 0) good_ = true;
        // So that there is a number where all clip: the shortest one's.
        if (sum_ == 0 && !must_clip) weight = std::max(weight, kHardly * allowed);
        weight *= exposure * exposure / variance;
        sum_ += weight;
        mean_ += weight * radiance;
        if (allowed > 0.5f) bound_ = std::max(bound_, radiance - 2 * unit * std::sqrt(variance));
    }

    bool good() const { return good_; }
    bool any() const { return sum_ > 0; }
    float value() const { return mean_ / sum_; }
    float variance() const { return 1 / sum_; }

private:
    static constexpr float kHardly = 1e-4f;
    float sum_ = 0, mean_ = 0, bound_ = 0;
    bool good_ = false;
};

/// Largest connected spot of marked pixels: its middle and size.
struct Spot {
    V2d middle{0, 0};
    std::size_t pixels = 0;
};

Spot largest_spot(std::vector<char> marked, Size size) {
    Spot best;
    std::vector<std::size_t> spot;
    const auto width = static_cast<std::size_t>(size.width);
    for (std::size_t start = 0; start < marked.size(); ++start) {
        if (!marked[start]) continue;
        spot.assign(1, start);
        marked[start] = 0;
        V2d sum(0, 0);
        for (std::size_t n = 0; n < spot.size(); ++n) {
            const auto x = static_cast<int>(spot[n] % width), y = static_cast<int>(spot[n] / width);
            sum += V2d(x + 0.5, y + 0.5);
            for (int j = std::max(0, y - 1); j <= std::min(size.height - 1, y + 1); ++j)
                for (int i = std::max(0, x - 1); i <= std::min(size.width - 1, x + 1); ++i) {
                    const std::size_t at =
                        static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i);
                    if (!marked[at]) continue;
                    marked[at] = 0;
                    spot.push_back(at);
                }
        }
        if (spot.size() > best.pixels) best = {sum / static_cast<double>(spot.size()), spot.size()};
    }
    return best;
}

/// All photos together, a band of rows at a time.
class Merger {
public:
    Merger(std::span<const MergePhoto> photos, const Response& response, const GhostMap& ghosts)
        : photos_(photos), response_(response), ghosts_(ghosts), size_(photos.front().photo.size) {
        for (std::size_t k = 0; k < photos.size(); ++k) {
            readers_.emplace_back(photos[k], response);
            free_.push_back(ghosts.always(k));
        }
    }

    /// Marks in `burnt` what is clipped in all; gives how many are black in all.
    std::size_t merge(int first, int last, Image& out, std::vector<char>& burnt) const {
        std::vector<Rows> rows;
        for (const Reader& reader : readers_) {
            rows.emplace_back(Size{size_.width, last - first});
            reader.read(first, last, rows.back());
        }
        std::vector<std::vector<float>> allowed(
            photos_.size(), std::vector<float>(static_cast<std::size_t>(size_.width), 1));
        std::size_t black = 0;
        for (int y = first; y < last; ++y) {
            for (std::size_t k = 0; k < photos_.size(); ++k)
                if (!free_[k]) ghosts_.row(k, y, allowed[k]);
            for (int x = 0; x < size_.width; ++x) {
                const std::size_t at =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
                    static_cast<std::size_t>(x);
                bool clips = false;
                black += pixel(rows, allowed, x, y - first, out.pixel(x, y), clips);
                burnt[at] = clips;
            }
        }
        return black;
    }

private:
    /// Gives whether it is black in all; `clips`: whether a channel clips in all.
    bool pixel(const std::vector<Rows>& rows, const std::vector<std::vector<float>>& allowed, int x,
               int y, float* out, bool& clips) const {
        std::array<Mean, 3> mean;
        bool clipped = true;
        double shortest = 0;  // of those that count here
        for (std::size_t k = 0; k < photos_.size(); ++k) {
            const Rows& row = rows[k];
            const float* light = row.light.pixel(x, y);
            const float* slope = row.slope.pixel(x, y);
            const float* usable = row.usable.pixel(x, y);
            if (usable[0] >= 0 && allowed[k][static_cast<std::size_t>(x)] > 0) {
                clipped = clipped && *row.clipped.pixel(x, y) > 0;
                if (!(shortest > 0)) shortest = photos_[k].exposure;
            }
            for (std::size_t c = 0; c < 3; ++c) {
                const auto variance = static_cast<float>(
                    noise_variance(photos_[k].photo, static_cast<double>(light[c]),
                                   static_cast<double>(slope[c])));
                mean[c].add(light[c], variance, static_cast<float>(photos_[k].exposure), usable[c],
                            allowed[k][static_cast<std::size_t>(x)]);
            }
        }
        float variance[3];
        bool good = true;
        for (const Mean& channel : mean) good = good && channel.good();
        clips = !good && clipped;
        for (std::size_t c = 0; c < 3; ++c) {
            out[c] = mean[c].any() ? std::max(0.0f, mean[c].value()) : 0;
            variance[c] = mean[c].any() ? mean[c].variance() : 0;
            // Beside a clipped channel JPEG's colours are smeared; it is as bright as that at
            // least.
            if (clips && !mean[c].good() && shortest > 0)
                out[c] = std::max(out[c], static_cast<float>(1 / shortest));
        }
        const double light = luminance(out);
        const double sigma = std::sqrt(luminance(variance));
        const bool black = !clips && !(light > sigma);
        const double error = light > 0 ? sigma / light / 0.1 : 1e9;
        out[3] = clips || black ? 0 : static_cast<float>(1 / (1 + error * error));
        return black;
    }

    std::span<const MergePhoto> photos_;
    const Response& response_;
    const GhostMap& ghosts_;
    Size size_;
    std::vector<Reader> readers_;
    std::vector<bool> free_;  ///< nothing moved in this photo
};

double part_left_out(const GhostMap& ghosts, std::size_t photo) {
    double out = 0;
    for (const float a : ghosts.allowed[photo]) out += 1 - static_cast<double>(a);
    return out / static_cast<double>(ghosts.allowed[photo].size());
}

}  // namespace

Merged merge(std::span<const MergePhoto> given, const Response& response, const Watch& watch) {
    assert(!given.empty());
    std::vector<std::size_t> order(given.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return given[k].exposure; });
    std::vector<MergePhoto> photos;
    for (const std::size_t k : order) photos.push_back(given[k]);

    const GhostMap ghosts = find_ghosts(photos, response);
    watch.check();
    const Merger merger(photos, response, ghosts);
    const Size size = photos.front().photo.size;
    Merged merged;
    merged.pixels = Image(size, 4);
    std::vector<char> burnt(size.pixels());
    std::atomic<std::size_t> black = 0;
    for_each_band(
        size.height, 16,
        [&](int first, int last) { black += merger.merge(first, last, merged.pixels, burnt); },
        watch);
    merged.black_everywhere = black;
    merged.clipped_everywhere =
        static_cast<std::size_t>(std::count(burnt.begin(), burnt.end(), char{1}));
    const Spot spot = largest_spot(std::move(burnt), size);
    merged.brightest = spot.middle;
    merged.brightest_pixels = spot.pixels;
    merged.moved.resize(given.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        merged.moved[order[k]] = part_left_out(ghosts, k);
    return merged;
}

}  // namespace chromeball
