#include "light/exposure.h"

#include <gtest/gtest.h>

namespace chromeball {
namespace {

TEST(ExposureTags, AreReadUnderTheirStandardNames) {
    Metadata metadata;
    metadata.set("expTime", 0.008);
    metadata.set("aperture", 8.0);
    metadata.set("isoSpeed", 0.0);  // a camera that does not know writes 0
    EXPECT_EQ(exposure_tags(metadata), (ExposureTags{0.008, 8.0, std::nullopt}));
}

TEST(Exposure, CountsTimeSensitivityAndAperture) {
    EXPECT_DOUBLE_EQ(*exposure_of({0.5, 4.0, 200.0}), 0.0625);
    EXPECT_DOUBLE_EQ(*exposure_of({0.5, std::nullopt, std::nullopt}), 0.5);
    EXPECT_FALSE(exposure_of({std::nullopt, 4.0, 200.0}));
}

}  // namespace
}  // namespace chromeball
