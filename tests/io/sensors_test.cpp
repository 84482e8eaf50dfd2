#include "io/sensors.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "files.h"
#include "io/facts.h"

namespace chromeball {
namespace {

Metadata exif(const std::string& make, const std::string& model, double focal_mm) {
    Metadata metadata;
    metadata.set("Make", make);
    metadata.set("Model", model);
    metadata.set("Exif:FocalLength", focal_mm);
    return metadata;
}

TEST(Sensors, TheBuiltInTableIsWellFormed) {
    const auto sensors = parse_sensors(built_in_sensors(), "sensors.csv");
    EXPECT_GT(sensors.size(), 50U);
    for (const Sensor& s : sensors) {
        EXPECT_GT(s.width_mm, s.height_mm) << s.model;  // sensors lie on their long side
        EXPECT_LT(s.width_mm / s.height_mm, 1.6) << s.model;
    }
}

TEST(Sensors, TheLongestModelNameWins) {
    const auto sensors = sensors_with(std::nullopt);
    EXPECT_EQ(find_sensor(sensors, "NIKON CORPORATION", "NIKON D5")->width_mm, 35.9);
    EXPECT_EQ(find_sensor(sensors, "NIKON CORPORATION", "NIKON D5300")->width_mm, 23.5);
    EXPECT_EQ(find_sensor(sensors, "NIKON CORPORATION", "NIKON Z 50")->width_mm, 23.5);
    EXPECT_EQ(find_sensor(sensors, "sony", "ilce-7M3")->width_mm, 35.8);
    EXPECT_EQ(find_sensor(sensors, "SONY", "DSC-RX100M5")->width_mm, 13.2);
    EXPECT_EQ(find_sensor(sensors, "Kodak", "Brownie"), nullptr);
}

TEST(Sensors, AUsersTableWinsOverTheBuiltIn) {
    const test::TempFolder folder;
    const std::string file = folder / "mine.csv";
    std::ofstream(file) << "# ours\nSONY,ILCE-7M3,17.5,11.7\r\nAcme,Box, 10 ,8\n";
    const auto sensors = sensors_with(file);
    EXPECT_EQ(find_sensor(sensors, "SONY", "ILCE-7M3")->width_mm, 17.5);
    EXPECT_EQ(find_sensor(sensors, "Acme", "Box 2")->height_mm, 8);
}

TEST(Sensors, ABadTableIsRefusedWithItsLine) {
    const test::TempFolder folder;
    for (const char* text :
         {"SONY,ILCE-7M3,wide,11.7\n", "SONY,ILCE-7M3\n", "SONY,X,36,24,1\n", "SONY,X,-1,2\n"}) {
        const std::string file = folder / "bad.csv";
        std::ofstream(file) << "# one\n" << text;
        try {
            sensors_with(file);
            FAIL() << text;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("bad.csv: line 2"), std::string::npos) << e.what();
        }
    }
    EXPECT_THROW(sensors_with(folder / "missing.csv"), Error);
}

TEST(Sensors, GiveTheFocalLengthThatExifLacks) {
    const auto sensors = sensors_with(std::nullopt);
    const Metadata metadata = exif("NIKON CORPORATION", "NIKON D750", 50);
    EXPECT_FALSE(camera_from_metadata(metadata, {6000, 4000}));
    const auto landscape = camera_from_metadata(metadata, {6000, 4000}, sensors);
    ASSERT_TRUE(landscape);
    EXPECT_NEAR(*landscape->camera.focal, 50 / 35.9 * 6000, 1e-9);
    EXPECT_NE(landscape->source.find("D750"), std::string::npos);
    // Held upright the long side is the height.
    EXPECT_NEAR(*camera_from_metadata(metadata, {4000, 6000}, sensors)->camera.focal,
                50 / 35.9 * 6000, 1e-9);
}

TEST(Sensors, ACroppedPictureIsRecognised) {
    Metadata metadata = exif("NIKON CORPORATION", "NIKON D750", 50);
    EXPECT_FALSE(cropped_since(metadata, {6000, 4000}));
    EXPECT_TRUE(cropped_since(metadata, {4000, 4000}));
    metadata.set("Exif:PixelXDimension", 6000.0);
    metadata.set("Exif:PixelYDimension", 4000.0);
    EXPECT_TRUE(cropped_since(metadata, {5000, 3000}));
    EXPECT_FALSE(cropped_since(metadata, {3000, 2000}));  // resized
    EXPECT_FALSE(cropped_since({}, {4000, 4000}));        // nothing was told
}

}  // namespace
}  // namespace chromeball
