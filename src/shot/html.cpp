#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "shot/html_parts.h"
#include "shot/report.h"

namespace chromeball {
namespace {

using html::escaped;
using html::number;
using html::Rows;

constexpr std::size_t kMostPictured = 200;              ///< frames with pictures
constexpr std::size_t kPictureBytes = 2 * 1024 * 1024;  ///< of their files; a third more here
constexpr std::size_t kFewCards = 24;     ///< a card each; of more, lines and a scroll
constexpr std::size_t kMostLines = 1000;  ///< flagged frames beyond are in the table only
constexpr std::size_t kOpenTable = 400;   ///< rows; a longer table is folded

Rows in_order(const ShotReport& report) {
    Rows frames;
    for (const FrameReport& frame : report.frames) frames.push_back(&frame);
    std::stable_sort(frames.begin(), frames.end(),
                     [](const auto* a, const auto* b) { return a->frame < b->frame; });
    return frames;
}

Rows flagged(const Rows& frames) {
    Rows some;
    std::copy_if(frames.begin(), frames.end(), std::back_inserter(some),
                 [](const FrameReport* frame) { return frame->flagged; });
    return some;
}

/// 0 to count - 1, each once, so that any beginning of the list is spread evenly: the van der
/// Corput sequence.
std::vector<std::size_t> spread(std::size_t count) {
    std::size_t bits = 0;
    while ((std::size_t{1} << bits) < count) ++bits;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < std::size_t{1} << bits; ++i) {
        std::size_t mirrored = 0;
        for (std::size_t bit = 0; bit < bits; ++bit) mirrored |= (i >> bit & 1) << (bits - 1 - bit);
        if (mirrored < count) order.push_back(mirrored);
    }
    return order;
}

/// The frames whose pictures the page shows: flagged ones first, then others evenly spaced, as far
/// as the page stays light. Half of the room is for the others: a shot with a thousand flagged
/// frames is still to be seen as a whole.
std::set<const FrameReport*> pictured(const Rows& frames) {
    std::set<const FrameReport*> chosen;
    std::size_t bytes = 0;
    const auto choose_among = [&](const Rows& some, std::size_t most, std::size_t most_bytes) {
        for (const std::size_t i : spread(some.size())) {
            const std::size_t size = some[i]->thumbnail.size() + some[i]->probe.size();
            if (size == 0 || chosen.size() >= most || bytes + size > most_bytes) continue;
            if (chosen.insert(some[i]).second) bytes += size;
        }
    };
    choose_among(flagged(frames), kMostPictured / 2, kPictureBytes / 2);
    choose_among(frames, kMostPictured, kPictureBytes);
    return chosen;
}

std::string_view name(const FrameReport& frame) { return name_of(frame.outcome); }

std::string badge(const FrameReport& frame) {
    return fmt::format(R"(<span class="badge {0}">{0}</span>)", name(frame));
}

std::string link_to(const FrameReport& frame) {
    return fmt::format(R"(<a class="number" href="#f{0}">{0}</a>)", frame.frame);
}

/// Empty where the file is no picture.
std::string image(const std::string& file, const std::string& description) {
    const std::string uri = html::data_uri(file);
    return uri.empty() ? "" : fmt::format(R"(<img alt="{}" src="{}">)", escaped(description), uri);
}

/// Empty where there is nothing to show.
std::string section(std::string_view id, const std::string& title, const std::string& content) {
    if (content.empty()) return "";
    return fmt::format("<section id=\"{}\"><h2>{}</h2>{}</section>\n", id, title, content);
}

std::string small(const std::string& text) { return fmt::format(" <small>{}</small>", text); }

std::string counts(const Rows& frames) {
    std::string boxes;
    for (const FrameOutcome outcome : kOutcomes) {
        const auto count = std::count_if(frames.begin(), frames.end(), [&](const FrameReport* f) {
            return f->outcome == outcome;
        });
        boxes += fmt::format(R"(<div class="count {0}{1}"><b>{2}</b>{0}</div>)", name_of(outcome),
                             count == 0 ? " none" : "", count);
    }
    return fmt::format(R"(<div class="counts">{}</div>)", boxes);
}

std::string_view plural(std::size_t count) { return count == 1 ? "" : "s"; }

std::string header(const ShotReport& report, const Rows& frames) {
    std::string told = fmt::format("{} frame{}", frames.size(), plural(frames.size()));
    if (!frames.empty())
        told += fmt::format(", {} to {}", frames.front()->frame, frames.back()->frame);
    if (report.wall_seconds > 0) {
        const double rate = static_cast<double>(frames.size()) / report.wall_seconds;
        told +=
            fmt::format(" &middot; {} frames/s, {} s with {} job{}", number(rate, 2),
                        number(report.wall_seconds, 1), report.jobs, report.jobs == 1 ? "" : "s");
    }
    return fmt::format("<header><h1>{}</h1><p class=\"summary\">{}</p>{}{}</header>\n",
                       escaped(report.title), told, counts(frames), html::outcome_band(frames));
}

std::string card(const FrameReport& frame, const std::string& picture) {
    const std::string message =
        frame.message.empty() ? "" : fmt::format("<p>{}</p>", escaped(frame.message));
    return fmt::format(R"(<figure class="card {}">{}<figcaption><div class="row">{}{})"
                       R"(<span class="soft" title="confidence">{} %</span></div>{})"
                       "</figcaption></figure>",
                       name(frame), picture, link_to(frame), badge(frame),
                       number(100 * frame.confidence, 0), message);
}

std::string flagged_section(const Rows& frames, const std::set<const FrameReport*>& with_picture) {
    const Rows some = flagged(frames);
    const bool few = some.size() <= kFewCards;
    std::string cards, lines;
    std::size_t without = 0;
    for (const FrameReport* frame : some) {
        std::string picture;
        if (with_picture.contains(frame))
            picture = image(frame->thumbnail, fmt::format("frame {}, outline drawn", frame->frame));
        if (few && picture.empty()) picture = R"(<div class="nothing">no picture</div>)";
        if (!picture.empty())
            cards += card(*frame, picture);
        else if (++without <= kMostLines)
            lines += fmt::format("<p>{} {} {}</p>", link_to(*frame), badge(*frame),
                                 escaped(frame->message));
    }
    std::string content = some.empty() ? R"(<p class="soft">None: nothing to look at.</p>)" : "";
    const std::string_view scroll = few ? "" : " scroll";
    if (!cards.empty()) content += fmt::format(R"(<div class="cards{}">{}</div>)", scroll, cards);
    if (!lines.empty()) content += fmt::format(R"(<div class="lines{}">{}</div>)", scroll, lines);
    if (without > kMostLines)
        content += fmt::format(R"(<p class="soft">and {} more in the table below</p>)",
                               without - kMostLines);
    return section("flagged", "Flagged frames" + small(fmt::format("{}", some.size())), content);
}

/// Pictures in a grid, under each its frame's number.
std::string strip(const Rows& frames, std::string FrameReport::*file, std::string_view kind) {
    std::string pictures;
    for (const FrameReport* frame : frames) {
        const std::string picture =
            image(frame->*file, fmt::format("{} of frame {}", kind, frame->frame));
        if (picture.empty()) continue;
        pictures += fmt::format(
            R"(<figure>{}<figcaption class="{}">{}<span>{}</span></figcaption></figure>)", picture,
            name(*frame), link_to(*frame),
            frame->outcome == FrameOutcome::found ? "" : name(*frame));
    }
    return pictures.empty() ? "" : fmt::format(R"(<div class="strip {}">{}</div>)", kind, pictures);
}

std::string timing(const Rows& frames) {
    std::vector<std::pair<double, int>> seconds;
    for (const FrameReport* frame : frames)
        if (frame->seconds > 0 && std::isfinite(frame->seconds))
            seconds.emplace_back(frame->seconds, frame->frame);
    if (seconds.empty()) return "";
    std::sort(seconds.begin(), seconds.end());
    return fmt::format(R"(<figure class="chart"><figcaption>seconds a frame: median {}, )"
                       "most {} (frame {})</figcaption>{}</figure>",
                       number(seconds[seconds.size() / 2].first, 3),
                       number(seconds.back().first, 3), seconds.back().second,
                       html::timing_chart(frames));
}

std::string table_row(const FrameReport& frame) {
    std::string row = fmt::format("<tr id=\"f{0}\"><td>{0}<td>{1}", frame.frame, badge(frame));
    const auto cell = [&](const std::string& content) { row += fmt::format("<td>{}", content); };
    const auto of_outline = [&](double (*value)(const Outline&)) {
        cell(frame.outline ? number(value(*frame.outline), 2) : "");
    };
    of_outline([](const Outline& o) { return o.cx; });
    of_outline([](const Outline& o) { return o.cy; });
    of_outline([](const Outline& o) { return html::radius(o); });
    cell(number(frame.confidence, 2));
    cell(number(frame.seconds, 3));
    cell(escaped(frame.message));
    return row + "</tr>\n";
}

std::string table(const Rows& frames) {
    if (frames.empty()) return "";
    std::string rows;
    for (const FrameReport* frame : frames) rows += table_row(*frame);
    return fmt::format(
        "<details id=\"frames\"{}><summary>All frames</summary><div class=\"scroll\"><table>"
        "<thead><tr><th>frame<th>outcome<th>centre x<th>centre y<th>radius<th>confidence"
        "<th>seconds<th>message</tr></thead><tbody>\n{}</tbody></table></div></details>\n",
        frames.size() <= kOpenTable ? " open" : "", rows);
}

std::string settings(const ShotReport& report) {
    if (report.settings_json.empty()) return "";
    return fmt::format(R"(<pre class="panel">{}</pre>)",
                       escaped(html::indented_json(report.settings_json)));
}

/// What the page may load: its own pictures and style, nothing from anywhere.
constexpr std::string_view kPolicy = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

}  // namespace

std::string to_html(const ShotReport& report) {
    const Rows frames = in_order(report);
    const auto with_picture = pictured(frames);
    Rows shown, calm;
    for (const FrameReport* frame : frames) {
        if (!with_picture.contains(frame)) continue;
        shown.push_back(frame);
        if (!frame->flagged) calm.push_back(frame);
    }
    const std::string some = shown.size() == frames.size()
                                 ? ""
                                 : small(fmt::format("{} of {}", shown.size(), frames.size()));
    const std::string title = escaped(report.title);
    std::string page = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
        "<meta name=\"generator\" content=\"chromeball\"><title>{}</title>"
        "<style>{}</style></head><body>\n",
        kPolicy, title, html::page_style());
    page += header(report, frames);
    page += flagged_section(frames, with_picture);
    page += section("track", "Track" + small("dots: detected; line: solved; shaded: not found"),
                    html::track_charts(frames));
    page += section("probes", "Probes" + some, strip(shown, &FrameReport::probe, "probe"));
    page += section("plates", "Plates" + some, strip(calm, &FrameReport::thumbnail, "plate"));
    page += section("timing", "Timing", timing(frames));
    page += table(frames);
    page += section("settings", "Settings", settings(report));
    return page + "</body></html>\n";
}

}  // namespace chromeball
