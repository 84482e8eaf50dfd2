#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <mutex>
#include <random>

#include "io/files.h"
#include "io/read.h"

// ZIP is not unpacked by OpenEXR: it must be as if it were.

namespace chromeball {
namespace {

using test::message_of;
using test::TempFolder;

struct Case {
    Imf::Compression compression;
    Imf::LineOrder order;
    Imf::PixelType color;  ///< of R, G, B
    Imath::Box2i data;
    bool noise;  ///< which ZIP stores as it is
};

/// R, G and B, and of other types before, between and behind them Depth, H and Z.
void write(const std::string& file, const Case& c) {
    Imf::Header header(c.data, c.data, 1, {0, 0}, 1, c.order, c.compression);
    const std::pair<const char*, Imf::PixelType> channels[] = {{"B", c.color}, {"Depth", Imf::UINT},
                                                               {"G", c.color}, {"H", Imf::HALF},
                                                               {"R", c.color}, {"Z", Imf::FLOAT}};
    const Size size{c.data.max.x - c.data.min.x + 1, c.data.max.y - c.data.min.y + 1};
    std::mt19937 random(5);
    std::vector<std::vector<std::uint32_t>> planes;
    Imf::FrameBuffer buffer;
    for (const auto& [name, type] : channels) {
        header.channels().insert(name, Imf::Channel(type));
        planes.emplace_back(size.pixels());
        std::uint32_t value = 0;
        for (auto& word : planes.back())
            // Any bits are a number of each type, infinities and NaNs too.
            word = c.noise ? static_cast<std::uint32_t>(random()) : value += 0x00010003;
        const std::size_t bytes = type == Imf::HALF ? 2 : 4;
        buffer.insert(name, Imf::Slice::Make(type, planes.back().data(), c.data, bytes));
    }
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(size.height);
}

/// R, G, B interleaved, as OpenEXR reads them.
PixelBytes read_by_library(const std::string& file, const Case& c) {
    Imf::InputFile in(file.c_str());
    const std::size_t value = c.color == Imf::HALF ? 2 : 4;
    const Size size{c.data.max.x - c.data.min.x + 1, c.data.max.y - c.data.min.y + 1};
    PixelBytes pixels(size.pixels() * 3 * value);
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < 3; ++i)
        buffer.insert(std::string(1, "RGB"[i]),
                      Imf::Slice::Make(c.color, pixels.data() + i * value, c.data, 3 * value));
    in.setFrameBuffer(buffer);
    in.readPixels(c.data.min.y, c.data.max.y);
    return pixels;
}

TEST(ExrZip, GivesWhatTheLibraryGives) {
    const TempFolder folder;
    const std::string file = folder / "x.exr";
    const Imath::Box2i boxes[] = {{{0, 0}, {36, 70}}, {{-7, -20}, {-7, 27}}, {{3, 5}, {302, 5}}};
    for (const auto compression : {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION})
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
            for (const auto color : {Imf::HALF, Imf::FLOAT})
                for (const auto& box : boxes)
                    for (const bool noise : {false, true}) {
                        const Case c{compression, order, color, box, noise};
                        write(file, c);
                        const auto theirs = read_by_library(file, c);
                        const Photo whole = read_photo(file);
                        ASSERT_EQ(whole.channels, 3);
                        ASSERT_TRUE(whole.pixels == theirs);
                        const int height = whole.window.size.height;
                        const std::size_t row = theirs.size() / static_cast<std::size_t>(height);
                        for (int first = 0; first < height; first += 11) {
                            const int last = std::min(height, first + 19);
                            const Photo part = read_photo(file, {.rows = std::pair{first, last}});
                            ASSERT_EQ(part.pixels.size(),
                                      row * static_cast<std::size_t>(last - first));
                            ASSERT_EQ(
                                std::memcmp(part.pixels.data(),
                                            theirs.data() + row * static_cast<std::size_t>(first),
                                            part.pixels.size()),
                                0);
                        }
                    }
}

TEST(ExrZip, ComesInBandsThatAreTheWhole) {
    const TempFolder folder;
    const std::string file = folder / "x.exr";
    for (const auto compression :
         {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION,
          Imf::DWAB_COMPRESSION}) {
        write(file, {compression, Imf::INCREASING_Y, Imf::FLOAT, {{-3, 5}, {40, 204}}, false});
        const bool ours =
            compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION;
        for (const auto& rows : {std::pair{0, 200}, {0, 1}, {17, 150}, {199, 400}, {300, 310}}) {
            const Photo whole = read_photo(file, {.rows = rows});
            PixelBytes pixels(whole.pixels.size());
            std::mutex one_at_a_time;
            int bands = 0, taken = 0;
            const auto take = [&](const Photo& band) {
                const std::lock_guard lock(one_at_a_time);
                ++bands;
                taken += band.window.size.height;
                ASSERT_EQ(band.window.x, whole.window.x);
                ASSERT_EQ(band.window.size.width, whole.window.size.width);
                ASSERT_EQ(band.display, whole.display);
                ASSERT_EQ(band.type, whole.type);
                ASSERT_EQ(band.channels, whole.channels);
                const auto at = static_cast<std::size_t>(band.window.y - whole.window.y) *
                                static_cast<std::size_t>(44 * 3 * 4);
                ASSERT_LE(at + band.pixels.size(), pixels.size());
                std::ranges::copy(band.pixels, pixels.begin() + static_cast<std::ptrdiff_t>(at));
            };
            const Photo rest = read_photo(file, {.rows = rows, .bands = take});
            EXPECT_TRUE(rest.pixels.empty());
            EXPECT_EQ(rest.window, whole.window);
            EXPECT_EQ(taken, whole.window.size.height);
            EXPECT_TRUE(pixels == whole.pixels);
            EXPECT_EQ(bands > 1, taken > (ours ? 32 : 64));
        }
    }
}

TEST(ExrZip, DamagedIsRefusedInWords) {
    const TempFolder folder;
    const std::string file = folder / "x.exr";
    write(file, {Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, Imf::HALF, {{0, 0}, {99, 99}}, false});
    const std::string bytes = test::read_bytes(file);
    for (const double place : {0.5, 0.7, 0.9}) {
        std::string damaged = bytes;
        const auto at = static_cast<std::size_t>(place * static_cast<double>(bytes.size()));
        damaged.replace(at, 16, 16, '\xaa');
        test::write_bytes(file, damaged);
        EXPECT_EQ(message_of([&] { read_photo(file); }),
                  file + ": damaged: rows of pixels cannot be inflated; copy or render it again");
    }
}

}  // namespace
}  // namespace chromeball
