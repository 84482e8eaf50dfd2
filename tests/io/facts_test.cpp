#include "io/facts.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

Metadata numbers(std::initializer_list<std::pair<const char*, double>> list) {
    Metadata metadata;
    for (const auto& [name, value] : list) metadata.set(name, value);
    return metadata;
}

double focal_px(const Metadata& metadata, Size display) {
    const auto facts = camera_from_metadata(metadata, display);
    return facts && facts->camera.focal ? *facts->camera.focal : -1;
}

TEST(FocalLength, ComesFromThe35MmEquivalentByTheDiagonal) {
    // On a 3:2 picture the diagonal and the width say the same: 50 mm on 36 mm.
    EXPECT_NEAR(focal_px(numbers({{"Exif:FocalLengthIn35mmFilm", 50}}), {6000, 4000}),
                6000 * 50.0 / 36, 1e-9);
    // On 4:3 they do not.
    EXPECT_NEAR(focal_px(numbers({{"Exif:FocalLengthIn35mmFilm", 26}}), {4000, 3000}),
                26 * 5000 / 43.266615, 1e-3);
}

TEST(FocalLength, OfAPictureThatLostRowsGoesByTheWidth) {
    // 16:9 out of a 3:2 sensor: 50 mm on 36 mm, whatever the height.
    EXPECT_NEAR(focal_px(numbers({{"Exif:FocalLengthIn35mmFilm", 50}}), {1920, 1080}),
                50.0 / 36 * 1920, 1e-9);
}

TEST(FocalLength, ThePrincipalPointIsTheMiddleAndTheSourceIsNamed) {
    const auto facts =
        camera_from_metadata(numbers({{"Exif:FocalLengthIn35mmFilm", 50}}), {6000, 4001});
    ASSERT_TRUE(facts);
    EXPECT_EQ(facts->camera.principal, V2d(3000, 2000.5));
    EXPECT_EQ(facts->source, "exif: 35 mm equivalent");
}

TEST(FocalLength, ComesFromTheFocalPlaneInItsUnit) {
    // 25 photosites a 0.1 mm: 4 micrometres each, so 50 mm are 12500 pixels.
    for (const auto& [unit, resolution] :
         {std::pair{2, 250 * 25.4}, {3, 2500.0}, {4, 250.0}, {5, 0.25}})
        EXPECT_NEAR(focal_px(numbers({{"Exif:FocalLength", 50},
                                      {"Exif:FocalPlaneXResolution", resolution},
                                      {"Exif:FocalPlaneResolutionUnit", unit}}),
                             {6000, 4000}),
                    12500, 1e-6);
}

TEST(FocalLength, OfAResizedPictureShrinksWithIt) {
    const auto metadata = numbers({{"Exif:FocalLength", 50},
                                   {"Exif:FocalPlaneXResolution", 2500},
                                   {"Exif:FocalPlaneResolutionUnit", 3},
                                   {"Exif:PixelXDimension", 6000},
                                   {"Exif:PixelYDimension", 4000}});
    EXPECT_NEAR(focal_px(metadata, {1500, 1000}), 3125, 1e-6);
    EXPECT_NEAR(focal_px(metadata, {1000, 1500}), 3125, 1e-6);  // turned upright
}

TEST(FocalLength, OfACroppedPictureIsUnknown) {
    const auto metadata = numbers({{"Exif:FocalLengthIn35mmFilm", 60},
                                   {"Exif:PixelXDimension", 6000},
                                   {"Exif:PixelYDimension", 4000}});
    EXPECT_FALSE(camera_from_metadata(metadata, {1200, 1200}));
    EXPECT_TRUE(camera_from_metadata(metadata, {6000, 4000}));
    EXPECT_TRUE(camera_from_metadata(metadata, {4000, 6000}));
}

TEST(FocalLength, OfASquareIsUnknownAsNoCameraMakesThem) {
    // Editors write the new size where the camera's was.
    const auto metadata = numbers({{"Exif:FocalLengthIn35mmFilm", 104},
                                   {"Exif:PixelXDimension", 2960},
                                   {"Exif:PixelYDimension", 2960}});
    EXPECT_FALSE(camera_from_metadata(metadata, {2960, 2960}));
    EXPECT_FALSE(camera_from_metadata(numbers({{"Exif:FocalLengthIn35mmFilm", 26}}), {9000, 2000}));
    // EXR says its sensor's width outright: that holds for any shape.
    EXPECT_TRUE(
        camera_from_metadata(numbers({{"focal_length", 35}, {"sensor_width", 28}}), {1000, 1000}));
}

TEST(FocalLength, NonsenseIsNoFact) {
    EXPECT_FALSE(camera_from_metadata({}, {10, 10}));
    for (const double bad : {0.0, -50.0, std::nan(""), HUGE_VAL})
        EXPECT_FALSE(
            camera_from_metadata(numbers({{"Exif:FocalLengthIn35mmFilm", bad}}), {30, 20}));
    // A sensor a metre wide, from a resolution in the wrong unit.
    EXPECT_FALSE(camera_from_metadata(numbers({{"Exif:FocalLength", 50},
                                               {"Exif:FocalPlaneXResolution", 1},
                                               {"Exif:FocalPlaneResolutionUnit", 3}}),
                                      {6000, 4000}));
    EXPECT_FALSE(camera_from_metadata(numbers({{"Exif:FocalLength", 50}}), {6000, 4000}));
    EXPECT_FALSE(camera_from_metadata(numbers({{"Exif:FocalLengthIn35mmFilm", 50}}), {0, 0}));
}

TEST(FocalLength, ComesFromExrWithTheSensorsWidth) {
    Metadata metadata = numbers({{"nominalFocalLength", 35}});
    metadata.set({"sensorOverallDimensions", "v2f", {28, 18}, {}});
    EXPECT_NEAR(focal_px(metadata, {2800, 1800}), 3500, 1e-9);
    metadata.set("pinholeFocalLength", 36.0);  // what the projection really uses
    EXPECT_NEAR(focal_px(metadata, {2800, 1800}), 3600, 1e-9);
    EXPECT_EQ(camera_from_metadata(metadata, {2800, 1800})->source,
              "exr: focal length and sensor width");
    EXPECT_NEAR(focal_px(numbers({{"focal_length", 35}, {"sensor_width", 28}}), {1400, 900}), 1750,
                1e-9);
}

TEST(FocalLength, ComesFromExrWithThePhotosites) {
    Metadata metadata = numbers({{"nominalFocalLength", 40}, {"sensorPhotositePitch", 5}});
    metadata.set({"sensorAcquisitionRectangle", "box2i", {100, 0, 4099, 2999}, {}});
    EXPECT_NEAR(focal_px(metadata, {2000, 1500}), 4000, 1e-9);  // 20 mm over 2000 pixels
}

TEST(FocalLength, OurOwnNoteComesFirst) {
    Metadata metadata = numbers({{"Exif:FocalLengthIn35mmFilm", 50}});
    Provenance provenance;
    provenance.camera = Camera{1234.5, {10, 20}};
    metadata.set(to_attribute(provenance));
    const auto facts = camera_from_metadata(metadata, {6000, 4000});
    ASSERT_TRUE(facts);
    EXPECT_EQ(facts->camera.focal, 1234.5);
    EXPECT_EQ(facts->camera.principal, V2d(10, 20));
    EXPECT_EQ(facts->source, "chromeball");
    provenance.layout = "crop";  // the camera is then that of the whole photo
    metadata.set(to_attribute(provenance));
    EXPECT_FALSE(camera_from_metadata(metadata, {6000, 4000}));
}

TEST(ProvenanceText, HoldsNoAbsolutePath) {
    const Provenance provenance{.version = "1", .source = "/home/anna/shots/ball.jpg"};
    const Attribute attribute = to_attribute(provenance);
    EXPECT_EQ(attribute.name, "chromeball");
    EXPECT_EQ(attribute.type, "string");
    EXPECT_EQ(attribute.text.find("anna"), std::string::npos);
    Metadata metadata;
    metadata.set(attribute);
    EXPECT_EQ(provenance_from(metadata)->source, "ball.jpg");
}

TEST(ProvenanceText, IsPlainAsciiWhateverTheFileIsCalled) {
    for (const std::string name : {"b\xc3\xa4ll.jpg", "b\xe4ll.jpg", "a\"b\n.jpg"}) {
        const Attribute attribute = to_attribute({.version = "1", .source = name});
        for (const char c : attribute.text) EXPECT_TRUE(c >= ' ' && c < 127);
        Metadata metadata;
        metadata.set(attribute);
        EXPECT_TRUE(provenance_from(metadata)) << name;
    }
}

TEST(ProvenanceText, DamagedIsAsGoodAsNone) {
    const char* damaged[] = {"",
                             "{",
                             "[]",
                             "7",
                             R"({"version":7})",
                             R"({"outline":{"cx":1}})",
                             R"({"outline":"x"})",
                             R"({"camera":{"focal_px":-3,"principal":[1,2]}})",
                             R"({"camera":{"principal":[1]}})",
                             R"({"rotation":[1,2]})"};
    for (const char* text : damaged) {
        Metadata metadata;
        metadata.set("chromeball", text);
        EXPECT_FALSE(provenance_from(metadata)) << text;
    }
    Metadata described;
    described.set("ImageDescription", "chromeball {");
    EXPECT_FALSE(provenance_from(described));
    described.set("ImageDescription", "a chromeball in the garden");
    EXPECT_FALSE(provenance_from(described));
}

TEST(PassThrough, GivesExifFactsTheirStandardNames) {
    Metadata metadata = numbers({{"ExposureTime", 0.005},
                                 {"FNumber", 9},
                                 {"Exif:PhotographicSensitivity", 6400},
                                 {"Exif:FocalLength", 40},
                                 {"Exif:Contrast", 0},
                                 {"GPS:Latitude", 48}});
    metadata.set("Make", "SONY");
    metadata.set("Model", "ILCE-6400");
    metadata.set("Exif:LensModel", "E 18-135mm");
    metadata.set("Exif:DateTimeOriginal", "2023:11:09 22:01:57");
    metadata.set("DateTime", "2024:01:01 00:00:00");
    metadata.set({"smpte:TimeCode", "timecode", {123, 456}, {}});
    const Metadata passed = pass_through(metadata);
    EXPECT_EQ(*passed.find("expTime"), (Attribute{"expTime", "float", {0.005}, {}}));
    EXPECT_EQ(passed.number("aperture"), 9);
    EXPECT_EQ(passed.number("isoSpeed"), 6400);
    EXPECT_EQ(passed.number("nominalFocalLength"), 40);
    EXPECT_EQ(passed.text("cameraMake"), "SONY");
    EXPECT_EQ(passed.text("cameraModel"), "ILCE-6400");
    EXPECT_EQ(passed.text("lensModel"), "E 18-135mm");
    EXPECT_EQ(passed.text("capDate"), "2023:11:09 22:01:57");
    EXPECT_EQ(*passed.find("timeCode"), (Attribute{"timeCode", "timecode", {123, 456}, {}}));
    EXPECT_EQ(passed.all().size(), 9u);
    EXPECT_EQ(pass_through(passed).all(), passed.all());  // and stays as it is the second time
}

TEST(PassThrough, FrameRatesBecomeTheFractionsThatAreMeant) {
    const std::pair<double, std::vector<double>> cases[] = {
        {24, {24, 1}}, {23.976, {24000, 1001}}, {29.97, {30000, 1001}}, {12.5, {25, 2}}};
    for (const auto& [rate, fraction] : cases)
        EXPECT_EQ(pass_through(numbers({{"dpx:FrameRate", rate}})).find("framesPerSecond")->numbers,
                  fraction)
            << rate;
}

}  // namespace
}  // namespace chromeball
