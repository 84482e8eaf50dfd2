#include "light/log_raster.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/luminance.h"
#include "core/parallel.h"

namespace chromeball {
namespace {

/// Pyramids end at a raster whose longer side is less than two of these.
constexpr int kCoarsest = 40;
// Parts of white between which light counts.
constexpr float kHighest = 0.9f;

bool usable(const ExposedPhoto& photo, const float* stored, int channel) {
    const auto most = kHighest * static_cast<float>(photo.white);
    if (channel != kLuminance) return stored[channel] < most;
    return stored[0] < most && stored[1] < most && stored[2] < most;
}

double light_of(const Response& response, const float* stored, int channel) {
    if (channel != kLuminance) return static_cast<double>(response.light(stored[channel]));
    const float linear[] = {response.light(stored[0]), response.light(stored[1]),
                            response.light(stored[2])};
    return luminance(linear);
}

/// The mean light of the factor x factor pixels whose first column is `left`, of as many rows;
/// nothing where one of them clips, or all are black.
std::optional<double> block_light(const Image& rows, const ExposedPhoto& photo,
                                  const Response& response, int left, int factor, int channel) {
    double light = 0;
    bool clipped = false;
    for (int j = 0; j < factor; ++j)
        for (int i = 0; i < factor; ++i) {
            const float* stored = rows.pixel(left + i, j);
            clipped = clipped || !usable(photo, stored, channel);
            light += light_of(response, stored, channel);
        }
    light /= factor * factor;
    if (clipped || !(light > 0)) return std::nullopt;
    return light;
}

/// One over the variance of such a mean's logarithm.
double log_weight(const ExposedPhoto& photo, const Response& response, double light) {
    // A curve's slope is about its light's ratio here; good enough for a weight.
    const double slope = response.is_linear() ? 1 : std::max(0.08, 2.2 * light);
    const double variance = noise_variance(photo, light, slope) / (light * light);
    constexpr double kFlat = 1e-3;  // never surer than 3 %
    return 1 / (variance + kFlat);
}

LogRaster half(const LogRaster& fine) {
    LogRaster coarse({fine.size.width / 2, fine.size.height / 2});
    for (int y = 0; y < coarse.size.height; ++y)
        for (int x = 0; x < coarse.size.width; ++x) {
            float sum = 0, weight = 0;
            int used = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const std::size_t at = fine.at(2 * x + i, 2 * y + j);
                    if (!(fine.weight[at] > 0)) continue;
                    sum += fine.weight[at] * fine.value[at];
                    weight += fine.weight[at];
                    ++used;
                }
            if (used < 3) continue;
            coarse.value[coarse.at(x, y)] = sum / weight;
            coarse.weight[coarse.at(x, y)] = weight / static_cast<float>(used);
        }
    return coarse;
}

/// Binomial means along one axis, of what counts.
LogRaster smoothed(const LogRaster& raster, int dx, int dy) {
    constexpr float kWeights[] = {1, 4, 6, 4, 1};
    LogRaster out(raster.size);
    for (int y = 0; y < raster.size.height; ++y)
        for (int x = 0; x < raster.size.width; ++x) {
            const std::size_t at = raster.at(x, y);
            if (!(raster.weight[at] > 0)) continue;
            float sum = 0, total = 0, count = 0;
            for (int i = -2; i <= 2; ++i) {
                const int u = x + i * dx, v = y + i * dy;
                if (u < 0 || v < 0 || u >= raster.size.width || v >= raster.size.height) continue;
                const std::size_t there = raster.at(u, v);
                const float w = kWeights[i + 2] * raster.weight[there];
                if (!(w > 0)) continue;
                sum += w * raster.value[there];
                total += w;
                count += kWeights[i + 2];
            }
            // Lopsided beside what is clipped: means of different places.
            if (count < 16) continue;
            out.value[at] = sum / total;
            out.weight[at] = total / count;
        }
    return out;
}

/// Sums over boxes of 2 r + 1 along one axis, cut at the edges.
void box_sums(const std::vector<float>& in, Size size, int r, bool along_x,
              std::vector<float>& out) {
    const int lines = along_x ? size.height : size.width;
    const int length = along_x ? size.width : size.height;
    const auto step = static_cast<std::size_t>(along_x ? 1 : size.width);
    for (int line = 0; line < lines; ++line) {
        const std::size_t first =
            static_cast<std::size_t>(line) * static_cast<std::size_t>(along_x ? size.width : 1);
        const auto at = [&](int i) { return first + static_cast<std::size_t>(i) * step; };
        double sum = 0;
        for (int i = 0; i < std::min(r, length); ++i) sum += static_cast<double>(in[at(i)]);
        for (int i = 0; i < length; ++i) {
            if (i + r < length) sum += static_cast<double>(in[at(i + r)]);
            if (i - r - 1 >= 0) sum -= static_cast<double>(in[at(i - r - 1)]);
            out[at(i)] = static_cast<float>(sum);
        }
    }
}

/// Less the mean around each pixel: over gentle slopes an error of the curve or of the exposure
/// would look like a shift. Where much around is missing the mean is of another place, so nothing
/// stays.
LogRaster without_mean(const LogRaster& raster) {
    const int r = std::clamp(std::max(raster.size.width, raster.size.height) / 12, 2, 8);
    LogRaster out(raster.size);
    std::vector<float> values(raster.value.size()), there(raster.value.size());
    std::vector<float> sums(raster.value.size()), counts(raster.value.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        there[i] = raster.weight[i] > 0 ? 1 : 0;
        values[i] = there[i] * raster.value[i];
    }
    box_sums(values, raster.size, r, true, sums);
    box_sums(sums, raster.size, r, false, values);
    box_sums(there, raster.size, r, true, sums);
    box_sums(sums, raster.size, r, false, counts);
    const float enough = 0.98f * static_cast<float>((2 * r + 1) * (2 * r + 1));
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!(raster.weight[i] > 0 && counts[i] > enough)) continue;
        out.value[i] = raster.value[i] - values[i] / counts[i];
        out.weight[i] = raster.weight[i];
    }
    return out;
}

}  // namespace

int channel_to_compare(std::span<const ExposedPhoto> photos, std::span<const int> order) {
    constexpr int kRows = 64, kStep = 8;
    const Size size = photos.front().size;
    Image row({size.width, 1}, 3);
    std::array<double, 4> least{1, 1, 1, 1};
    std::vector<std::array<char, 4>> before, now;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const ExposedPhoto& photo = photos[static_cast<std::size_t>(order[i])];
        now.clear();
        for (int j = 0; j < kRows; ++j) {
            const int y = j * size.height / kRows;
            photo.read(y, y + 1, row.view());
            for (int x = 0; x < size.width; x += kStep) {
                const float* stored = row.pixel(x, 0);
                std::array<char, 4> shows{};
                for (int c = 0; c < 4; ++c)
                    shows[static_cast<std::size_t>(c)] =
                        usable(photo, stored, c) &&
                        stored[c == kLuminance ? 1 : c] > 8 * static_cast<float>(photo.step);
                now.push_back(shows);
            }
        }
        for (std::size_t c = 0; c < 4 && i > 0; ++c) {
            double both = 0;
            for (std::size_t n = 0; n < now.size(); ++n) both += before[n][c] && now[n][c];
            least[c] = std::min(least[c], both / static_cast<double>(now.size()));
        }
        std::swap(before, now);
    }
    constexpr double kEnough = 0.3;
    if (least[kLuminance] > kEnough) return kLuminance;
    const auto best = std::max_element(least.begin(), least.begin() + 3);
    return *best > 1.5 * least[kLuminance] ? static_cast<int>(best - least.begin()) : kLuminance;
}

LogRaster log_raster(const ExposedPhoto& photo, const Response& response, const Window& region,
                     int factor, int channel) {
    LogRaster raster({region.size.width / factor, region.size.height / factor});
    for_each_band(raster.size.height, 16, [&](int first, int last) {
        Image rows({photo.size.width, factor}, 3);
        for (int y = first; y < last; ++y) {
            const int top = region.y + y * factor;
            if (top < 0 || top + factor > photo.size.height) continue;
            photo.read(top, top + factor, rows.view());
            for (int x = 0; x < raster.size.width; ++x) {
                const int left = region.x + x * factor;
                if (left < 0 || left + factor > photo.size.width) continue;
                const auto light = block_light(rows, photo, response, left, factor, channel);
                if (!light) continue;
                raster.value[raster.at(x, y)] = static_cast<float>(std::log(*light));
                raster.weight[raster.at(x, y)] =
                    static_cast<float>(log_weight(photo, response, *light));
            }
        }
    });
    return raster;
}

LogPyramid log_pyramid(LogRaster finest) {
    LogPyramid made;
    std::vector<LogRaster>& levels = made.levels;
    levels.push_back(std::move(finest));
    while (std::max(levels.back().size.width, levels.back().size.height) >= 2 * kCoarsest)
        levels.push_back(half(levels.back()));
    made.coarsest = levels.back();
    for (LogRaster& level : levels) level = without_mean(smoothed(smoothed(level, 1, 0), 0, 1));
    return made;
}

}  // namespace chromeball
