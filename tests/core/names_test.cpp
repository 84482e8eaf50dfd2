#include "core/names.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

using Names = std::vector<std::string>;

const Names kSpaces{"ACEScg",       "ACES2065-1",      "Linear Rec.709",
                    "sRGB Texture", "ARRI LogC EI800", "raw"};

TEST(NearestNames, FindATypingMistake) {
    EXPECT_EQ(nearest_names("ACEScg2", kSpaces).front(), "ACEScg");
    EXPECT_EQ(nearest_names("lnear rec709", kSpaces).front(), "Linear Rec.709");
}

TEST(NearestNames, IgnoreCase) {
    EXPECT_EQ(nearest_names("acesCG", {"ACEScc", "ACEScg"}).front(), "ACEScg");
}

TEST(NearestNames, FindANameByAPartOfIt) {
    EXPECT_EQ(nearest_names("logc", kSpaces), Names{"ARRI LogC EI800"});
    EXPECT_EQ(nearest_names("the raw data", kSpaces), Names{"raw"});
}

TEST(NearestNames, OfNothingAlikeAreNone) {
    EXPECT_TRUE(nearest_names("zzzzzzzz", kSpaces).empty());
    EXPECT_TRUE(nearest_names("", kSpaces).empty());
    EXPECT_TRUE(nearest_names("latlong", {}).empty());
}

TEST(NearestNames, AreBestFirstAndNoMoreThanAsked) {
    const Names names{"cross-hhh", "cross-v", "cross-h"};
    EXPECT_EQ(nearest_names("cross-h", names, 2), (Names{"cross-h", "cross-hhh"}));
    EXPECT_EQ(nearest_names("cross-x", names, 1), Names{"cross-v"});  // as near: the first of them
}

TEST(QuotedList, ReadsAsASentence) {
    EXPECT_EQ(quoted_list({}), "");
    EXPECT_EQ(quoted_list({"a"}), "\"a\"");
    EXPECT_EQ(quoted_list({"a", "b"}), "\"a\" or \"b\"");
    EXPECT_EQ(quoted_list({"a", "b", "c"}), "\"a\", \"b\" or \"c\"");
}

TEST(Excerpt, ShowsPlainTextAsItIsAndTheRestAsQuestionMarks) {
    EXPECT_EQ(excerpt("size = 1024"), "size = 1024");
    EXPECT_EQ(excerpt(std::string("a\x1b[31m\n\0\xff~", 10)), "a?[31m???~");
}

TEST(Excerpt, IsCutAtSixtyCharacters) {
    EXPECT_EQ(excerpt(std::string(60, 'x')), std::string(60, 'x'));
    EXPECT_EQ(excerpt(std::string(61, 'x')), std::string(60, 'x') + "...");
}

}  // namespace
}  // namespace chromeball
