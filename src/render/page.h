#pragma once

#include <string>
#include <string_view>

#include "core/image.h"
#include "render/environment.h"
#include "render/mesh.h"

namespace chromeball {

/// What a page shows and how it begins.
struct PageOptions {
    std::string title;
    int face = 256;  ///< width of the cube map's faces; a power of two
    double azimuth = 30, elevation = 15, distance = 4, fov = 35;  ///< as View::orbit
};

/// A map's light as six faces below each other as OpenGL stores them, RGBA, alpha its coverage, not
/// multiplied; what the map lacks is filled in, and bilinear drawing is made up for. What a page
/// takes.
///
/// map:        what the environment was made of, with its layout; for the coverage
/// confidence: how far the map is to be believed, as large, 0 to 1 in its first channel; the
///             coverage is what is shown and believed. Empty: all that is shown
Image page_faces(const Environment& environment, const Image& map, const Layout& layout, int face,
                 const Image& confidence = {});

/// One HTML file that needs nothing else: a mirror mesh in a map, to be turned by hand in any
/// browser with WebGL 2. The map is a cube of half floats, its smaller levels are made by the page.
///
/// faces: from page_faces(), in linear Rec.709, as the page shows it on an sRGB display
/// mesh:  within the unit sphere
/// Some 3.2 MB for faces of 256 pixels, 30 bytes a vertex more.
std::string page(const Image& faces, const Mesh& mesh, const PageOptions& options);

/// src/render/page.html.
std::string_view page_template();

}  // namespace chromeball
