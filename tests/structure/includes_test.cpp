#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "structure/include_rules.h"

namespace chromeball::structure {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

struct Source {
    std::string path;  // below the top folder
    std::string text;
};

/// Every source file of src and apps.
std::vector<Source> sources() {
    std::vector<Source> all;
    const fs::path top = CHROMEBALL_SOURCE;
    for (const char* folder : {"src", "apps"})
        for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
            const auto extension = entry.path().extension();
            if (extension != ".h" && extension != ".cpp") continue;
            std::ostringstream text;
            text << std::ifstream(entry.path()).rdbuf();
            all.push_back({fs::relative(entry.path(), top).generic_string(), text.str()});
        }
    return all;
}

TEST(Includes, FollowTheArrowsAndStayAtTheirDoors) {
    const auto all = sources();
    EXPECT_GT(all.size(), 20u);
    for (const Source& source : all)
        for (const std::string& sentence : violations(source.path, source.text))
            ADD_FAILURE() << sentence;
}

TEST(Includes, JsonIsInOneFileOfTheProgram) {
    int files = 0;
    for (const Source& source : sources())
        if (source.path.starts_with("apps/")) {
            const Strings names = includes_of(source.text);
            files += std::any_of(names.begin(), names.end(),
                                 [](const auto& n) { return n.starts_with("<nlohmann/"); });
        }
    EXPECT_LE(files, 1) << "each costs 3 s to compile";
}

TEST(IncludeRules, FindEveryFormOfTheLine) {
    EXPECT_EQ(includes_of("#include <a>\n"
                          "  #  include \"b/c.h\"  // why\r\n"
                          "// #include <d>\n"
                          "#include\n"
                          "#include <unfinished\n"
                          "int include;\n"
                          "#include <e/f.h>"),
              (Strings{"<a>", "\"b/c.h\"", "<e/f.h>"}));
    EXPECT_EQ(includes_of(""), Strings{});
}

TEST(IncludeRules, AllowWhatTheArchitectureDraws) {
    EXPECT_EQ(violations("src/color/color.cpp",
                         "#include \"color/color.h\"\n#include \"map/cube.h\"\n"
                         "#include \"core/image.h\"\n#include <OpenColorIO/OpenColorIO.h>\n"
                         "#include <fmt/format.h>\n#include <vector>\n#include <Imath/half.h>\n"),
              Strings{});
    EXPECT_EQ(violations("apps/chromeball/main.cpp",
                         "#include \"console.h\"\n#include \"chromeball/options.h\"\n"
                         "#include \"io/read.h\"\n#include <CLI/CLI.hpp>\n#include <unistd.h>\n"),
              Strings{});
}

TEST(IncludeRules, SeeArrowsThatPointUpOrSideways) {
    EXPECT_EQ(violations("src/core/image.h", "#include \"map/cube.h\"\n"),
              Strings{"src/core/image.h: \"map/cube.h\" is against the arrows"});
    EXPECT_EQ(violations("src/io/read.cpp", "#include \"color/color.h\"\n").size(), 1u);
    EXPECT_EQ(violations("src/detect/rim.h", "#include \"chromeball/options.h\"\n").size(), 1u);
    EXPECT_EQ(violations("src/map/cube.h", "#include \"latlong.h\"\n"),
              Strings{"src/map/cube.h: \"latlong.h\" is included without its folder"});
}

TEST(IncludeRules, SeeThirdPartiesAwayFromTheirDoors) {
    const auto count = [](const char* path, const char* text) {
        return violations(path, text).size();
    };
    EXPECT_EQ(count("src/map/cube.cpp", "#include <OpenImageIO/imageio.h>\n"), 1u);
    EXPECT_EQ(count("src/color/color.cpp", "#include <ImfHeader.h>\n"), 1u);
    EXPECT_EQ(count("src/io/read.cpp", "#include <OpenColorIO/OpenColorIO.h>\n"), 1u);
    EXPECT_EQ(count("src/resample/resample.cpp", "#include <opencv2/core.hpp>\n"), 1u);
    EXPECT_EQ(count("src/map/camera.cpp", "#include <Eigen/Dense>\n"), 1u);
    EXPECT_EQ(count("src/core/names.cpp", "#include <fmt/format.h>\n"), 1u);
    EXPECT_EQ(count("src/io/read.cpp", "#include <tbb/parallel_for.h>\n"), 1u);
    EXPECT_EQ(count("src/io/read.cpp", "#include <CLI/CLI.hpp>\n"), 1u);
    EXPECT_EQ(count("src/map/cube.cpp", "#include <unistd.h>\n"), 1u);
    EXPECT_EQ(violations("src/io/read.cpp", "#include <boost/any.hpp>\n"),
              Strings{"src/io/read.cpp: <boost/any.hpp> is not in the table of doors"});
}

TEST(IncludeRules, SeeFoldersThatNobodyDrew) {
    EXPECT_EQ(violations("src/misc/all.h", "").size(), 1u);
}

}  // namespace
}  // namespace chromeball::structure
