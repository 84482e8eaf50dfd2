#include "io/orient.h"

#include <cstring>

namespace chromeball::io {
namespace {

/// How stored coordinates become upright ones: first x and y may change places, then either may run
/// backwards. EXIF 2.32, tag Orientation: where the stored row 0 and column 0 lie.
struct Turn {
    bool swap, mirror_x, mirror_y;
};
constexpr Turn kTurns[9] = {
    {},
    {false, false, false},  // 1 top left
    {false, true, false},   // 2 top right
    {false, true, true},    // 3 bottom right
    {false, false, true},   // 4 bottom left
    {true, false, false},   // 5 left top
    {true, true, false},    // 6 right top: turn by 90 degrees clockwise
    {true, true, true},     // 7 right bottom
    {true, false, true},    // 8 left bottom
};

Turn turn_of(int orientation) {
    return orientation >= 1 && orientation <= 8 ? kTurns[orientation] : kTurns[1];
}

Window turned(Window window, Size& display, Turn turn) {
    if (turn.swap) {
        std::swap(window.x, window.y);
        std::swap(window.size.width, window.size.height);
        std::swap(display.width, display.height);
    }
    if (turn.mirror_x) window.x = display.width - window.x - window.size.width;
    if (turn.mirror_y) window.y = display.height - window.y - window.size.height;
    return window;
}

}  // namespace

bool turns_by_90(int orientation) { return turn_of(orientation).swap; }

void make_upright(Photo& photo, int orientation) {
    const Turn turn = turn_of(orientation);
    if (!turn.swap && !turn.mirror_x && !turn.mirror_y) return;
    const Size from = photo.window.size;
    photo.window = turned(photo.window, photo.display, turn);
    if (photo.pixels.empty()) return;
    const Size to = photo.window.size;
    const std::size_t pixel =
        bytes_per_value(photo.type) * static_cast<std::size_t>(photo.channels);
    PixelBytes upright(photo.pixels.size());
    for (int y = 0; y < to.height; ++y) {
        const int v = turn.mirror_y ? to.height - 1 - y : y;
        std::byte* out = upright.data() + Size{to.width, y}.pixels() * pixel;
        for (int x = 0; x < to.width; ++x, out += pixel) {
            const int u = turn.mirror_x ? to.width - 1 - x : x;
            const int stored_x = turn.swap ? v : u;
            const int stored_y = turn.swap ? u : v;
            const std::size_t at =
                Size{from.width, stored_y}.pixels() + static_cast<std::size_t>(stored_x);
            std::memcpy(out, photo.pixels.data() + at * pixel, pixel);
        }
    }
    photo.pixels = std::move(upright);
}

std::optional<std::pair<int, int>> stored_rows(const std::optional<std::pair<int, int>>& rows,
                                               int orientation, int stored_height) {
    const Turn turn = turn_of(orientation);
    if (!rows || turn.swap) return std::nullopt;
    if (!turn.mirror_y) return rows;
    return std::pair{stored_height - rows->second, stored_height - rows->first};
}

}  // namespace chromeball::io
