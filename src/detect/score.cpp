#include "detect/score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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
double sameness_of(const Patch& patch, const Outline& o, double least) {
    std::vector<double> strengths;
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
            if (strength(x + ix, y + iy) <= m && strength(x - ix, y - iy) < m)
                strengths.push_back(m);
        }
    if (strengths.size() < 20) return 1;
    std::sort(strengths.begin(), strengths.end());
    return strengths[strengths.size() / 2] / strengths[strengths.size() * 95 / 100];
}

/// 0 far below `half`, 1 far above.
double gate(double value, double half, double width) {
    return 1 / (1 + std::exp(-(value - half) / width));
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
    e.sameness = sameness_of(patch, outline, 3 * slope_noise + 0.01 * e.contrast);
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

double score_of(const Evidence& e) {
    // Each line is a soft "and": the value at which a mirror ball is as likely as not when all else
    // speaks for it, and how fast that changes. They stand about half-way between what mirror balls
    // and other round things show, in logarithms where the quantity is a ratio.
    const double clear = e.rim.visible / std::max(e.rim.inside_picture, 0.01);
    const double rim = gate(0.5 * (e.rim.coverage + clear), 0.55, 0.05) *
                       gate(std::log(std::max(e.rim.significance, 1e-3)), std::log(12.0), 0.35);
    const double detail = gate(e.detailed, 0.40, 0.07);
    // A mirror squeezes the world by 1 / cos^2 of the normal's angle, paint on a ball is squeezed
    // by 1 / cos: at 0.8 of the radius log2 of it is 1.5 and 0.75. Flat round things show 0.
    const double squeeze = gate(0.6 * e.squeeze + 0.4 * e.squeeze_before, 0.55, 0.09) *
                           gate(e.squeeze_before, -0.3, 0.12);
    const double world = gate(-e.sameness, -0.47, 0.03) * gate(-e.rings, -0.6, 0.06);
    // At grazing angles a mirror shows what lies behind it.
    const double seam = gate(-e.step, -1.8, 0.2);
    return rim * detail * squeeze * world * seam;
}

double confidence_of(double score, const Evidence& e) {
    const auto logit = [](double p) { return std::log(p / (1 - p)); };
    // A logistic regression of "it is a mirror ball, and right to 2 %" on 755 pictures of
    // tests/detect/random_picture.h (numbers 100000 and up) and, with the weight of 12 each, 31
    // photographs and renderings. On those pictures it says what is right in each tenth within
    // 0.1 (tests/detect/reliability_test.cpp prints the table for others).
    const double odds = -11.29 + 0.236 * logit(std::clamp(score, 1e-4, 1 - 1e-4)) +
                        4.13 * e.rim.coverage + 4.82 * e.detailed - 1.00 * e.rings -
                        1.24 * std::clamp(std::log(e.step + 0.01), -3.0, 1.0) +
                        0.88 * std::clamp(std::log(e.photo_radius), 2.0, 6.0);
    const double chance = 1 / (1 + std::exp(-odds));
    // Painted worlds are plainer than the real one. Whether it is a ball at all stays the score's
    // word, which was weighed on real round things; the regression says how sure that is.
    return score < 0.5 ? std::min(chance, 0.49) : std::max(chance, 0.5 + 0.3 * (score - 0.5));
}

}  // namespace chromeball::detecting
