#include "io/clip.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "io/decoders.h"
#include "io/probe.h"

namespace chromeball {

bool is_clip_name(std::string_view path) {
    constexpr std::array<std::string_view, 10> kNames = {"mov", "mp4", "m4v",  "mkv",  "avi",
                                                         "mxf", "mpg", "mpeg", "webm", "mts"};
    const auto dot = path.rfind('.');
    if (dot == std::string_view::npos) return false;
    std::string extension(path.substr(dot + 1));
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::ranges::find(kNames, extension) != kNames.end();
}

struct Clip::State {
    std::unique_ptr<io::ClipReader> reader;
};

Clip::Clip(const std::string& path) : state_(std::make_unique<State>()) {
    io::check_file(path);
    state_->reader = io::open_clip_with_oiio(path);
}

Clip::~Clip() = default;

int Clip::frames() const { return state_->reader->frames(); }

Photo Clip::read(int index, bool header_only) { return state_->reader->read(index, header_only); }

}  // namespace chromeball
