#include "core/metadata.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

TEST(Metadata, FindsWhatWasSetByItsExactName) {
    Metadata facts;
    facts.set("owner", "Anna");
    facts.set("focal", 35.0);
    ASSERT_NE(facts.find("owner"), nullptr);
    EXPECT_EQ(facts.text("owner"), "Anna");
    EXPECT_EQ(facts.number("focal"), 35.0);
    EXPECT_EQ(facts.find("Owner"), nullptr);
    EXPECT_EQ(facts.text("missing"), std::nullopt);
    EXPECT_EQ(facts.number("missing"), std::nullopt);
}

TEST(Metadata, TellsTextFromNumbers) {
    Metadata facts;
    facts.set("owner", "12");
    facts.set("focal", 35.0);
    EXPECT_EQ(facts.number("owner"), std::nullopt);
    EXPECT_EQ(facts.text("focal"), std::nullopt);
}

TEST(Metadata, GivesTheFirstComponentOfAnAttributeOfSeveral) {
    Metadata facts;
    facts.set({"box", "box2i", {3, 4, 5, 6}, {}});
    facts.set({"nothing", "v2f", {}, {}});
    EXPECT_EQ(facts.number("box"), 3.0);
    EXPECT_EQ(facts.number("nothing"), std::nullopt);
}

TEST(Metadata, HoldsEveryNameOnceInTheOrderOfTheFile) {
    Metadata facts;
    facts.set("b", 1.0);
    facts.set("a", 2.0);
    facts.set("b", "text now");
    ASSERT_EQ(facts.all().size(), 2U);
    EXPECT_EQ(facts.all()[0].name, "b");
    EXPECT_EQ(facts.all()[1].name, "a");
    EXPECT_EQ(facts.text("b"), "text now");
    EXPECT_EQ(facts.number("b"), std::nullopt);
}

}  // namespace
}  // namespace chromeball
