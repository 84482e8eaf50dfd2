#include "io/write.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfCompressionAttribute.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>

#include "io/facts.h"
#include "io/files.h"
#include "io/read.h"

namespace chromeball {
namespace {

using test::message_of;
using test::pattern;
using test::TempFolder;
using test::value_at;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One way to write, and what comes back.
struct Way {
    const char* name;
    FileFormat format;
    bool full_float;
    int bits;
    PixelType type;
    bool alpha, associated;
    double tolerance;  ///< of a value in (0, 1)
};
const Way kWays[] = {
    {"half.exr", FileFormat::exr, false, 16, PixelType::f16, true, true, 5e-4},
    {"float.exr", FileFormat::exr, true, 16, PixelType::f32, true, true, 0},
    // RGBE: eight bits of mantissa, shared exponent of the largest channel.
    {"x.hdr", FileFormat::hdr, false, 16, PixelType::f32, false, true, 1.0 / 256},
    {"8.tif", FileFormat::tif, false, 8, PixelType::u8, true, false, 0.51 / 255},
    {"16.tif", FileFormat::tif, false, 16, PixelType::u16, true, false, 0.51 / 65535},
    {"float.tif", FileFormat::tif, true, 16, PixelType::f32, true, false, 1e-6},
    {"8.png", FileFormat::png, false, 8, PixelType::u8, true, false, 0.51 / 255},
    {"16.png", FileFormat::png, false, 16, PixelType::u16, true, false, 0.51 / 65535},
    // Smooth values survive the transform nearly unharmed at quality 95.
    {"x.jpg", FileFormat::jpg, false, 8, PixelType::u8, false, true, 0.03},
};

class EveryFormat : public testing::TestWithParam<Way> {
protected:
    WriteOptions options() const {
        WriteOptions options;
        options.format = GetParam().format;
        options.full_float = GetParam().full_float;
        options.bits = GetParam().bits;
        return options;
    }
    TempFolder folder;
    std::string file = folder / GetParam().name;
};
INSTANTIATE_TEST_SUITE_P(Ways, EveryFormat, testing::ValuesIn(kWays), [](const auto& way) {
    std::string name = way.param.name;
    std::ranges::replace(name, '.', '_');
    return name;
});

TEST_P(EveryFormat, BringsColourBackAsItWasWritten) {
    const Image image = pattern({37, 23}, 3);
    const WriteReport report = write_image(file, image.view(), options());
    EXPECT_EQ(report.clamped + report.repaired, 0u);
    const Photo photo = read_photo(file);
    ASSERT_EQ(photo.type, GetParam().type);
    ASSERT_EQ(photo.channels, 3);
    ASSERT_EQ(photo.display, image.size());
    ASSERT_EQ(photo.window, (Window{0, 0, image.size()}));
    for (int y = 0; y < 23; ++y)
        for (int x = 0; x < 37; ++x)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(value_at(photo, x, y, c), image.pixel(x, y)[c], GetParam().tolerance)
                    << x << ' ' << y << ' ' << c;
}

TEST_P(EveryFormat, KeepsAlphaAsItsConventionWantsIt) {
    const Image image = pattern({16, 9}, 4);
    write_image(file, image.view(), options());
    const Photo photo = read_photo(file);
    ASSERT_EQ(photo.channels, GetParam().alpha ? 4 : 3);
    if (GetParam().alpha) {
        EXPECT_EQ(photo.associated_alpha, GetParam().associated);
    }
    for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 16; ++x) {
            const float* pixel = image.pixel(x, y);
            const double divisor = GetParam().associated ? 1 : pixel[3];
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(value_at(photo, x, y, c), pixel[c] / divisor, GetParam().tolerance);
            if (GetParam().alpha) {
                ASSERT_NEAR(value_at(photo, x, y, 3), pixel[3], GetParam().tolerance);
            }
        }
}

TEST_P(EveryFormat, TakesGrey) {
    const Image image = pattern({9, 8}, 1);
    write_image(file, image.view(), options());
    const Photo photo = read_photo(file);
    ASSERT_EQ(photo.channels, GetParam().format == FileFormat::hdr ? 3 : 1);
    for (int x = 0; x < 9; ++x)
        ASSERT_NEAR(value_at(photo, x, 3, 0), image.pixel(x, 3)[0], GetParam().tolerance);
}

TEST_P(EveryFormat, HoldsProvenance) {
    Provenance provenance{"0.1.0",
                          "plates/b\xc3\xa4ll.jpg",
                          Outline{10.25, 20.5, 3, 2, 45},
                          Camera{3103.2, {960, 540}},
                          "latlong",
                          std::array<double, 9>{1, 0, 0, 0, 0, 1, 0, -1, 0}};
    WriteOptions words = options();
    words.metadata.set(to_attribute(provenance));
    write_image(file, pattern({16, 8}, 3).view(), words);
    const auto back = provenance_from(read_header(file).metadata);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->version, provenance.version);
    EXPECT_EQ(back->source, provenance.source);
    EXPECT_EQ(back->outline, provenance.outline);
    ASSERT_TRUE(back->camera);
    EXPECT_EQ(back->camera->focal, provenance.camera->focal);
    EXPECT_EQ(back->camera->principal, provenance.camera->principal);
    EXPECT_EQ(back->layout, provenance.layout);
    EXPECT_EQ(back->rotation, provenance.rotation);
    EXPECT_EQ(read_photo(file).window.size, (Size{16, 8}));  // the words did not harm the pixels
}

TEST_P(EveryFormat, IsTheSameInMemory) {
    const Image image = pattern({16, 9}, 4);
    write_image(file, image.view(), options());
    const std::vector<std::byte> bytes = encode_image(image.view(), options());
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    EXPECT_TRUE(text == test::read_bytes(file));
}

TEST_P(EveryFormat, HoldsNoInfinityAndNoNan) {
    Image image({8, 8}, 3);
    image.pixel(1, 0)[0] = kNan;
    image.pixel(2, 0)[1] = kInfinity;
    image.pixel(3, 0)[2] = -kInfinity;
    const WriteReport report = write_image(file, image.view(), options());
    EXPECT_EQ(report.repaired, 3u);
    const Photo photo = read_photo(file);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(value_at(photo, x, y, c)));
    const double bright = value_at(photo, 2, 0, 1);
    EXPECT_GE(bright, is_integer(photo.type) ? 0.5 : 65504);
}

TEST_P(EveryFormat, WritesOneByOne) {
    Image image({1, 1}, 3);
    image.pixel(0, 0)[1] = 0.5f;
    write_image(file, image.view(), options());
    EXPECT_NEAR(value_at(read_photo(file), 0, 0, 1), 0.5, 0.01);
}

TEST_P(EveryFormat, PassesOnWhoTookThePictureWhereItCan) {
    if (GetParam().format == FileFormat::hdr) return;  // it has no place for it
    WriteOptions words = options();
    words.metadata.set("cameraModel", "Alpha 7");
    words.metadata.set({"expTime", "float", {0.02}, {}});
    words.metadata.set({"nominalFocalLength", "float", {50}, {}});
    write_image(file, pattern({16, 8}, 3).view(), words);
    const Photo photo = read_photo(file);  // the facts did not harm the pixels
    EXPECT_EQ(photo.display, (Size{16, 8}));
    EXPECT_EQ(pass_through(photo.metadata).text("cameraModel"), "Alpha 7");
}

/// Writes the same picture in every way; the bytes of each.
std::vector<std::string> bytes_of_every_way(const TempFolder& folder) {
    std::vector<std::string> files;
    for (const Way& way : kWays) {
        WriteOptions options;
        options.format = way.format;
        options.full_float = way.full_float;
        options.bits = way.bits;
        options.metadata.set(to_attribute(Provenance{.version = "0.1.0", .source = "a.jpg"}));
        options.metadata.set("capDate", "2020:01:02 03:04:05");
        options.color.space = "srgb_texture";
        write_image(folder / way.name, pattern({20, 10}, 4).view(), options);
        files.push_back(test::read_bytes(folder / way.name));
    }
    return files;
}

TEST(TheSameWords, GiveTheSameBytesInAnotherSecondAndFolder) {
    const TempFolder folder;
    const TempFolder other;
    const auto first = bytes_of_every_way(folder);
    ::usleep(1'050'000);
    const auto second = bytes_of_every_way(other);
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_TRUE(first[i] == second[i]) << kWays[i].name;
}

TEST(InMemory, NothingIsEncodedOfNoPixels) {
    EXPECT_NE(message_of([] { encode_image(Image().view(), {}); }).find("no pixels"),
              std::string::npos);
}

TEST(Half, ClampsWhatIsBrighterThanItHoldsAndCounts) {
    const TempFolder folder;
    Image image({3, 1}, 3);
    image.pixel(0, 0)[0] = 70000;
    image.pixel(1, 0)[0] = -70000;
    image.pixel(2, 0)[0] = 65504;
    const WriteReport report = write_image(folder / "x.exr", image.view(), {});
    EXPECT_EQ(report.clamped, 1u);
    const Photo photo = read_photo(folder / "x.exr");
    EXPECT_EQ(value_at(photo, 0, 0, 0), 65504);
    EXPECT_EQ(value_at(photo, 1, 0, 0), -65504);
    EXPECT_EQ(value_at(photo, 2, 0, 0), 65504);
}

TEST(Unassociated, ColourOfAThinPixelStaysFinite) {
    const TempFolder folder;
    Image image({2, 1}, 4);
    image.pixel(0, 0)[0] = 1e30f;
    image.pixel(0, 0)[3] = 1e-30f;
    image.pixel(1, 0)[0] = 0.25f;  // light without coverage: nothing to divide by
    WriteOptions options;
    options.format = FileFormat::tif;
    options.full_float = true;
    write_image(folder / "x.tif", image.view(), options);
    const Photo photo = read_photo(folder / "x.tif");
    EXPECT_TRUE(std::isfinite(value_at(photo, 0, 0, 0)));
    EXPECT_EQ(value_at(photo, 1, 0, 0), 0.25);
}

Imf::Header exr_header(const std::string& file) { return Imf::InputFile(file.c_str()).header(); }

TEST(ExrOutput, IsZipHalfScanlinesInTheWindowsGiven) {
    const TempFolder folder;
    WriteOptions options;
    options.display = {100, 50};
    write_image(folder / "x.exr", pattern({16, 9}, 4).view(), options);
    const Imf::Header header = exr_header(folder / "x.exr");
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_EQ(header.displayWindow(), Imath::Box2i({0, 0}, {99, 49}));
    EXPECT_EQ(header.dataWindow(), Imath::Box2i({0, 0}, {15, 8}));
    EXPECT_EQ(header.channels()["R"].type, Imf::HALF);
    EXPECT_TRUE(header.channels().findChannel("A"));
    EXPECT_FALSE(Imf::hasCapDate(header));
}

TEST(ExrOutput, SaysWhatMapItIs) {
    const TempFolder folder;
    WriteOptions options;
    options.envmap = EnvmapKind::latlong;
    write_image(folder / "l.exr", pattern({8, 4}, 3).view(), options);
    options.envmap = EnvmapKind::cube;
    write_image(folder / "c.exr", pattern({4, 24}, 3).view(), options);
    write_image(folder / "n.exr", pattern({4, 24}, 3).view(), {});
    EXPECT_EQ(Imf::envmap(exr_header(folder / "l.exr")), Imf::ENVMAP_LATLONG);
    EXPECT_EQ(Imf::envmap(exr_header(folder / "c.exr")), Imf::ENVMAP_CUBE);
    EXPECT_FALSE(Imf::hasEnvmap(exr_header(folder / "n.exr")));
    const Metadata metadata = read_header(folder / "c.exr").metadata;
    ASSERT_TRUE(metadata.find("envmap"));
    EXPECT_EQ(metadata.find("envmap")->text, "cube");
}

TEST(ExrOutput, NamesItsColours) {
    const TempFolder folder;
    WriteOptions options;
    options.color.space = "lin_ap1_scene";
    options.color.chromaticities = {0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767};
    write_image(folder / "x.exr", pattern({4, 4}, 3).view(), options);
    EXPECT_NEAR(Imf::chromaticities(exr_header(folder / "x.exr")).green.y, 0.83, 1e-6);
    const ColorTag tag = read_header(folder / "x.exr").color;
    EXPECT_EQ(tag.space, "lin_ap1_scene");
    ASSERT_TRUE(tag.chromaticities);
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR((*tag.chromaticities)[i], (*options.color.chromaticities)[i], 1e-6);
}

TEST(HdrOutput, NamesItsPrimaries) {
    const TempFolder folder;
    WriteOptions options;
    options.format = FileFormat::hdr;
    options.color.chromaticities = {0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767};
    write_image(folder / "x.hdr", pattern({8, 4}, 3).view(), options);
    EXPECT_EQ(read_header(folder / "x.hdr").color.chromaticities, options.color.chromaticities);
}

TEST(EncodedOutput, SaysThatItIsSrgbOnlyWhereItIs) {
    const TempFolder folder;
    for (const auto& [name, format] :
         {std::pair{"x.png", FileFormat::png}, {"x.jpg", FileFormat::jpg}}) {
        WriteOptions options;
        options.format = format;
        options.color.space = "srgb_texture";
        write_image(folder / name, pattern({8, 4}, 3).view(), options);
        EXPECT_EQ(read_header(folder / name).color.space, "sRGB") << name;
        options.color.space = "acescct";
        write_image(folder / name, pattern({8, 4}, 3).view(), options);
        EXPECT_EQ(read_header(folder / name).color.space, "") << name;
    }
}

TEST(Confidence, IsAChannelOfItsOwnInExrAndTiffOnly) {
    const TempFolder folder;
    Image image = pattern({6, 4}, 5);
    image.pixel(2, 2)[4] = 0.75f;
    WriteOptions options;
    options.confidence = true;
    write_image(folder / "x.exr", image.view(), options);
    EXPECT_TRUE(exr_header(folder / "x.exr").channels().findChannel("confidence"));
    EXPECT_EQ(read_photo(folder / "x.exr").channels, 4);  // it is no colour

    options.format = FileFormat::tif;
    options.full_float = true;
    write_image(folder / "x.tif", image.view(), options);
    OIIO::ImageSpec as_stored;  // else OpenImageIO multiplies everything by alpha, confidence too
    as_stored.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(folder / "x.tif", &as_stored);
    ASSERT_TRUE(input);
    ASSERT_EQ(input->spec().nchannels, 5);
    std::vector<float> values(6 * 4 * 5);
    ASSERT_TRUE(input->read_image(0, 0, 0, 5, OIIO::TypeDesc::FLOAT, values.data()));
    EXPECT_EQ(values[(2 * 6 + 2) * 5 + 4], 0.75f);  // not divided by alpha
    EXPECT_EQ(read_photo(folder / "x.tif").channels, 4);

    options.format = FileFormat::png;
    write_image(folder / "x.png", image.view(), options);
    EXPECT_EQ(read_photo(folder / "x.png").channels, 4);
}

TEST(Confidence, IsNoAlphaWhereThereIsNone) {
    const TempFolder folder;
    WriteOptions options;
    options.confidence = true;
    options.format = FileFormat::tif;
    write_image(folder / "x.tif", pattern({6, 4}, 4).view(), options);
    EXPECT_EQ(read_photo(folder / "x.tif").channels, 3);
}

TEST(Confidence, IsFoundAgainInATiffOfOurOwn) {
    const TempFolder folder;
    for (const int channels : {2, 4, 5})
        for (const bool full_float : {false, true})
            for (const bool provenance : {false, true}) {
                Image image = pattern({6, 4}, channels);
                for (int i = 0; i < 24; ++i)  // alpha 0 must not take it along
                    image.pixel(i % 6, i / 6)[channels - 1] = static_cast<float>(i) / 24;
                WriteOptions options;
                options.format = FileFormat::tif;
                options.full_float = full_float;
                options.confidence = true;
                if (provenance) options.metadata.set(to_attribute({.source = "a.exr"}));
                write_image(folder / "x.tif", image.view(), options);
                const auto photo = read_channel(folder / "x.tif", "confidence");
                ASSERT_TRUE(photo) << channels;
                EXPECT_EQ(photo->channels, 1);
                EXPECT_EQ(photo->window.size, image.size());
                for (int y = 0; y < 4; ++y)
                    for (int x = 0; x < 6; ++x)
                        EXPECT_NEAR(value_at(*photo, x, y, 0), image.pixel(x, y)[channels - 1],
                                    full_float ? 0 : 0.51 / 65535);
                EXPECT_FALSE(read_channel(folder / "x.tif", "depth"));
                const auto own = provenance_from(read_header(folder / "x.tif").metadata);
                ASSERT_TRUE(own);
                EXPECT_EQ(own->source, provenance ? "a.exr" : "");
            }
}

TEST(Confidence, IsNotTakenForWhatAnotherProgramAdded) {
    const TempFolder folder;
    WriteOptions options;
    options.format = FileFormat::tif;
    options.metadata.set(to_attribute({.source = "a.exr"}));
    write_image(folder / "rgba.tif", pattern({6, 4}, 4).view(), options);
    EXPECT_FALSE(read_channel(folder / "rgba.tif", "confidence"));
    const auto description = [&](const char* name) {
        return std::string(
            OIIO::ImageInput::open(folder / name)->spec().get_string_attribute("ImageDescription"));
    };
    const auto copy = [&](const char* name, int channels, const std::string& text) {
        OIIO::ImageSpec spec(6, 4, channels, OIIO::TypeDesc::FLOAT);
        spec.attribute("ImageDescription", text);
        const std::vector<float> values(static_cast<std::size_t>(24 * channels), 0.5F);
        const auto out = OIIO::ImageOutput::create("tiff");
        ASSERT_TRUE(out->open(folder / name, spec) &&
                    out->write_image(OIIO::TypeDesc::FLOAT, values.data()) && out->close());
    };
    // A mask in a file that had no confidence.
    copy("mask.tif", 5, description("rgba.tif"));
    EXPECT_FALSE(read_channel(folder / "mask.tif", "confidence"));
    // One more, or one less, in a file that had it.
    options.confidence = true;
    write_image(folder / "five.tif", pattern({6, 4}, 5).view(), options);
    for (const int channels : {4, 6}) {
        copy("other.tif", channels, description("five.tif"));
        EXPECT_FALSE(read_channel(folder / "other.tif", "confidence")) << channels;
    }
    copy("same.tif", 5, description("five.tif"));
    EXPECT_TRUE(read_channel(folder / "same.tif", "confidence"));
}

TEST(Formats, AreKnownByExtensionsInAnyCase) {
    EXPECT_EQ(format_from_extension("exr"), FileFormat::exr);
    EXPECT_EQ(format_from_extension(".TIFF"), FileFormat::tif);
    EXPECT_EQ(format_from_extension("Jpeg"), FileFormat::jpg);
    EXPECT_EQ(format_from_extension("hdr"), FileFormat::hdr);
    EXPECT_EQ(format_from_extension(".png"), FileFormat::png);
    EXPECT_FALSE(format_from_extension("bmp"));
    EXPECT_FALSE(format_from_extension(""));
    EXPECT_FALSE(format_from_extension("."));
    for (const auto format :
         {FileFormat::exr, FileFormat::hdr, FileFormat::tif, FileFormat::png, FileFormat::jpg})
        EXPECT_EQ(format_from_extension(extension_of(format)), format);
}

}  // namespace
}  // namespace chromeball
