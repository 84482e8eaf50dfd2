#include "color/color.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "color/built_in_config.h"
#include "core/error.h"

namespace chromeball {
namespace {

/// A folder of files that is gone with the test; $OCIO is cleared around every test.
class Config : public testing::Test {
protected:
    Config() {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("chromeball_color_" + std::string(test->name()));
        std::filesystem::create_directories(folder_);
        unsetenv("OCIO");
    }
    ~Config() override {
        unsetenv("OCIO");
        std::filesystem::remove_all(folder_);
    }

    std::string written(const std::string& name, const std::string& text) const {
        const auto path = folder_ / name;
        std::ofstream(path) << text;
        return path.string();
    }

    /// A small config whose scene_linear role is called "house linear".
    static std::string house_config() {
        return "ocio_profile_version: 2\n"
               "roles: {scene_linear: house linear, default: house linear}\n"
               "file_rules:\n"
               "  - !<Rule> {name: Plates, pattern: \"plate*\", extension: dpx, colorspace: log}\n"
               "  - !<Rule> {name: Default, colorspace: default}\n"
               "displays:\n"
               "  monitor:\n"
               "    - !<View> {name: plain, colorspace: log}\n"
               "    - !<View> {name: lost, colorspace: broken}\n"
               "colorspaces:\n"
               "  - !<ColorSpace> {name: house linear}\n"
               "  - !<ColorSpace>\n"
               "    name: log\n"
               "    to_scene_reference: !<LogTransform> {base: 2, direction: inverse}\n"
               "  - !<ColorSpace>\n"
               "    name: broken\n"
               "    to_scene_reference: !<FileTransform> {src: nowhere.spi1d}\n";
    }

    static std::string message_of(const std::function<void()>& work,
                                  Error::Kind kind = Error::Kind::failed) {
        try {
            work();
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), kind) << e.what();
            return e.what();
        }
        ADD_FAILURE() << "no error";
        return "";
    }

    std::filesystem::path folder_;
};

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST_F(Config, WithoutFileOrEnvironmentIsTheBuiltInOne) {
    const ColorConfig config = ColorConfig::load({});
    EXPECT_EQ(config.source(), "built-in");
    EXPECT_EQ(config.space("scene_linear"), "ACEScg");
}

TEST_F(Config, TheBuiltInOneIsTheFileInData) {
    std::ifstream file(CHROMEBALL_DATA "/chromeball.ocio");
    std::ostringstream text;
    text << file.rdbuf();
    EXPECT_EQ(built_in_config_text(), text.str());
}

TEST_F(Config, ComesFromTheFileAskedFor) {
    const std::string path = written("house.ocio", house_config());
    const ColorConfig config = ColorConfig::load(path);
    EXPECT_EQ(config.source(), path);
    EXPECT_EQ(config.space("scene_linear"), "house linear");
}

TEST_F(Config, ComesFromTheEnvironment) {
    const std::string path = written("house.ocio", house_config());
    setenv("OCIO", path.c_str(), 1);
    EXPECT_EQ(ColorConfig::load({}).source(), path);
}

TEST_F(Config, AFileAskedForGoesBeforeTheEnvironment) {
    setenv("OCIO", "/nowhere/config.ocio", 1);
    const std::string path = written("house.ocio", house_config());
    EXPECT_EQ(ColorConfig::load(path).source(), path);
}

TEST_F(Config, AnEmptyEnvironmentIsNone) {
    setenv("OCIO", "", 1);
    EXPECT_EQ(ColorConfig::load({}).source(), "built-in");
}

TEST_F(Config, AMissingFileIsNamedWithTheWayOut) {
    const std::string message = message_of([] { ColorConfig::load("nowhere.ocio"); });
    EXPECT_TRUE(message.starts_with("nowhere.ocio: no such file")) << message;
    EXPECT_TRUE(holds(message, "--ocio")) << message;
}

TEST_F(Config, AMissingFileOfTheEnvironmentIsSaidToBeSo) {
    setenv("OCIO", "/nowhere/config.ocio", 1);
    const std::string message = message_of([] { ColorConfig::load({}); });
    EXPECT_TRUE(message.starts_with("/nowhere/config.ocio (from $OCIO): no such file")) << message;
    EXPECT_TRUE(holds(message, "clear $OCIO")) << message;
}

TEST_F(Config, AFolderIsNoConfig) {
    const std::string path = folder_.string();
    const std::string message = message_of([&] { ColorConfig::load(path); });
    EXPECT_TRUE(message.starts_with(path + ": not a file")) << message;
}

TEST_F(Config, BrokenFilesAreNamedOnOneLineWithoutNoise) {
    for (const std::string text :
         {"", "no config at all", "{", "ocio_profile_version: 99\n",
          "ocio_profile_version: 2\ncolorspaces: 7\n", "\x89PNG\r\n\x1a\n"}) {
        const std::string path = written("broken.ocio", text);
        testing::internal::CaptureStderr();
        const std::string message = message_of([&] { ColorConfig::load(path); });
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
        EXPECT_TRUE(message.starts_with(path + ": ")) << message;
        EXPECT_TRUE(holds(message, "--ocio")) << message;
        EXPECT_FALSE(holds(message, "\n")) << message;
    }
}

TEST_F(Config, OneWithoutSceneLinearRoleIsRefused) {
    const std::string path = written("roleless.ocio",
                                     "ocio_profile_version: 1\n"
                                     "roles: {default: a}\n"
                                     "displays: {}\n"
                                     "colorspaces:\n"
                                     "  - !<ColorSpace> {name: a}\n");
    const std::string message = message_of([&] { ColorConfig::load(path); });
    EXPECT_TRUE(holds(message, "scene_linear")) << message;
}

TEST_F(Config, ASpaceWhoseTableIsMissingIsAnErrorWhenUsed) {
    const std::string path = written("house.ocio", house_config());
    const ColorConfig config = ColorConfig::load(path);
    Image image({1, 1}, 3);
    for (const std::string& message : {
             message_of([&] { config.is_linear("broken"); }),
             message_of([&] { config.from_working(image, "broken"); }),
             message_of([&] { config.to_display(image, "monitor", "lost"); }),
         }) {
        EXPECT_TRUE(message.starts_with(path + ": ")) << message;
        EXPECT_TRUE(holds(message, "nowhere.spi1d")) << message;
    }
}

TEST_F(Config, ARuleForThePathDecidesBeforeTheKindOfNumbers) {
    const ColorConfig config = ColorConfig::load(written("house.ocio", house_config()));
    Photo photo;
    photo.name = "plate.0001.dpx";
    photo.type = PixelType::f32;
    EXPECT_EQ(config.input_space(photo, {}), "log");
}

TEST_F(Config, IntegersOfAConfigWithALinearDefaultAreTheSrgbTextureThatItHas) {
    Photo photo;
    photo.name = "photo.jpg";
    const ColorConfig without = ColorConfig::load(written("house.ocio", house_config()));
    EXPECT_EQ(without.input_space(photo, {}), "house linear");
    const ColorConfig with = ColorConfig::load(
        written("texture.ocio", house_config() +
                                    "  - !<ColorSpace>\n"
                                    "    name: Utility - sRGB - Texture\n"
                                    "    to_scene_reference: !<ExponentTransform> {value: 2.2}\n"));
    EXPECT_EQ(with.input_space(photo, {}), "Utility - sRGB - Texture");
}

TEST_F(Config, AnOldOneWithoutRulesDefaultsOrDisplaysServesWithoutNoise) {
    const std::string path = written("old.ocio",
                                     "ocio_profile_version: 1\n"
                                     "roles: {scene_linear: linear}\n"
                                     "displays: {}\n"
                                     "colorspaces:\n"
                                     "  - !<ColorSpace> {name: linear}\n");
    testing::internal::CaptureStderr();
    const ColorConfig config = ColorConfig::load(path);
    Photo photo;
    photo.name = "photo.jpg";
    EXPECT_EQ(config.input_space(photo, {}), "linear");
    EXPECT_EQ(config.displays(), std::vector<std::string>{});
    Image image({1, 1}, 3);
    const std::string message =
        message_of([&] { config.to_display(image, "sRGB", "Film"); }, Error::Kind::usage);
    EXPECT_EQ(message, "display \"sRGB\" is not in " + path + ", which has none");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Config, PicturesNeedASpaceNamedWhereThereIsNoSrgbTexture) {
    const ColorConfig config = ColorConfig::load(written("house.ocio", house_config()));
    EXPECT_EQ(config.output_space({}, true), "house linear");
    EXPECT_EQ(config.output_space("log", false), "log");
    const std::string message =
        message_of([&] { config.output_space({}, false); }, Error::Kind::usage);
    EXPECT_TRUE(holds(message, "--output-space")) << message;
}

TEST_F(Config, ATagWithoutCounterpartIsAWarning) {
    const ColorConfig config = ColorConfig::load(written("house.ocio", house_config()));
    Photo photo;
    photo.name = "map.exr";
    photo.type = PixelType::f16;
    photo.color.space = "lin_rec2020_scene";
    std::string warning;
    EXPECT_EQ(config.input_space(photo, {}, &warning), "house linear");
    EXPECT_TRUE(holds(warning, "lin_rec2020_scene")) << warning;
}

TEST_F(Config, CanBeMoved) {
    ColorConfig a = ColorConfig::built_in();
    ColorConfig b = std::move(a);
    a = ColorConfig::load(written("house.ocio", house_config()));
    EXPECT_EQ(a.space("scene_linear"), "house linear");
    EXPECT_EQ(b.space("scene_linear"), "ACEScg");
}

}  // namespace
}  // namespace chromeball
