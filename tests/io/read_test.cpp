#include "io/read.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "io/facts.h"
#include "io/files.h"
#include "io/write.h"

namespace chromeball {
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;
using test::pattern;
using test::TempFolder;
using test::value_at;

/// Writes with OpenImageIO alone, as other programs would.
template <class T>
void write_foreign(const std::string& plugin, const std::string& file, const ImageSpec& spec,
                   const std::vector<T>& values) {
    auto out = OIIO::ImageOutput::create(plugin);
    ASSERT_TRUE(out) << plugin;
    ASSERT_TRUE(out->open(file, spec)) << out->geterror();
    ASSERT_TRUE(out->write_image(OIIO::BaseTypeFromC<T>::value, values.data())) << out->geterror();
    ASSERT_TRUE(out->close());
}

std::vector<std::uint16_t> ramp(std::size_t count) {
    std::vector<std::uint16_t> values(count);
    for (std::size_t i = 0; i < count; ++i)
        values[i] = static_cast<std::uint16_t>((i * 7919) % 65536);
    return values;
}

class Read : public testing::Test {
protected:
    TempFolder folder;
};

TEST_F(Read, EveryFormatGivesRowsAloneAndTheSameAsTheWhole) {
    const Image image = pattern({24, 40}, 3);
    for (const auto format :
         {FileFormat::exr, FileFormat::hdr, FileFormat::tif, FileFormat::png, FileFormat::jpg}) {
        const std::string file = folder / ("x." + std::string(extension_of(format)));
        WriteOptions options;
        options.format = format;
        write_image(file, image.view(), options);
        const Photo whole = read_photo(file);
        const Photo part = read_photo(file, {.rows = std::pair{13, 29}});
        ASSERT_EQ(part.window, (Window{0, 13, {24, 16}})) << file;
        ASSERT_EQ(part.display, whole.display);
        const std::size_t row = whole.pixels.size() / 40;
        ASSERT_EQ(part.pixels.size(), 16 * row);
        EXPECT_TRUE(std::equal(part.pixels.begin(), part.pixels.end(),
                               whole.pixels.begin() + static_cast<std::ptrdiff_t>(13 * row)))
            << file;
        EXPECT_TRUE(read_photo(file, {.rows = std::pair{50, 60}}).pixels.empty());
    }
}

TEST_F(Read, OfStripsAndTilesOnlyThoseOfTheRowsAreDecoded) {
    for (const bool tiled : {false, true}) {
        ImageSpec spec(64, 256, 3, TypeDesc::UINT16);
        spec.attribute("compression", "zip");
        spec.attribute("tiff:RowsPerStrip", 16);
        if (tiled) spec.tile_width = spec.tile_height = 16;
        const auto values = ramp(64 * 256 * 3);
        write_foreign("tiff", folder / "x.tif", spec, values);
        const Photo whole = read_photo(folder / "x.tif");
        std::string bytes = test::read_bytes(folder / "x.tif");
        // All but the middle is damaged; what tells where the parts lie stands at an end.
        const std::size_t third = bytes.size() / 3;
        bytes.replace(third / 2, third / 2, third / 2, '\x55');
        bytes.replace(2 * third, third / 2, third / 2, '\x55');
        test::write_bytes(folder / "x.tif", bytes);
        for (const int first : {112, 117}) {
            const Photo part = read_photo(folder / "x.tif", {.rows = std::pair{first, 141}});
            ASSERT_EQ(part.window, (Window{0, first, {64, 141 - first}}));
            EXPECT_TRUE(std::equal(part.pixels.begin(), part.pixels.end(),
                                   whole.pixels.begin() + first * 64 * 6));
        }
        // The damage is real: the whole is refused, or (libtiff may only warn) other pixels come.
        const std::string message = test::message_of(
            [&] { EXPECT_NE(read_photo(folder / "x.tif").pixels, whole.pixels) << tiled; });
        if (tiled) {
            EXPECT_NE(message, "no error");
        }
    }
}

TEST_F(Read, TheHeaderAloneTellsAllButPixels) {
    for (const auto format : {FileFormat::exr, FileFormat::hdr, FileFormat::png}) {
        const std::string file = folder / ("x." + std::string(extension_of(format)));
        WriteOptions options;
        options.format = format;
        write_image(file, pattern({24, 12}, 3).view(), options);
        const Photo header = read_header(file);
        const Photo photo = read_photo(file);
        EXPECT_TRUE(header.pixels.empty());
        EXPECT_EQ(header.name, file);
        EXPECT_EQ(header.display, photo.display);
        EXPECT_EQ(header.window, photo.window);
        EXPECT_EQ(header.channels, photo.channels);
        EXPECT_EQ(header.type, photo.type);
        EXPECT_EQ(header.metadata.all(), photo.metadata.all());
    }
}

TEST_F(Read, TheContentDecidesNotTheName) {
    WriteOptions options;
    options.format = FileFormat::png;
    write_image(folder / "x.jpg", pattern({8, 4}, 3).view(), options);
    EXPECT_EQ(read_photo(folder / "x.jpg").type, PixelType::u16);
    options.format = FileFormat::exr;
    write_image(folder / "noname", pattern({8, 4}, 3).view(), options);
    EXPECT_EQ(read_photo(folder / "noname").type, PixelType::f16);
}

TEST_F(Read, TenBitDpxComesAsSixteenBits) {
    const auto values = ramp(16 * 9 * 3);
    for (const int bits : {8, 10, 12, 16}) {
        ImageSpec spec(16, 9, 3, bits == 8 ? TypeDesc::UINT8 : TypeDesc::UINT16);
        spec.attribute("oiio:BitsPerSample", bits);
        write_foreign("dpx", folder / "x.dpx", spec, values);
        const Photo photo = read_photo(folder / "x.dpx");
        ASSERT_EQ(photo.type, bits == 8 ? PixelType::u8 : PixelType::u16);
        ASSERT_EQ(photo.channels, 3);
        for (int i = 0; i < 16 * 9 * 3; ++i)
            ASSERT_NEAR(value_at(photo, i / 3 % 16, i / 48, i % 3),
                        values[static_cast<std::size_t>(i)] / 65535.0, 1.0 / ((1 << bits) - 1))
                << bits;
        const Photo part = read_photo(folder / "x.dpx", {.rows = std::pair{4, 6}});
        EXPECT_EQ(part.window, (Window{0, 4, {16, 2}}));
        EXPECT_EQ(value_at(part, 3, 1, 2), value_at(photo, 3, 5, 2));
    }
}

TEST_F(Read, DpxTimeCodeAndFrameRateArePassedOn) {
    ImageSpec spec(4, 2, 3, TypeDesc::UINT16);
    const unsigned time_code[2] = {0x11223314u, 0};
    spec.attribute("smpte:TimeCode", OIIO::TypeTimeCode, time_code);
    spec.attribute("dpx:FrameRate", 25.0f);
    write_foreign("dpx", folder / "x.dpx", spec, ramp(24));
    const Metadata passed = pass_through(read_header(folder / "x.dpx").metadata);
    ASSERT_TRUE(passed.find("timeCode"));
    EXPECT_EQ(passed.find("timeCode")->type, "timecode");
    EXPECT_EQ(passed.find("timeCode")->numbers, (std::vector<double>{0x11223314, 0}));
    ASSERT_TRUE(passed.find("framesPerSecond"));
    EXPECT_EQ(passed.find("framesPerSecond")->numbers, (std::vector<double>{25, 1}));
}

TEST_F(Read, ChannelsBeyondColourAndAlphaAreDropped) {
    ImageSpec spec(4, 3, 6, TypeDesc::UINT16);
    spec.channelnames = {"R", "G", "B", "A", "Z", "id"};
    spec.alpha_channel = 3;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const auto values = ramp(72);
    write_foreign("tiff", folder / "x.tif", spec, values);
    const Photo photo = read_photo(folder / "x.tif");
    ASSERT_EQ(photo.channels, 4);
    EXPECT_FALSE(photo.associated_alpha);
    for (int x = 0; x < 4; ++x)
        for (int c = 0; c < 4; ++c)
            ASSERT_NEAR(value_at(photo, x, 2, c) * 65535,
                        values[static_cast<std::size_t>((8 + x) * 6 + c)], 0.01);
}

TEST_F(Read, GreyWithAlphaHasTwoChannels) {
    ImageSpec spec(4, 3, 2, TypeDesc::UINT16);
    spec.channelnames = {"Y", "A"};
    spec.alpha_channel = 1;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    const auto values = ramp(24);
    for (const auto& [plugin, name] : {std::pair{"png", "x.png"}, {"tiff", "x.tif"}}) {
        write_foreign(plugin, folder / name, spec, values);
        const Photo photo = read_photo(folder / name);
        ASSERT_EQ(photo.channels, 2) << name;
        EXPECT_FALSE(photo.associated_alpha) << name;
        EXPECT_NEAR(value_at(photo, 1, 1, 0) * 65535, values[10], 0.01) << name;
        EXPECT_NEAR(value_at(photo, 1, 1, 1) * 65535, values[11], 0.01) << name;
    }
}

TEST_F(Read, AssociatedTiffIsCalledSo) {
    ImageSpec spec(4, 3, 4, TypeDesc::UINT16);
    write_foreign("tiff", folder / "x.tif", spec, ramp(48));
    EXPECT_TRUE(read_photo(folder / "x.tif").associated_alpha);
    EXPECT_NEAR(value_at(read_photo(folder / "x.tif"), 1, 0, 0) * 65535, ramp(48)[4], 0.01);
}

TEST_F(Read, TypesWithoutAPlaceBecomeTheNextWiderOne) {
    const std::pair<TypeDesc, PixelType> types[] = {{TypeDesc::UINT8, PixelType::u8},
                                                    {TypeDesc::UINT16, PixelType::u16},
                                                    {TypeDesc::UINT32, PixelType::f32},
                                                    {TypeDesc::FLOAT, PixelType::f32},
                                                    {TypeDesc::DOUBLE, PixelType::f32}};
    for (const auto& [stored, type] : types) {
        write_foreign("tiff", folder / "x.tif", ImageSpec(4, 4, 3, stored), ramp(48));
        const Photo photo = read_photo(folder / "x.tif");
        EXPECT_EQ(photo.type, type) << stored.c_str();
        EXPECT_NEAR(value_at(photo, 1, 1, 1), ramp(48)[16] / 65535.0, 0.004) << stored.c_str();
    }
}

TEST_F(Read, APaletteIsExpanded) {
    // 2x1 pixels, indexes 0 and 1, palette red and blue; checksums by hand are not needed for
    // GIF, so the palette comes from there.
    const std::string gif(
        "GIF89a\x02\x00\x01\x00\x80\x00\x00\xff\x00\x00\x00\x00\xff"
        "\x2c\x00\x00\x00\x00\x02\x00\x01\x00\x00\x02\x02\x44\x0a\x00\x3b",
        35);
    test::write_bytes(folder / "x.gif", gif);
    const Photo photo = read_photo(folder / "x.gif");
    ASSERT_GE(photo.channels, 3);
    EXPECT_EQ(value_at(photo, 0, 0, 0), 1);
    EXPECT_EQ(value_at(photo, 1, 0, 0), 0);
    EXPECT_EQ(value_at(photo, 1, 0, 2), 1);
}

TEST_F(Read, ExifSaysSrgbAndFocalLengths) {
    ImageSpec spec(60, 40, 3, TypeDesc::UINT8);
    spec.attribute("Exif:ColorSpace", 1);
    spec.attribute("Exif:FocalLength", 40.0f);
    spec.attribute("Exif:FocalLengthIn35mmFilm", 60);
    spec.attribute("ExposureTime", 0.005f);
    spec.attribute("Make", "SONY");
    write_foreign("jpeg", folder / "x.jpg", spec, ramp(60 * 40 * 3));
    const Photo photo = read_header(folder / "x.jpg");
    EXPECT_EQ(photo.color.space, "sRGB");
    const auto facts = camera_from_metadata(photo.metadata, photo.display);
    ASSERT_TRUE(facts);
    EXPECT_NEAR(*facts->camera.focal, 100, 1e-6);  // 60 mm of 36 mm, 60 pixels wide
    EXPECT_EQ(pass_through(photo.metadata).text("cameraMake"), "SONY");
    EXPECT_NEAR(*pass_through(photo.metadata).number("expTime"), 0.005, 1e-5);
}

/// A minimal ICC profile with a description, as version 2 or 4 writes it.
std::vector<std::uint8_t> icc_profile(const std::string& description, bool version_4) {
    std::vector<std::uint8_t> tag;
    const auto put = [&](unsigned value) {
        for (int shift = 24; shift >= 0; shift -= 8)
            tag.push_back(static_cast<std::uint8_t>(value >> shift));
    };
    const auto length = static_cast<unsigned>(description.size());
    if (version_4) {
        for (const unsigned v : {0x6d6c7563u, 0u, 1u, 12u, 0x656e5553u, 2 * length, 28u}) put(v);
        for (const char c : description) {
            tag.push_back(0);
            tag.push_back(static_cast<std::uint8_t>(c));
        }
    } else {
        for (const unsigned v : {0x64657363u, 0u, length + 1}) put(v);
        tag.insert(tag.end(), description.begin(), description.end());
        tag.resize(tag.size() + 91);
    }
    std::vector<std::uint8_t> profile(128);
    std::swap(profile, tag);  // `put` writes to tag
    for (const unsigned v : {1u, 0x64657363u, 144u, static_cast<unsigned>(profile.size())}) put(v);
    tag.insert(tag.end(), profile.begin(), profile.end());
    tag[3] = static_cast<std::uint8_t>(tag.size());
    tag[2] = static_cast<std::uint8_t>(tag.size() >> 8);
    const std::string kind = "mntrRGB XYZ ";
    std::copy(kind.begin(), kind.end(), tag.begin() + 12);
    const std::string signature = "acsp";
    std::copy(signature.begin(), signature.end(), tag.begin() + 36);
    tag[8] = version_4 ? 4 : 2;
    return tag;
}

TEST_F(Read, TheIccProfileNamesTheColours) {
    for (const bool version_4 : {false, true})
        for (const auto& [plugin, name] : {std::pair{"tiff", "x.tif"}, {"jpeg", "x.jpg"}}) {
            const auto profile = icc_profile("Display P3", version_4);
            ImageSpec spec(8, 8, 3, TypeDesc::UINT8);
            spec.attribute("ICCProfile",
                           TypeDesc(TypeDesc::UINT8, static_cast<int>(profile.size())),
                           profile.data());
            spec.attribute("Exif:ColorSpace", 1);  // the profile is the better word
            write_foreign(plugin, folder / name, spec, ramp(8 * 8 * 3));
            const Photo photo = read_header(folder / name);
            EXPECT_EQ(photo.color.space, "Display P3") << name << version_4;
            EXPECT_FALSE(photo.metadata.find("ICCProfile"));
        }
}

TEST_F(Read, AGuessIsNoTag) {
    write_foreign("png", folder / "x.png", ImageSpec(4, 4, 3, TypeDesc::UINT8), ramp(48));
    write_foreign("tiff", folder / "x.tif", ImageSpec(4, 4, 3, TypeDesc::UINT16), ramp(48));
    write_foreign("dpx", folder / "x.dpx", ImageSpec(4, 4, 3, TypeDesc::UINT16), ramp(48));
    for (const char* name : {"x.png", "x.tif", "x.dpx"}) {
        EXPECT_EQ(read_header(folder / name).color.space, "") << name;
        EXPECT_FALSE(read_header(folder / name).color.chromaticities) << name;
    }
}

TEST_F(Read, OddShapesAreNoTrouble) {
    for (const Size size : {Size{1, 1}, Size{1, 5000}, Size{5000, 1}})
        for (const auto format :
             {FileFormat::exr, FileFormat::hdr, FileFormat::png, FileFormat::jpg}) {
            WriteOptions options;
            options.format = format;
            write_image(folder / "x", pattern(size, 3).view(), options);
            EXPECT_EQ(read_photo(folder / "x").display, size);
        }
}

TEST_F(Read, APositionOnAPrintedPageIsNoDataWindow) {
    ImageSpec spec(8, 4, 3, TypeDesc::UINT8);
    spec.x = 500;
    spec.y = 300;
    write_foreign("tiff", folder / "x.tif", spec, ramp(96));
    const Photo photo = read_photo(folder / "x.tif", {.rows = std::pair{1, 3}});
    EXPECT_EQ(photo.display, (Size{8, 4}));
    EXPECT_EQ(photo.window, (Window{0, 1, {8, 2}}));
}

TEST_F(Read, ADisplayWindowOfATiffCountsWhereItHoldsThePicture) {
    struct Case {
        Window full;  // as written; the picture is (10, 5) to (18, 9)
        Size display;
        int x, y;
    };
    const Case cases[] = {{{0, 0, {30, 20}}, {30, 20}, 10, 5},
                          {{12, 6, {3, 2}}, {8, 4}, 0, 0},
                          {{0, 0, {2'000'000'000, 10}}, {8, 4}, 0, 0}};
    for (const Case& c : cases) {
        ImageSpec spec(8, 4, 3, TypeDesc::UINT8);
        spec.x = 10;
        spec.y = 5;
        spec.full_x = c.full.x;
        spec.full_y = c.full.y;
        spec.full_width = c.full.size.width;
        spec.full_height = c.full.size.height;
        write_foreign("tiff", folder / "x.tif", spec, ramp(96));
        const Photo photo = read_photo(folder / "x.tif");
        EXPECT_EQ(photo.display, c.display);
        EXPECT_EQ(photo.window, (Window{c.x, c.y, {8, 4}}));
    }
}

}  // namespace
}  // namespace chromeball
