#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shot/report.h"

// The pieces of the page for people; html.cpp puts them together.

namespace chromeball::html {

/// The frames of a report, by rising number.
using Rows = std::vector<const FrameReport*>;

/// Any bytes as HTML text, fit for elements and for attributes in double quotes: & < > " ' are
/// escaped, what is no UTF-8 and control characters (but tab and newline) become U+FFFD.
std::string escaped(std::string_view bytes);

/// A number with so many decimals; an en dash for what is not finite.
std::string number(double value, int decimals);

/// A PNG or JPEG file as a data: URI; empty for any other bytes.
std::string data_uri(std::string_view file);

/// JSON text broken into indented lines, for eyes; text that is no JSON comes back much as it was.
std::string indented_json(std::string_view json);

/// The geometric mean of the semi-axes, pixels.
double radius(const Outline& outline);

/// What became of each frame, as one coloured band over the frame numbers: SVG.
std::string outcome_band(const Rows& frames);

/// Centre x, centre y and radius over the frame numbers, and how far detection is from the solve:
/// detected points, the solved line, bands where frames were not found. SVG whose size does not
/// grow with the number of frames: each of some 600 columns keeps its extremes.
std::string track_charts(const Rows& frames);

/// Seconds a frame as bars; the slowest of each column where frames outnumber columns. SVG.
std::string timing_chart(const Rows& frames);

/// The page's style sheet (page.css).
std::string_view page_style();

}  // namespace chromeball::html
