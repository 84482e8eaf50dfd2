#include <gtest/gtest.h>

#include "color/color.h"
#include "color/known_spaces.h"
#include "color/pictures.h"
#include "core/error.h"

namespace chromeball {
namespace {

const ColorConfig& config() {
    static const ColorConfig built_in = ColorConfig::built_in();
    return built_in;
}

Photo photo_of_type(PixelType type, const std::string& name) {
    Photo photo;
    photo.name = name;
    photo.type = type;
    photo.channels = 3;
    return photo;
}

std::string space_of(const ColorTag& tag, PixelType type = PixelType::u8) {
    Photo photo = photo_of_type(type, "photo.jpg");
    photo.color = tag;
    std::string warning;
    const std::string space = config().input_space(photo, {}, &warning);
    EXPECT_EQ(warning, "") << tag.space;
    return space;
}

TEST(InputSpace, WithoutTagIsSrgbForIntegersAndSceneLinearForFloats) {
    const auto space = [](PixelType type, const char* name) {
        return config().input_space(photo_of_type(type, name), {});
    };
    EXPECT_EQ(space(PixelType::u8, "photo.jpg"), "sRGB texture");
    EXPECT_EQ(space(PixelType::u16, "photo.tif"), "sRGB texture");
    EXPECT_EQ(space(PixelType::u16, "photo"), "sRGB texture");
    EXPECT_EQ(space(PixelType::f16, "probe.exr"), "ACEScg");
    EXPECT_EQ(space(PixelType::f32, "PROBE.HDR"), "ACEScg");
    EXPECT_EQ(space(PixelType::f32, "probe.tif"), "ACEScg");
}

TEST(InputSpace, IsTheOneAskedForWhateverTheTag) {
    Photo photo = photo_of_type(PixelType::u8, "photo.jpg");
    photo.color.space = "nonsense";
    std::string warning;
    EXPECT_EQ(config().input_space(photo, "logc", &warning), "ARRI LogC EI800");
    EXPECT_EQ(warning, "");
    EXPECT_THROW(config().input_space(photo, "nonsense"), Error);
}

TEST(InputSpace, ComesFromInteropIdentifiers) {
    EXPECT_EQ(space_of({"lin_ap1_scene", {}}), "ACEScg");
    EXPECT_EQ(space_of({"lin_ap0_scene", {}}), "ACES2065-1");
    EXPECT_EQ(space_of({"lin_rec709_scene", {}}), "Linear Rec.709");
    EXPECT_EQ(space_of({"lin_p3d65_scene", {}}), "Linear P3-D65");
    EXPECT_EQ(space_of({"lin_rec2020_scene", {}}), "Linear Rec.2020");
    EXPECT_EQ(space_of({"srgb_rec709_scene", {}}), "sRGB texture");
    EXPECT_EQ(space_of({"srgb_p3d65_scene", {}}), "Display P3 texture");
    EXPECT_EQ(space_of({"g22_adobergb_scene", {}}), "Adobe RGB");
    EXPECT_EQ(space_of({"data", {}}), "raw");
}

TEST(InputSpace, ComesFromProfilesAndExif) {
    for (const char* name : {"sRGB IEC61966-2.1", "sRGB", "sRGB IEC61966-2-1", "sRGB built-in",
                             "srgb iec61966-2.1 ", "c2"})
        EXPECT_EQ(space_of({name, {}}), "sRGB texture") << name;
    EXPECT_EQ(space_of({"Display P3", {}}), "Display P3 texture");
    EXPECT_EQ(space_of({"Adobe RGB (1998)", {}}), "Adobe RGB");
    EXPECT_EQ(space_of({"AdobeRGB", {}}), "Adobe RGB");
    EXPECT_EQ(space_of({"Gray Gamma 2.2", {}}), "Gamma 2.2 Rec.709 texture");
}

TEST(InputSpace, ComesFromNamesOfTheConfig) {
    EXPECT_EQ(space_of({"V-Log V-Gamut", {}}), "V-Log V-Gamut");
    EXPECT_EQ(space_of({"logc", {}}), "ARRI LogC EI800");
}

TEST(InputSpace, ComesFromChromaticities) {
    const auto space = [](std::array<double, 8> c) { return space_of({"", c}, PixelType::f16); };
    EXPECT_EQ(space({0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329}), "Linear Rec.709");
    // Rounded by somebody: within the tolerance
    EXPECT_EQ(space({0.6401, 0.33, 0.3, 0.6, 0.15, 0.06, 0.31271, 0.32902}), "Linear Rec.709");
    EXPECT_EQ(space({0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329}), "Linear P3-D65");
    EXPECT_EQ(space({0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329}), "Linear Rec.2020");
    EXPECT_EQ(space({0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767}), "ACEScg");
    EXPECT_EQ(space({0.7347, 0.2653, 0, 1, 0.0001, -0.077, 0.32168, 0.33767}), "ACES2065-1");
}

TEST(InputSpace, TheNameOfATagGoesBeforeItsChromaticities) {
    const std::array<double, 8> rec709 = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329};
    EXPECT_EQ(space_of({"lin_ap1_scene", rec709}, PixelType::f16), "ACEScg");
    EXPECT_EQ(space_of({"unknown", rec709}, PixelType::f16), "Linear Rec.709");
}

TEST(InputSpace, AForeignTagIsWarnedOfAndTheRulesDecide) {
    Photo photo = photo_of_type(PixelType::u8, "photo.jpg");
    photo.color.space = "ProPhoto RGB";
    std::string warning;
    EXPECT_EQ(config().input_space(photo, {}, &warning), "sRGB texture");
    EXPECT_EQ(warning,
              "photo.jpg: the file's color tag \"ProPhoto RGB\" is not known to the built-in "
              "config; taken as \"sRGB texture\", say another with --input-space");
    EXPECT_EQ(config().input_space(photo, {}), "sRGB texture");
}

TEST(InputSpace, ForeignChromaticitiesAreWarnedOf) {
    Photo photo = photo_of_type(PixelType::f16, "plate.exr");
    photo.color.chromaticities = {0.684, 0.313, 0.221, 0.848, 0.0861, -0.102, 0.3127, 0.329};
    std::string warning;
    EXPECT_EQ(config().input_space(photo, {}, &warning), "ACEScg");
    EXPECT_NE(warning.find("red 0.6840 0.3130"), std::string::npos) << warning;
}

TEST(InputSpace, AForeignNameIsWarnedOfThoughChromaticitiesHelp) {
    Photo photo = photo_of_type(PixelType::f16, "plate.exr");
    photo.color = {"studio log", {{0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329}}};
    std::string warning;
    EXPECT_EQ(config().input_space(photo, {}, &warning), "Linear Rec.709");
    EXPECT_NE(warning.find("studio log"), std::string::npos) << warning;
}

TEST(OutputSpace, FollowsTheKindOfFile) {
    EXPECT_EQ(config().output_space({}, true), "ACEScg");
    EXPECT_EQ(config().output_space({}, false), "sRGB texture");
    EXPECT_EQ(config().output_space("lin_rec709", true), "Linear Rec.709");
    EXPECT_THROW(config().output_space("lin_rec708x", true), Error);
}

TEST(Tag, LinearSpacesHaveNameAndChromaticities) {
    const ColorTag tag = config().tag("scene_linear");
    EXPECT_EQ(tag.space, "lin_ap1_scene");
    ASSERT_TRUE(tag.chromaticities);
    EXPECT_EQ((*tag.chromaticities)[0], 0.713);
    EXPECT_EQ(config().tag("lin_rec709").space, "lin_rec709_scene");
}

TEST(Tag, EncodedSpacesHaveNoChromaticities) {
    EXPECT_EQ(config().tag("sRGB texture").space, "srgb_rec709_scene");
    EXPECT_FALSE(config().tag("sRGB texture").chromaticities);
    EXPECT_EQ(config().tag("raw").space, "data");
    EXPECT_EQ(config().tag("logc").space, "ARRI LogC EI800");
}

TEST(Tag, IsUnderstoodWhenReadAgain) {
    for (const std::string& name : config().space_names())
        EXPECT_EQ(space_of(config().tag(name)), config().space(name)) << name;
}

TEST(Tag, EveryKnownSpaceIsInTheBuiltInConfig) {
    for (const KnownSpace& known : known_spaces()) {
        EXPECT_EQ(config().tag(std::string(known.id)).space, known.id);
        EXPECT_EQ(known.chromaticities.has_value(), config().is_linear(std::string(known.id)));
    }
}

}  // namespace
}  // namespace chromeball
