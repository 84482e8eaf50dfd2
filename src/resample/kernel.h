#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

// Between the resampler and its vector kernels: what they need to know, as plain numbers. Not for
// other layers.

namespace chromeball::kernel {

/// How a tile's pixels get their directions: matrix applied to a direction of the target's own
/// shape. Positions are pixels, counted from the middle of the picture (of a face: of its cell).
struct TargetForm {
    enum class Shape { latlong, face, angular, ball };
    Shape shape = Shape::latlong;
    float width = 0, height = 0;  ///< of the picture or the cell, pixels
    /// Rows. Of a face: its columns are right, down and forward. The result is in the source's own
    /// frame: of a ball two axes across and the one towards the camera, else the source's world.
    std::array<float, 9> matrix{};
};

/// What a ball's rim shows, see RimStrip: rows by depth, columns along the rim, the first one again
/// at the end.
struct StripForm {
    const float* pixels = nullptr;  ///< null: none
    int columns = 0, rows = 0;
    float first = 0, last = -1, rows_per_pixel = 1;
};

/// Where a source shows a direction of its own frame, and what is there.
struct SourceForm {
    enum class Shape { latlong, cube, angular, ball };
    Shape shape = Shape::latlong;
    const float* pixels = nullptr;  ///< RGBA
    std::int32_t stride = 0;        ///< pixels from row to row
    std::int32_t face_pixels = 0;   ///< of a cube: from face to face
    /// Of a map: position in the unit square (in a cube's face) -> pixels.
    float x0 = 0, y0 = 0, x_scale = 0, y_scale = 0;
    /// A footprint of which a part lies outside is not taken as flat: seams; of a ball the part of
    /// the photo that exists.
    float left = 0, top = 0, right = 0, bottom = 0;

    // Of a ball. With (s, t) = sin(theta / 2) (cos phi, sin phi), theta and phi the direction's
    // angles around the line to the camera, and v = cos(theta / 2), the position is
    //     base + M (a, b) / (1 + k.(a, b)),   (a, b) = g(v) (s, t)
    // where g(v) = tan(view angle) / sin(theta / 2), a polynomial; 1 and k = 0 if orthographic.
    static constexpr int kMostTerms = 24;
    std::array<float, kMostTerms> g{};  ///< in (v - g_middle) * g_scale, highest power first
    int g_terms = 0;                    ///< 0: orthographic
    float g_middle = 0, g_scale = 0;
    float base_x = 0, base_y = 0;
    std::array<float, 4> to_pixels{};
    float k_a = 0, k_b = 0;
    float hidden_v = 0;  ///< directions whose v is at most that are hidden
    float curved_v = 0;  ///< and here the ball bends strongly
    /// With a lens: to_pixels and base lead to offsets on the pinhole's plane (focal length 1) from
    /// (lens_x, lens_y), then the lens bends, then lens_to_pixels.
    bool lens = false;
    float lens_x = 0, lens_y = 0, k1 = 0, k2 = 0, k3 = 0;
    std::array<float, 4> lens_to_pixels{};
    /// Pixels from (centre_x, centre_y) -> unit disk of the outline.
    float centre_x = 0, centre_y = 0;
    std::array<float, 4> to_disk{};
    float long_axis = 1, short_axis = 1;
    StripForm strip;
};

struct Job {
    SourceForm source;
    bool adaptive = true;
};

/// A part of a picture to draw. Pixels [x0, x1) x [y0, y1) of the cell; out is the first of them.
struct Tile {
    TargetForm target;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    float* out = nullptr;
    std::ptrdiff_t stride = 0;  ///< floats from row to row
    /// The whole picture is larger than caches, and its pixels start on multiples of 16 bytes.
    bool large = false;
};

/// At most that wide.
constexpr int kTileWidth = 256;
constexpr int kTileHeight = 32;

/// Draws a tile, with the best instructions that this processor has.
void draw(const Job& job, const Tile& tile);

/// A pixel of the source that is lit, and its colour.
struct LitPixel {
    std::int32_t at = 0;  ///< number among the source's pixels
    float color[3] = {};
};

/// A few pixels that are lit, by rising numbers; at least one. None of them reaches a ball's rim.
struct LitForm {
    const float* picture = nullptr;  ///< the source's pixels
    const LitPixel* pixels = nullptr;
    std::size_t count = 0;
};

/// What draw() would draw if all the source's pixels were black but these.
void draw_lit(const Job& job, const Tile& tile, const LitForm& lit);

/// Where the source shows the directions of the pixels' middles: a look at what draw() does inside,
/// for tests. NaN where it does not. Row by row, of a cube in the padded faces below each other.
void locate(const Job& job, const Tile& tile, float* x, float* y);

}  // namespace chromeball::kernel
