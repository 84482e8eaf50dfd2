#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "shot/html_parts.h"

namespace chromeball::html {
namespace {

// The drawing's own units; the page scales it to its width.
constexpr double kWidth = 1200, kLeft = 64, kRight = 1180, kBand = 7;
constexpr int kColumns = 600;  ///< a point for every second pixel
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Two decimals: a two-hundredth of a pixel on the screen.
std::string at(double value) {
    std::string text = number(value, 2);
    while (text.ends_with('0')) text.pop_back();
    if (text.ends_with('.')) text.pop_back();
    return text == "-0" ? "0" : text;
}

std::string text_at(double x, double y, std::string_view anchor, const std::string& text) {
    return fmt::format(R"(<text x="{}" y="{}" text-anchor="{}">{}</text>)", at(x), at(y), anchor,
                       escaped(text));
}

std::string path_of(std::string_view kind, std::string_view drawn) {
    return drawn.empty() ? "" : fmt::format(R"(<path class="{}" d="{}"/>)", kind, drawn);
}

/// One path an outcome, of that outcome's colour.
std::string paths_of(std::string_view kind,
                     const std::array<std::string, kOutcomes.size()>& drawn) {
    std::string svg;
    for (std::size_t i = 0; i < drawn.size(); ++i)
        svg += path_of(fmt::format("{} {}", kind, name_of(kOutcomes[i])), drawn[i]);
    return svg;
}

std::string rectangle(double left, double top, double right, double bottom) {
    return fmt::format("M{} {}H{}V{}H{}z", at(left), at(top), at(right), at(bottom), at(left));
}

/// A stretch of numbers and where it is drawn.
struct Scale {
    double low = 0, high = 1;
    double from = 0, to = 1;

    double operator()(double value) const {
        return from + (value - low) / (high - low) * (to - from);
    }
};

/// 1, 2 or 5 times a power of ten: the finest step with at most `most` of them in the stretch.
double tick_step(double stretch, int most) {
    const double power = std::pow(10, std::floor(std::log10(stretch / most)));
    for (const double factor : {1.0, 2.0, 5.0, 10.0})
        if (stretch / (factor * power) <= most) return factor * power;
    return 10 * power;
}

std::vector<double> ticks(double low, double high, double step) {
    std::vector<double> all;
    for (double k = std::ceil(low / step); k * step <= high; ++k) all.push_back(k * step);
    return all;
}

/// The least distance of two neighbours; 1 for a single frame.
double frame_step(const Rows& frames) {
    double step = kInfinite;
    for (std::size_t i = 1; i < frames.size(); ++i)
        if (const double d = double(frames[i]->frame) - frames[i - 1]->frame; d > 0)
            step = std::min(step, d);
    return std::isfinite(step) ? step : 1;
}

/// Every frame has a step's width around its number.
Scale frame_scale(const Rows& frames) {
    const double half = frame_step(frames) / 2;
    return {frames.front()->frame - half, frames.back()->frame + half, kLeft, kRight};
}

/// The columns that bands and bars are made of: one a frame, or fewer where frames are too many.
class Columns {
public:
    explicit Columns(const Rows& frames) : x_(frame_scale(frames)) {
        count_ = std::min<double>(kColumns, std::round((x_.high - x_.low) / frame_step(frames)));
    }
    std::size_t count() const { return static_cast<std::size_t>(count_); }
    std::size_t of(const FrameReport& frame) const {
        return static_cast<std::size_t>((frame.frame - x_.low) / (x_.high - x_.low) * count_);
    }
    double left(std::size_t column) const {
        return kLeft + static_cast<double>(column) / count_ * (kRight - kLeft);
    }

private:
    Scale x_;
    double count_ = 1;
};

/// Columns of one outcome in a row, in drawing units.
struct Stretch {
    FrameOutcome outcome;
    double left, right;
};

/// A column of many frames shows the worst.
std::vector<Stretch> stretches(const Rows& frames) {
    const Columns columns(frames);
    std::vector<std::optional<FrameOutcome>> worst(columns.count());
    for (const FrameReport* frame : frames) {
        auto& outcome = worst[columns.of(*frame)];
        if (!outcome || frame->outcome > *outcome) outcome = frame->outcome;
    }
    std::vector<Stretch> all;
    for (std::size_t i = 0; i < worst.size(); ++i) {
        if (!worst[i]) continue;
        if (i > 0 && worst[i] == worst[i - 1])
            all.back().right = columns.left(i + 1);
        else
            all.push_back({*worst[i], columns.left(i), columns.left(i + 1)});
    }
    return all;
}

/// The outcomes as a band, `found` only where asked for, being the rule.
std::string bands(const std::vector<Stretch>& all, double top, double bottom, bool with_found,
                  std::string_view kind) {
    std::array<std::string, kOutcomes.size()> drawn;
    for (const Stretch& s : all)
        if (with_found || s.outcome != FrameOutcome::found)
            drawn[static_cast<std::size_t>(s.outcome)] += rectangle(s.left, top, s.right, bottom);
    return paths_of(kind, drawn);
}

std::string frame_axis(const Rows& frames, const Scale& x, double top, double bottom) {
    const double step = std::max(1.0, tick_step(x.high - x.low, 12));
    std::string svg;
    for (const double frame : ticks(frames.front()->frame, frames.back()->frame, step)) {
        svg += path_of("grid", fmt::format("M{} {}V{}", at(x(frame)), at(top), at(bottom)));
        svg += text_at(x(frame), bottom + 16, "middle", number(frame, 0));
    }
    return svg;
}

std::string value_axis(const Scale& y, std::string_view unit) {
    const double step = tick_step(y.high - y.low, 5);
    const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
    std::string svg;
    for (const double value : ticks(y.low, y.high, step)) {
        svg += path_of("grid", fmt::format("M{} {}H{}", at(kLeft), at(y(value)), at(kRight)));
        svg += text_at(kLeft - 6, y(value) + 4, "end",
                       number(value == 0 ? 0 : value, decimals) + std::string(unit));
    }
    return svg;
}

struct Point {
    double x, y;
};

/// Of the points in one column of the drawing the first, the lowest, the highest and the last.
std::vector<Point> thinned(const std::vector<Point>& points) {
    const double column = (kRight - kLeft) / kColumns;
    std::vector<Point> kept;
    for (std::size_t i = 0; i < points.size();) {
        std::size_t end = i + 1;
        while (end < points.size() &&
               std::floor(points[end].x / column) == std::floor(points[i].x / column))
            ++end;
        std::size_t low = i, high = i;
        for (std::size_t k = i; k < end; ++k) {
            if (points[k].y < points[low].y) low = k;
            if (points[k].y > points[high].y) high = k;
        }
        std::array<std::size_t, 4> chosen{i, std::min(low, high), std::max(low, high), end - 1};
        const auto* last = std::unique(chosen.begin(), chosen.end());
        for (const auto* k = chosen.begin(); k != last; ++k) kept.push_back(points[*k]);
        i = end;
    }
    return kept;
}

using Value = std::function<std::optional<double>(const FrameReport&)>;

std::optional<double> finite(double value) {
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// A line through the frames that have a value, broken where some have none.
std::string line(const Rows& frames, const Value& value, const Scale& x, const Scale& y,
                 std::string_view kind) {
    std::string path;
    std::vector<Point> run;
    const auto flush = [&] {
        bool first = true;
        for (const Point p : thinned(run)) {
            path += fmt::format("{}{} {}", first ? 'M' : 'L', at(p.x), at(p.y));
            first = false;
        }
        if (run.size() == 1) path += "h0";  // a dot, by its round cap
        run.clear();
    };
    // A gap that the drawing cannot show does not break the line, else gaps would add up.
    const double widest =
        std::max(1.5 * (x(frame_step(frames)) - x(0)), (kRight - kLeft) / kColumns);
    for (const FrameReport* frame : frames) {
        const auto v = value(*frame);
        if (!v) continue;
        const Point p{x(frame->frame), y(std::clamp(*v, y.low, y.high))};
        if (!run.empty() && p.x - run.back().x > widest) flush();
        run.push_back(p);
    }
    flush();
    return path_of(fmt::format("line {}", kind), path);
}

/// Dots; what lies outside the scale is marked at its edge.
std::string dots(const Rows& frames, const Value& value, const Scale& x, const Scale& y,
                 std::string_view kind) {
    std::vector<Point> inside, outside;
    for (const FrameReport* frame : frames) {
        const auto v = value(*frame);
        if (!v) continue;
        const double shown = std::clamp(*v, y.low, y.high);
        (shown == *v ? inside : outside).push_back({x(frame->frame), y(shown)});
    }
    const auto drawn = [](const std::vector<Point>& points) {
        std::string path;
        for (const Point p : thinned(points)) path += fmt::format("M{} {}h0", at(p.x), at(p.y));
        return path;
    };
    return path_of(fmt::format("dots {}", kind), drawn(inside)) +
           path_of("dots outside", drawn(outside));
}

/// Low and high with a margin, at least `least` apart.
Scale value_scale(double low, double high, double least, double top, double bottom) {
    if (low > high) low = high = 0;
    const double margin = std::max(0.08 * (high - low), (least - (high - low)) / 2);
    return {low - margin, high + margin, bottom, top};
}

std::string svg(double height, std::string_view label, const std::string& content) {
    return fmt::format(R"(<svg viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>)",
                       at(kWidth), at(height), escaped(label), content);
}

std::string chart(const std::string& caption, const std::string& drawing) {
    return fmt::format(R"(<figure class="chart"><figcaption>{}</figcaption>{}</figure>)", caption,
                       drawing);
}

using Measure = double (*)(const Outline&);

Value solved(Measure measure) {
    return [measure](const FrameReport& f) {
        return f.outline ? finite(measure(*f.outline)) : std::nullopt;
    };
}

Value detected(Measure measure, bool overruled) {
    return [measure, overruled](const FrameReport& f) {
        const bool wanted = f.tracked && (f.outcome != FrameOutcome::found) == overruled;
        return wanted ? finite(measure(*f.tracked)) : std::nullopt;
    };
}

Value deviation(Measure measure) {
    return [measure](const FrameReport& f) {
        return f.tracked && f.outline && f.outcome == FrameOutcome::found
                   ? finite(measure(*f.tracked) - measure(*f.outline))
                   : std::nullopt;
    };
}

void extend(double& low, double& high, const Rows& frames, const Value& value) {
    for (const FrameReport* frame : frames)
        if (const auto v = value(*frame)) {
            low = std::min(low, *v);
            high = std::max(high, *v);
        }
}

struct Panel {
    std::string_view title;
    Measure measure;
    std::string_view kind;  ///< class of its colour
};

const Panel kPanels[] = {
    {"centre x", [](const Outline& o) { return o.cx; }, "x"},
    {"centre y", [](const Outline& o) { return o.cy; }, "y"},
    {"radius", radius, "r"},
};

std::string track_chart(const Rows& frames, const Panel& panel) {
    constexpr double kTop = 8, kBottom = 158, kHeight = 190;
    const Scale x = frame_scale(frames);
    // Overruled detections may lie anywhere: they do not stretch the scale, but are marked at its
    // edge.
    double low = kInfinite, high = -kInfinite;
    extend(low, high, frames, solved(panel.measure));
    extend(low, high, frames, detected(panel.measure, false));
    const Scale y = value_scale(low, high, 1, kTop, kBottom);
    const auto all = stretches(frames);
    return chart(fmt::format("{}, pixels", panel.title),
                 svg(kHeight, panel.title,
                     bands(all, kTop, kBottom, false, "shade") +
                         frame_axis(frames, x, kTop, kBottom + kBand) + value_axis(y, "") +
                         bands(all, kBottom, kBottom + kBand, true, "band") +
                         line(frames, solved(panel.measure), x, y, panel.kind) +
                         dots(frames, detected(panel.measure, true), x, y, "overruled") +
                         dots(frames, detected(panel.measure, false), x, y, "detected")));
}

/// Detected minus solved, where a curve as large as the shot's motion shows nothing.
std::string deviation_chart(const Rows& frames) {
    constexpr double kTop = 8, kBottom = 158, kHeight = 190;
    const Scale x = frame_scale(frames);
    std::vector<double> sizes;
    for (const Panel& panel : kPanels)
        for (const FrameReport* frame : frames)
            if (const auto v = deviation(panel.measure)(*frame)) sizes.push_back(std::abs(*v));
    if (sizes.empty()) return "";
    // The largest hundredth may stick out: one bad frame must not flatten the others.
    auto most = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() - 1 - sizes.size() / 100);
    std::nth_element(sizes.begin(), most, sizes.end());
    const Scale y = value_scale(-*most, *most, 0.1, kTop, kBottom);
    std::string drawing = bands(stretches(frames), kTop, kBottom, false, "shade") +
                          frame_axis(frames, x, kTop, kBottom) + value_axis(y, "");
    for (const Panel& panel : kPanels) {
        const Value value = deviation(panel.measure);
        drawing += line(frames, value, x, y, fmt::format("{} thin", panel.kind));
        drawing += dots(frames, value, x, y, fmt::format("{} small", panel.kind));
    }
    return chart(R"(detected &minus; solved, pixels: <span class="key x">x</span> )"
                 R"(<span class="key y">y</span> <span class="key r">radius</span>)",
                 svg(kHeight, "detected minus solved", drawing));
}

}  // namespace

std::string outcome_band(const Rows& frames) {
    if (frames.empty()) return "";
    return svg(44, "outcome of each frame",
               bands(stretches(frames), 2, 22, true, "band") +
                   frame_axis(frames, frame_scale(frames), 22, 26));
}

std::string track_charts(const Rows& frames) {
    if (frames.empty()) return "";
    std::string charts;
    for (const Panel& panel : kPanels) charts += track_chart(frames, panel);
    return charts + deviation_chart(frames);
}

std::string timing_chart(const Rows& frames) {
    if (frames.empty()) return "";
    constexpr double kTop = 8, kBottom = 128, kHeight = 154;
    const Columns columns(frames);
    std::vector<const FrameReport*> slowest(columns.count());
    double longest = 0;
    for (const FrameReport* frame : frames) {
        if (!std::isfinite(frame->seconds)) continue;
        longest = std::max(longest, frame->seconds);
        const FrameReport*& most = slowest[columns.of(*frame)];
        if (!most || frame->seconds > most->seconds) most = frame;
    }
    const Scale y{0, longest > 0 ? 1.05 * longest : 1, kBottom, kTop};

    const double gap = columns.left(1) - columns.left(0) > 4 ? 1 : 0;
    std::array<std::string, kOutcomes.size()> bars;
    for (std::size_t i = 0; i < slowest.size(); ++i)
        if (slowest[i] && slowest[i]->seconds > 0)
            bars[static_cast<std::size_t>(slowest[i]->outcome)] += rectangle(
                columns.left(i), y(slowest[i]->seconds), columns.left(i + 1) - gap, kBottom);
    return svg(kHeight, "seconds a frame",
               frame_axis(frames, frame_scale(frames), kTop, kBottom) + value_axis(y, " s") +
                   paths_of("bar", bars));
}

}  // namespace chromeball::html
