#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "io/files.h"
#include "io/orient.h"
#include "io/read.h"

namespace chromeball {
namespace {

using test::TempFolder;
using test::value_at;

constexpr int kWidth = 5;
constexpr int kHeight = 3;

/// A TIFF whose stored pixel (x, y) has the value 10 y + x.
void write_tiff(const std::string& file, int orientation, int tile = 0) {
    std::vector<std::uint8_t> values;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) values.push_back(static_cast<std::uint8_t>(10 * y + x));
    OIIO::ImageSpec spec(kWidth, kHeight, 1, OIIO::TypeDesc::UINT8);
    spec.attribute("Orientation", orientation);
    if (tile) spec.tile_width = spec.tile_height = tile;
    auto out = OIIO::ImageOutput::create("tiff");
    ASSERT_TRUE(out->open(file, spec) && out->write_image(OIIO::TypeDesc::UINT8, values.data()) &&
                out->close());
}

std::vector<std::vector<int>> rows_of(const Photo& photo) {
    std::vector<std::vector<int>> rows;
    for (int y = 0; y < photo.window.size.height; ++y) {
        rows.emplace_back();
        for (int x = 0; x < photo.window.size.width; ++x)
            rows.back().push_back(static_cast<int>(std::lround(value_at(photo, x, y, 0) * 255)));
    }
    return rows;
}

using Rows = std::vector<std::vector<int>>;

// Written out by hand from the definition: which corner and side the first row and column are.
const Rows kUpright[9] = {
    {},
    {{0, 1, 2, 3, 4}, {10, 11, 12, 13, 14}, {20, 21, 22, 23, 24}},
    {{4, 3, 2, 1, 0}, {14, 13, 12, 11, 10}, {24, 23, 22, 21, 20}},
    {{24, 23, 22, 21, 20}, {14, 13, 12, 11, 10}, {4, 3, 2, 1, 0}},
    {{20, 21, 22, 23, 24}, {10, 11, 12, 13, 14}, {0, 1, 2, 3, 4}},
    {{0, 10, 20}, {1, 11, 21}, {2, 12, 22}, {3, 13, 23}, {4, 14, 24}},
    {{20, 10, 0}, {21, 11, 1}, {22, 12, 2}, {23, 13, 3}, {24, 14, 4}},
    {{24, 14, 4}, {23, 13, 3}, {22, 12, 2}, {21, 11, 1}, {20, 10, 0}},
    {{4, 14, 24}, {3, 13, 23}, {2, 12, 22}, {1, 11, 21}, {0, 10, 20}},
};

TEST(Orientation, IsAppliedToPixelsAndWindows) {
    const TempFolder folder;
    for (int orientation = 1; orientation <= 8; ++orientation) {
        write_tiff(folder / "x.tif", orientation);
        const Photo photo = read_photo(folder / "x.tif");
        EXPECT_EQ(rows_of(photo), kUpright[orientation]) << orientation;
        const Size size = orientation < 5 ? Size{kWidth, kHeight} : Size{kHeight, kWidth};
        EXPECT_EQ(photo.display, size);
        EXPECT_EQ(photo.window, (Window{0, 0, size}));
        EXPECT_FALSE(photo.metadata.find("Orientation"));
        EXPECT_EQ(read_header(folder / "x.tif").display, size);
    }
}

TEST(Orientation, ADataWindowStaysAroundItsPixels) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
        // The two pixels (1, 2) and (2, 2) of a picture 5 x 3, see kUpright.
        Photo photo;
        photo.channels = 1;
        photo.display = {kWidth, kHeight};
        photo.window = {1, 2, {2, 1}};
        photo.pixels = {std::byte{21}, std::byte{22}};
        io::make_upright(photo, orientation);
        const Rows rows = rows_of(photo);
        const Rows& all = kUpright[orientation];
        ASSERT_EQ(std::ssize(rows), photo.window.size.height);
        for (std::size_t y = 0; y < rows.size(); ++y)
            for (std::size_t x = 0; x < rows[y].size(); ++x)
                EXPECT_EQ(rows[y][x], all.at(y + static_cast<std::size_t>(photo.window.y))
                                          .at(x + static_cast<std::size_t>(photo.window.x)))
                    << orientation;
    }
}

TEST(Orientation, RowsAreThoseOfTheUprightPicture) {
    const TempFolder folder;
    for (const int tile : {0, 16})
        for (int orientation = 1; orientation <= 8; ++orientation)
            for (int first = 0; first < kHeight; ++first)
                for (int last = first + 1; last <= kHeight; ++last) {
                    write_tiff(folder / "x.tif", orientation, tile);
                    const Photo photo =
                        read_photo(folder / "x.tif", {.rows = std::pair{first, last}});
                    const Rows& all = kUpright[orientation];
                    ASSERT_LE(photo.window.y, first);
                    ASSERT_GE(photo.window.y + photo.window.size.height, last);
                    if (orientation < 5) {
                        ASSERT_EQ(photo.window.size.height, last - first);
                    }
                    const auto from = all.begin() + photo.window.y;
                    ASSERT_EQ(rows_of(photo), Rows(from, from + photo.window.size.height))
                        << orientation << ' ' << first << ' ' << last;
                }
}

}  // namespace
}  // namespace chromeball
