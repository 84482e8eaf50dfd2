#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <cstring>

#include "io/facts.h"
#include "io/files.h"
#include "io/read.h"
#include "io/write.h"

namespace chromeball {
namespace {

using test::message_of;
using test::TempFolder;
using test::value_at;

/// A value that tells its channel and place: exact in half.
float mark(int channel, int x, int y) { return static_cast<float>(channel * 512 + y * 16 + x); }

/// One plane a channel, for a data window of at most 16 columns.
struct Planes {
    Imath::Box2i window;
    std::vector<std::vector<float>> values;

    Planes(const Imath::Box2i& box, int channels) : window(box) {
        for (int c = 0; c < channels; ++c) {
            values.emplace_back();
            for (int y = box.min.y; y <= box.max.y; ++y)
                for (int x = box.min.x; x <= box.max.x; ++x)
                    values.back().push_back(mark(c, x - box.min.x, y - box.min.y));
        }
    }
    Imf::Slice slice(int channel) {
        return Imf::Slice::Make(Imf::FLOAT, values[static_cast<std::size_t>(channel)].data(),
                                window);
    }
};

struct Recipe {
    std::vector<std::string> channels = {"R", "G", "B"};
    Imath::Box2i data{{0, 0}, {11, 8}};
    Imath::Box2i display{{0, 0}, {11, 8}};
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
    Imf::LineOrder order = Imf::INCREASING_Y;
    bool tiled = false;
    Imf::LevelMode levels = Imf::ONE_LEVEL;
    Imf::LevelRoundingMode rounding = Imf::ROUND_DOWN;
};

Imf::Header header_of(const Recipe& recipe) {
    Imf::Header header(recipe.display, recipe.data, 1, {0, 0}, 1, recipe.order, recipe.compression);
    for (const auto& name : recipe.channels)
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
}

void write(const std::string& file, const Recipe& recipe) {
    Planes planes(recipe.data, static_cast<int>(recipe.channels.size()));
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < recipe.channels.size(); ++c)
        buffer.insert(recipe.channels[c], planes.slice(static_cast<int>(c)));
    Imf::Header header = header_of(recipe);
    const int height = recipe.data.max.y - recipe.data.min.y + 1;
    if (recipe.tiled) {
        header.setTileDescription({5, 4, recipe.levels, recipe.rounding});
        Imf::TiledOutputFile out(file.c_str(), header);
        out.setFrameBuffer(buffer);  // the smaller levels hold a part of the largest
        for (int ly = 0; ly < out.numYLevels(); ++ly)
            for (int lx = 0; lx < out.numXLevels(); ++lx)
                if (out.isValidLevel(lx, ly))
                    out.writeTiles(0, out.numXTiles(lx) - 1, 0, out.numYTiles(ly) - 1, lx, ly);
    } else {
        Imf::OutputFile out(file.c_str(), header);
        out.setFrameBuffer(buffer);
        out.writePixels(height);
    }
}

class Exr : public testing::Test {
protected:
    TempFolder folder;
    std::string file = folder / "x.exr";
};

TEST_F(Exr, DataWindowsLieWhereTheDisplayWindowSaysAtAnyOffset) {
    const Imath::Box2i displays[] = {
        {{0, 0}, {11, 8}}, {{-5, -7}, {30, 20}}, {{100, 50}, {119, 69}}, {{2, 2}, {5, 5}}};
    const Imath::Box2i datas[] = {{{0, 0}, {11, 8}}, {{-3, -2}, {4, 3}}, {{99, 60}, {110, 80}}};
    for (const auto& display : displays)
        for (const auto& data : datas) {
            write(file, {.data = data, .display = display});
            const Photo photo = read_photo(file);
            ASSERT_EQ(photo.display,
                      (Size{display.max.x - display.min.x + 1, display.max.y - display.min.y + 1}));
            ASSERT_EQ(photo.window.x, data.min.x - display.min.x);
            ASSERT_EQ(photo.window.y, data.min.y - display.min.y);
            ASSERT_EQ(photo.window.size,
                      (Size{data.max.x - data.min.x + 1, data.max.y - data.min.y + 1}));
            for (int c = 0; c < 3; ++c) ASSERT_EQ(value_at(photo, 3, 2, c), mark(c, 3, 2));
        }
}

TEST_F(Exr, RowsOfTheDisplayWindowComeAloneFromScanlinesAndTiles) {
    for (const bool tiled : {false, true})
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
            for (const auto compression :
                 {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
                write(file, {.data = {{-1, -3}, {10, 12}},
                             .display = {{0, 0}, {7, 9}},
                             .compression = compression,
                             .order = order,
                             .tiled = tiled});
                for (int first = -5; first < 14; first += 3) {
                    const Photo photo = read_photo(file, {.rows = std::pair{first, first + 4}});
                    // The data window holds the display window's rows -3 to 12.
                    const int top = std::clamp(first, -3, 13);
                    ASSERT_EQ(photo.window.y, top);
                    ASSERT_EQ(photo.window.size.height, std::clamp(first + 4, -3, 13) - top);
                    ASSERT_EQ(photo.pixels.size(), photo.window.size.pixels() * 12);
                    for (int y = 0; y < photo.window.size.height; ++y)
                        for (int x = 0; x < 12; ++x)
                            ASSERT_EQ(value_at(photo, x, y, 1), mark(1, x, top + y + 3));
                }
            }
}

TEST_F(Exr, BandsOfScanlinesAndTilesAreTheWhole) {
    for (const bool tiled : {false, true})
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
            write(file, {.data = {{-1, -3}, {10, 196}},
                         .display = {{0, 0}, {7, 190}},
                         .compression = Imf::PIZ_COMPRESSION,
                         .order = order,
                         .tiled = tiled});
            const std::pair rows{5, 180};
            int next = rows.first, bands = 0;
            read_photo(file, {.rows = rows, .bands = [&](const Photo& band) {
                                  ASSERT_EQ(band.window.y, next);
                                  for (int y = 0; y < band.window.size.height; ++y, ++next)
                                      for (int x = 0; x < 12; ++x)
                                          ASSERT_EQ(value_at(band, x, y, 2), mark(2, x, next + 3));
                                  ++bands;
                              }});
            EXPECT_EQ(next, rows.second);
            EXPECT_GT(bands, 2);
        }
}

TEST_F(Exr, RowsOutsideGiveNone) {
    write(file, {});
    const Photo photo = read_photo(file, {.rows = std::pair{100, 120}});
    EXPECT_EQ(photo.window.size.height, 0);
    EXPECT_TRUE(photo.pixels.empty());
    EXPECT_EQ(photo.display.height, 9);
    EXPECT_EQ(read_photo(file, {.rows = std::pair{5, 3}}).window.size.height, 0);
}

TEST_F(Exr, RowsAreReadWithoutDecodingTheOthers) {
    // A file whose later rows are damaged still gives its first ones.
    write(file, {.data = {{0, 0}, {11, 63}}, .display = {{0, 0}, {11, 63}}});
    std::string bytes = test::read_bytes(file);
    bytes.replace(bytes.size() - 40, 40, 40, '\xff');
    test::write_bytes(file, bytes);
    EXPECT_EQ(value_at(read_photo(file, {.rows = std::pair{2, 4}}), 5, 0, 0), mark(0, 5, 2));
    EXPECT_NE(message_of([&] { read_photo(file); }), "no error");
}

/// Whether the file is read as it is, and called truncated without its last bytes, although the
/// rows that are wanted are there.
void expect_its_end_is_missed(const std::string& file, const std::string& what) {
    const ReadOptions first_rows{.rows = std::pair{0, 2}};
    EXPECT_EQ(message_of([&] { read_photo(file, first_rows); }), "no error") << what;
    EXPECT_EQ(message_of([&] { read_photo(file); }), "no error") << what;
    const std::string bytes = test::read_bytes(file);
    for (const std::size_t missing : {1, 7, 60}) {
        test::write_bytes(file, bytes.substr(0, bytes.size() - missing));
        for (const bool header_only : {false, true})
            EXPECT_NE(message_of([&] {
                          header_only ? read_header(file, first_rows)
                                      : read_photo(file, first_rows);
                      }).find(file + ": truncated: "),
                      std::string::npos)
                << what << ", less " << missing;
    }
}

TEST_F(Exr, IsCalledTruncatedAlsoWhereTheWantedRowsAreThere) {
    for (int kind = 0; kind < Imf::NUM_COMPRESSION_METHODS; ++kind)
        for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
            write(file, {.data = {{0, 0}, {11, 599}},
                         .display = {{0, 0}, {11, 599}},
                         .compression = static_cast<Imf::Compression>(kind),
                         .order = order});
            expect_its_end_is_missed(file, "compression " + std::to_string(kind));
        }
    for (const auto levels : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS})
        for (const auto rounding : {Imf::ROUND_DOWN, Imf::ROUND_UP})
            for (const Imath::Box2i& box :
                 {Imath::Box2i{{0, 0}, {11, 99}}, {{-4, -3}, {0, 70}}, {{0, 0}, {15, 4}}}) {
                write(file, {.data = box,
                             .display = {{0, -3}, {11, 99}},
                             .tiled = true,
                             .levels = levels,
                             .rounding = rounding});
                expect_its_end_is_missed(file, "levels " + std::to_string(levels));
            }
}

TEST_F(Exr, IsCalledTruncatedAlsoWithSeveralPartsOrALongHeader) {
    for (const bool long_header : {false, true}) {
        std::vector<Imf::Header> headers(3, header_of({}));
        for (int p = 0; p < 3; ++p) {
            auto& header = headers[static_cast<std::size_t>(p)];
            header.setName("part" + std::to_string(p));
            header.setType(Imf::SCANLINEIMAGE);
            // More than what is looked at to know what a file is.
            if (long_header)
                header.insert("notes", Imf::StringAttribute(std::string(100'000, 'n')));
        }
        {
            Imf::MultiPartOutputFile out(file.c_str(), headers.data(), 3);
            Planes planes({{0, 0}, {11, 8}}, 3);
            Imf::FrameBuffer buffer;
            for (int c = 0; c < 3; ++c) buffer.insert(std::string(1, "RGB"[c]), planes.slice(c));
            // The part that is read is the last one in the file.
            for (const int p : {2, 1, 0}) {
                Imf::OutputPart part(out, p);
                part.setFrameBuffer(buffer);
                part.writePixels(9);
            }
        }
        expect_its_end_is_missed(file, "parts");
    }
}

TEST_F(Exr, ACountOfChunksThatLiesIsNotBelieved) {
    for (const int lie : {-5, 0, 2'000'000'000}) {
        const Recipe recipe;
        Imf::Header header = header_of(recipe);
        header.setChunkCount(1);
        Planes planes(recipe.data, 3);
        {
            Imf::FrameBuffer buffer;
            for (int c = 0; c < 3; ++c)
                buffer.insert(recipe.channels[static_cast<std::size_t>(c)], planes.slice(c));
            Imf::OutputFile out(file.c_str(), header);
            out.setFrameBuffer(buffer);
            out.writePixels(9);
        }
        // Behind the attribute's name, type ("int") and length (4).
        std::string bytes = test::read_bytes(file);
        const std::size_t at = bytes.find("chunkCount");
        ASSERT_NE(at, std::string::npos);
        std::memcpy(bytes.data() + at + 11 + 4 + 4, &lie, 4);
        test::write_bytes(file, bytes);
        const Photo photo = read_photo(file);
        EXPECT_EQ(value_at(photo, 3, 2, 1), mark(1, 3, 2)) << lie;
    }
}

TEST_F(Exr, ChannelsAreFoundByNameInLayersToo) {
    struct Case {
        std::vector<std::string> names;
        std::vector<int> expected;  // index of each photo channel among the names
    };
    const Case cases[] = {
        {{"R", "G", "B"}, {0, 1, 2}},
        {{"R", "G", "B", "A", "Z", "confidence"}, {0, 1, 2, 3}},
        {{"rgba.R", "rgba.G", "rgba.B", "rgba.A"}, {0, 1, 2, 3}},
        {{"diffuse.R", "diffuse.G", "diffuse.B", "R", "G", "B"}, {3, 4, 5}},
        {{"a.R", "a.G", "a.B", "rgba.R", "rgba.G", "rgba.B"}, {3, 4, 5}},
        {{"A.Combined.A", "A.Combined.R", "A.Combined.G", "A.Combined.B", "A.AO.R", "A.AO.G",
          "A.AO.B"},
         {1, 2, 3, 0}},
        {{"N.X", "diffuse.red", "diffuse.green", "diffuse.blue"}, {1, 2, 3}},
        {{"Y"}, {0}},
        {{"A", "Y"}, {1, 0}},
        {{"depth"}, {0}},
    };
    for (const Case& c : cases) {
        write(file, {.channels = c.names});
        const Photo photo = read_photo(file);
        ASSERT_EQ(photo.channels, std::ssize(c.expected)) << c.names[0];
        for (int k = 0; k < photo.channels; ++k)
            EXPECT_EQ(value_at(photo, 2, 1, k), mark(c.expected[static_cast<std::size_t>(k)], 2, 1))
                << c.names[0];
        EXPECT_TRUE(photo.associated_alpha);
    }
}

TEST_F(Exr, WithoutColourIsRefusedNamingItsChannels) {
    write(file, {.channels = {"N.X", "N.Y_", "Z"}});
    const std::string message = message_of([&] { read_photo(file); });
    EXPECT_NE(message.find("holds no colour"), std::string::npos) << message;
    EXPECT_NE(message.find("N.X"), std::string::npos) << message;
}

TEST_F(Exr, HalfFloatAndIntegerChannelsKeepTheirValues) {
    for (const auto type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
        Imf::Header header(4, 1);
        header.channels().insert("Y", Imf::Channel(type));
        const std::uint32_t integers[4] = {0, 1, 1000, 2048};
        float floats[4];
        Imath::half halves[4];
        std::copy(integers, integers + 4, floats);
        std::copy(floats, floats + 4, halves);
        const void* data = type == Imf::HALF    ? static_cast<const void*>(halves)
                           : type == Imf::FLOAT ? static_cast<const void*>(floats)
                                                : integers;
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice::Make(type, data, header.dataWindow()));
        {
            Imf::OutputFile out(file.c_str(), header);
            out.setFrameBuffer(buffer);
            out.writePixels(1);
        }
        const Photo photo = read_photo(file);
        EXPECT_EQ(photo.type, type == Imf::HALF ? PixelType::f16 : PixelType::f32);
        for (int x = 0; x < 4; ++x) EXPECT_EQ(value_at(photo, x, 0, 0), integers[x]);
    }
}

TEST_F(Exr, LuminanceAndChromaBecomeColour) {
    for (const auto channels : {Imf::WRITE_YC, Imf::WRITE_YCA}) {
        const Imath::Box2i display({0, 0}, {31, 31});
        const Imath::Box2i data({-4, 2}, {27, 25});
        std::vector<Imf::Rgba> pixels(32 * 24, Imf::Rgba(0.75f, 0.5f, 0.25f, 1.0f));
        {
            Imf::RgbaOutputFile out(file.c_str(), display, data, channels);
            out.setFrameBuffer(pixels.data() + 4 - 2 * 32, 1, 32);
            out.writePixels(24);
        }
        for (const auto& rows : {std::optional<std::pair<int, int>>(), {{10, 14}}}) {
            const Photo photo = read_photo(file, {.rows = rows});
            ASSERT_EQ(photo.channels, channels == Imf::WRITE_YC ? 3 : 4);
            ASSERT_EQ(photo.type, PixelType::f16);
            ASSERT_EQ(photo.window.x, -4);
            ASSERT_EQ(photo.window.y, rows ? 10 : 2);
            ASSERT_EQ(photo.window.size.height, rows ? 4 : 24);
            for (int x = 0; x < 32; ++x) {
                EXPECT_NEAR(value_at(photo, x, 1, 0), 0.75, 0.01);
                EXPECT_NEAR(value_at(photo, x, 1, 1), 0.5, 0.01);
                EXPECT_NEAR(value_at(photo, x, 1, 2), 0.25, 0.01);
            }
        }
    }
}

TEST_F(Exr, TheFirstPartWithColourIsRead) {
    Recipe depth{.channels = {"Z", "ZBack"}};
    Recipe color;
    std::vector<Imf::Header> headers = {header_of(depth), header_of(color)};
    headers[0].setName("depth");
    headers[1].setName("beauty");
    for (auto& header : headers) header.setType(Imf::SCANLINEIMAGE);
    {
        Imf::MultiPartOutputFile out(file.c_str(), headers.data(), 2);
        for (int p = 0; p < 2; ++p) {
            const auto& names = p == 0 ? depth.channels : color.channels;
            Planes planes(color.data, 3);
            Imf::FrameBuffer buffer;
            for (int c = 0; c < std::ssize(names); ++c)
                buffer.insert(names[static_cast<std::size_t>(c)], planes.slice(c));
            Imf::OutputPart part(out, p);
            part.setFrameBuffer(buffer);
            part.writePixels(9);
        }
    }
    const Photo photo = read_photo(file);
    ASSERT_EQ(photo.channels, 3);
    EXPECT_EQ(value_at(photo, 4, 5, 2), mark(2, 4, 5));
}

TEST_F(Exr, DeepPixelsAreRefusedInWords) {
    Imf::Header header(2, 2);
    header.channels().insert("R", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    {
        Imf::DeepScanLineOutputFile out(file.c_str(), header);
        std::vector<unsigned> counts(4, 0);
        std::vector<float*> samples(4, nullptr);
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()),
                                                 sizeof(unsigned), 2 * sizeof(unsigned)));
        buffer.insert("R", Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(samples.data()),
                                          sizeof(float*), 2 * sizeof(float*), sizeof(float)));
        out.setFrameBuffer(buffer);
        out.writePixels(2);
    }
    EXPECT_EQ(message_of([&] { read_photo(file); }),
              file + ": holds deep pixels only; flatten it first");
}

TEST_F(Exr, ItsFactsComeUnderTheirNamesAndTravelThroughOurFiles) {
    {
        Imf::Header header(2, 2);
        header.channels().insert("Y", Imf::Channel(Imf::HALF));
        Imf::addTimeCode(header, Imf::TimeCode(11, 22, 33, 14, true));
        Imf::addKeyCode(header, Imf::KeyCode(12, 34, 123456, 1234, 45));
        Imf::addFramesPerSecond(header, Imf::Rational(24000, 1001));
        Imf::addExpTime(header, 0.02f);
        Imf::addCapDate(header, "2020:02:03 04:05:06");
        Imath::M44f camera;
        camera.translate(Imath::V3f(1, 2, 3));
        Imf::addWorldToCamera(header, camera);
        header.insert("cameraMake", Imf::StringAttribute("ARRI"));
        header.insert("sensorOverallDimensions", Imf::V2fAttribute({28.25f, 18.17f}));
        header.insert("studioSecret", Imf::StringAttribute("not worth passing on"));
        header.insert("Orientation", Imf::StringAttribute("void"));
        const Imath::half row[4] = {};
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice::Make(Imf::HALF, row, header.dataWindow()));
        Imf::OutputFile out(file.c_str(), header);
        out.setFrameBuffer(buffer);
        out.writePixels(2);
    }
    const Metadata metadata = read_header(file).metadata;
    EXPECT_EQ(metadata.text("studioSecret"), "not worth passing on");
    EXPECT_FALSE(metadata.find("Orientation"));
    EXPECT_FALSE(metadata.find("channels"));
    EXPECT_FALSE(metadata.find("compression"));
    WriteOptions options;
    options.metadata = pass_through(metadata);
    write_image(folder / "y.exr", test::pattern({4, 2}, 3).view(), options);

    const Imf::Header header = Imf::InputFile((folder / "y.exr").c_str()).header();
    EXPECT_EQ(Imf::timeCode(header).hours(), 11);
    EXPECT_EQ(Imf::timeCode(header).frame(), 14);
    EXPECT_TRUE(Imf::timeCode(header).dropFrame());
    EXPECT_EQ(Imf::keyCode(header).prefix(), 123456);
    EXPECT_EQ(Imf::keyCode(header).perfOffset(), 45);
    EXPECT_EQ(Imf::framesPerSecond(header).n, 24000);
    EXPECT_EQ(Imf::framesPerSecond(header).d, 1001u);
    EXPECT_EQ(Imf::expTime(header), 0.02f);
    EXPECT_EQ(Imf::capDate(header), "2020:02:03 04:05:06");
    EXPECT_EQ(Imf::worldToCamera(header)[3][1], 2);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("cameraMake").value(), "ARRI");
    EXPECT_EQ(header.typedAttribute<Imf::V2fAttribute>("sensorOverallDimensions").value().x,
              28.25f);
    EXPECT_EQ(header.find("studioSecret"), header.end());
}

TEST(ExrMetadata, OfEveryTypeSurvivesWritingAndReading) {
    const Attribute attributes[] = {
        {"s", "string", {}, "text"},
        {"i", "int", {-7}, {}},
        {"f", "float", {0.5}, {}},
        {"d", "double", {0.1}, {}},
        {"r", "rational", {24000, 1001}, {}},
        {"t", "timecode", {4294967295.0, 5}, {}},
        {"k", "keycode", {1, 2, 3, 4, 5, 4, 64}, {}},
        {"fv", "floatvector", {1, 2, 3, 4, 5}, {}},
        {"v2i", "v2i", {1, -2}, {}},
        {"v2f", "v2f", {1.5, -2}, {}},
        {"v2d", "v2d", {0.1, -2}, {}},
        {"v3i", "v3i", {1, 2, 3}, {}},
        {"v3f", "v3f", {1, 2, 3}, {}},
        {"v3d", "v3d", {0.1, 2, 3}, {}},
        {"m33f", "m33f", {1, 2, 3, 4, 5, 6, 7, 8, 9}, {}},
        {"m33d", "m33d", {0.1, 2, 3, 4, 5, 6, 7, 8, 9}, {}},
        {"m44f", "m44f", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}, {}},
        {"m44d", "m44d", {0.1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}, {}},
        {"box2i", "box2i", {-1, -2, 3, 4}, {}},
        {"box2f", "box2f", {-1.5, -2, 3, 4}, {}},
        {"a name that is longer than the thirty-one characters of old", "int", {1}, {}},
    };
    const TempFolder folder;
    WriteOptions options;
    for (const Attribute& a : attributes) options.metadata.set(a);
    write_image(folder / "x.exr", test::pattern({2, 2}, 3).view(), options);
    const Metadata back = read_header(folder / "x.exr").metadata;
    for (const Attribute& a : attributes) {
        ASSERT_TRUE(back.find(a.name)) << a.name;
        EXPECT_EQ(*back.find(a.name), a) << a.name;
    }
}

TEST(ExrMetadata, ThatCannotBeWrittenIsLeftOut) {
    const TempFolder folder;
    WriteOptions options;
    options.metadata.set({"short", "v3f", {1}, {}});
    options.metadata.set({"odd", "a type unheard of", {1}, {}});
    options.metadata.set({"", "int", {1}, {}});
    options.metadata.set({"channels", "string", {}, "R"});
    options.metadata.set({"dataWindow", "box2i", {0, 0, 99, 99}, {}});
    options.metadata.set({"compression", "string", {}, "zip"});
    options.metadata.set({"nan", "int", {std::nan("")}, {}});
    write_image(folder / "x.exr", test::pattern({2, 2}, 3).view(), options);
    const Photo photo = read_photo(folder / "x.exr");
    EXPECT_EQ(photo.window.size, (Size{2, 2}));
    EXPECT_FALSE(photo.metadata.find("short"));
    EXPECT_FALSE(photo.metadata.find("odd"));
}

TEST(ReadExr, NoticesAMissingEndWhateverRowsAreRead) {
    const TempFolder folder;
    for (const bool tiled : {false, true}) {
        Recipe recipe;
        recipe.data = recipe.display = {{0, 0}, {11, 99}};
        recipe.tiled = tiled;
        const std::string file = folder / "x.exr";
        write(file, recipe);
        const std::string whole = test::read_bytes(file);
        ReadOptions first_rows;
        first_rows.rows = std::pair(0, 4);
        EXPECT_EQ(message_of([&] { read_photo(file, first_rows); }), "no error");
        for (const std::size_t lost : {std::size_t{1}, whole.size() / 10, whole.size() / 3}) {
            test::write_bytes(file, whole.substr(0, whole.size() - lost));
            EXPECT_NE(message_of([&] { read_photo(file, first_rows); }).find("truncated"),
                      std::string::npos)
                << tiled << " " << lost;
        }
    }
}

}  // namespace
}  // namespace chromeball
