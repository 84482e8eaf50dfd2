#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <random>

#include "io/files.h"
#include "io/read.h"

// Files that end early are refused although the rows that are wanted are there.

namespace chromeball {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
using test::TempFolder;

constexpr int kWidth = 96, kHeight = 160;

struct Kind {
    std::string name;  ///< for messages
    std::string plugin, extension;
    std::string compression = "";
    int tile = 0;
    bool wide = false;  ///< BigTIFF
    int rows_per_strip = 8;
};

const Kind kKinds[] = {
    {"OpenEXR", "openexr", "exr", "zip"},
    {"TIFF", "tiff", "tif", "none"},
    {"TIFF of one strip", "tiff", "tif", "none", 0, false, kHeight},
    {"TIFF, the last strip short", "tiff", "tif", "none", 0, false, 48},
    {"TIFF, packed", "tiff", "tif", "lzw"},
    {"TIFF of tiles", "tiff", "tif", "zip", 16},
    {"BigTIFF", "tiff", "tif", "zip", 0, true},
    {"DPX", "dpx", "dpx"},
    {"Radiance", "hdr", "hdr"},
    {"BMP", "bmp", "bmp"},
    {"PNG", "png", "png"},
    {"JPEG", "jpeg", "jpg"},
};

/// Noise, so that no part of the file is small.
std::vector<float> noise() {
    std::mt19937 random(5);
    std::vector<float> values(std::size_t{kWidth} * kHeight * 3);
    for (float& value : values) value = static_cast<float>(random() % 1000) / 1000;
    return values;
}

std::string picture(const TempFolder& folder, const Kind& kind) {
    ImageSpec spec(kWidth, kHeight, 3,
                   kind.plugin == "openexr" || kind.plugin == "hdr" ? TypeDesc::FLOAT
                   : kind.plugin == "bmp" || kind.plugin == "jpeg"  ? TypeDesc::UINT8
                                                                    : TypeDesc::UINT16);
    if (!kind.compression.empty()) spec.attribute("compression", kind.compression);
    spec.attribute("tiff:RowsPerStrip", kind.rows_per_strip);
    if (kind.wide) spec.attribute("tiff:bigtiff", 1);
    spec.tile_width = spec.tile_height = kind.tile;
    const std::string file = folder / ("whole." + kind.extension);
    const auto out = OIIO::ImageOutput::create(kind.plugin);
    EXPECT_TRUE(out && out->open(file, spec)) << kind.name;
    EXPECT_TRUE(out->write_image(TypeDesc::FLOAT, noise().data())) << kind.name;
    EXPECT_TRUE(out->close());
    return test::read_bytes(file);
}

/// Of the rows first to last alone.
std::string message(const std::string& file, int first, int last) {
    return test::message_of([&] { read_photo(file, {.rows = std::pair{first, last}}); });
}

TEST(Truncated, FilesAreRefusedWhicheverRowsAreWanted) {
    const TempFolder folder;
    for (const Kind& kind : kKinds) {
        const std::string bytes = picture(folder, kind);
        const std::string file = folder / ("cut." + kind.extension);
        test::write_bytes(file, bytes);
        EXPECT_EQ(message(file, 0, 4), "no error") << kind.name;
        EXPECT_EQ(message(file, kHeight - 4, kHeight), "no error") << kind.name;
        for (const double part : {0.5, 0.8, 0.95}) {
            const auto length = static_cast<std::size_t>(part * static_cast<double>(bytes.size()));
            test::write_bytes(file, bytes.substr(0, length));
            for (const int first : {0, 40, kHeight - 4}) {
                const std::string said = message(file, first, first + 4);
                EXPECT_TRUE(said.find("cut." + kind.extension) != std::string::npos &&
                            said.find("copy") != std::string::npos)
                    << kind.name << ' ' << part << ' ' << first << ": " << said;
            }
        }
    }
}

}  // namespace
}  // namespace chromeball
