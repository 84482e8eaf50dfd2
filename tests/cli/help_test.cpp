#include <gtest/gtest.h>

#include "cli/program.h"

// What the program tells of itself.

namespace chromeball {
namespace {

using namespace test;

TEST(Help, EveryCommandShowsDefaultsUnitsAndAnExample) {
    struct Case {
        std::string command;
        std::vector<std::string> says;
    };
    const std::vector<Case> cases{
        {"convert",
         {"latlong, faces, openexr", "blender, alias", "adaptive", "=adaptive", "default: 16",
          "degrees", "pixels", "400000000", "--camera-to-world", "--quiet", "--threads"}},
        {"detect", {"--overlay", "--crop", "=0.4", "pixels", "--json-lines", "--quiet"}},
        {"preview", {"--mesh", "teapot", "=mirror", "degrees", "pixels", "=16", "--turntable"}},
        {"info", {"--from", "--json", "400000000"}},
        {"merge", {"--times", "seconds", "=auto", "--anchor", "EV100", "pixels", "--quiet"}}};
    const TempFolder folder;
    const Outcome overview = run(folder, {"-h"});
    EXPECT_EQ(overview.status, 0);
    for (const Case& one : cases) {
        const Outcome help = run(folder, {one.command, "--help"});
        EXPECT_EQ(help.status, 0);
        EXPECT_EQ(help.err, "");
        for (const std::string& text : one.says)
            EXPECT_NE(help.out.find(text), std::string::npos) << one.command << ": " << text;
        EXPECT_NE(help.out.find("\n  chromeball " + one.command + " "), std::string::npos);
        EXPECT_NE(overview.out.find("\n  " + one.command), std::string::npos);
    }
}

TEST(Help, NothingTypedPrintsTheUsageAndIsStatusTwo) {
    const TempFolder folder;
    const Outcome outcome = run(folder, {});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(outcome.says("Usage: chromeball")) << outcome.err;
    EXPECT_TRUE(outcome.says("detect")) << outcome.err;
}

TEST(Help, TheVersionIsOneLineOnStandardOutput) {
    const TempFolder folder;
    const Outcome outcome = run(folder, {"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out.substr(0, 11), "chromeball ");
    EXPECT_EQ(outcome.out.find('\n'), outcome.out.size() - 1);
    EXPECT_EQ(outcome.err, "");
}

}  // namespace
}  // namespace chromeball
