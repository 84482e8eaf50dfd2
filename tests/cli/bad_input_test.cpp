#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "cli/program.h"
#include "cli/refusal.h"
#include "cli/world.h"

// Photos that are none, or are odd: what the program makes of them.

namespace chromeball {
namespace {

using namespace test;

constexpr Size kSize{120, 96};

/// A folder with a target that must not be harmed.
class BadInput : public testing::Test {
protected:
    BadInput() { write_bytes(folder / "out.exr", "precious"); }

    /// Refused by convert and by info, and by detect with an entry in its JSON.
    void expect_unreadable(const std::string& file, const std::vector<std::string>& says) {
        std::vector<std::string> all{file};
        all.insert(all.end(), says.begin(), says.end());
        expect_refusals(folder,
                        {{{"convert", file, "-o", "out.exr"}, all, 1}, {{"info", file}, all, 1}});
        const Outcome found = run(folder, {"detect", file});
        EXPECT_EQ(found.status, 1);
        EXPECT_EQ(found.lines_with("error: " + file), 1U) << found.err;
        EXPECT_NE(found.out.find("\"found\": false"), std::string::npos);
        EXPECT_NE(found.out.find("\"reason\": \"" + file), std::string::npos);
    }

    TempFolder folder;
};

Image a_ball_photo() { return ball_photo(kSize, distant_ball(60, 48, 40)); }

TEST_F(BadInput, AMissingFileIsNamed) { expect_unreadable("gone.jpg", {"no such file"}); }

TEST_F(BadInput, AFolderIsNoPhoto) {
    std::filesystem::create_directory(folder / "shots");
    expect_refusal(folder, {"convert", "shots", "-o", "out.exr"}, 1, {"shots", "folder"});
    const Outcome found = run(folder, {"detect", "shots"});
    EXPECT_EQ(found.status, 1);
    EXPECT_TRUE(found.says("shots: is a folder")) << found.err;
    // Of a map it may be six faces; these are not there.
    expect_refusal(folder, {"convert", "shots", "--from", "faces", "-o", "out.exr"}, 1,
                   {"shots: no six faces", "px nx py ny pz nz"});
    expect_refusal(folder, {"info", "shots"}, 1, {"shots"});
}

TEST_F(BadInput, AnEmptyFileIsCalledEmpty) {
    for (const std::string file : {"nothing.jpg", "nothing.exr"}) {
        write_bytes(folder / file, "");
        expect_unreadable(file, {"empty"});
    }
}

TEST_F(BadInput, ATruncatedJpegIsRefused) {
    write_picture(folder / "whole.jpg", a_ball_photo());
    const std::string bytes = read_bytes(folder / "whole.jpg");
    write_bytes(folder / "half.jpg", bytes.substr(0, bytes.size() / 2));
    expect_unreadable("half.jpg", {"copy"});
}

TEST_F(BadInput, AJpegWithAPieceMissingIsConvertedAndCalledDamaged) {
    write_picture(folder / "holed.jpg", a_ball_photo());
    std::string bytes = read_bytes(folder / "holed.jpg");
    write_bytes(folder / "holed.jpg", bytes.erase(bytes.size() * 3 / 4, 40));
    const Outcome outcome = run(
        folder, {"convert", "holed.jpg", "--ball", "60,48,40", "-o", "holed.exr", "--size", "16"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("holed.jpg: is damaged")) << outcome.err;
    EXPECT_EQ(outcome.lines_with("warning: holed.jpg: is damaged"), 1U) << outcome.err;
}

TEST_F(BadInput, ATruncatedExrIsRefused) {
    write_exr(folder / "whole.exr", a_ball_photo());
    const std::string bytes = read_bytes(folder / "whole.exr");
    write_bytes(folder / "half.exr", bytes.substr(0, bytes.size() / 2));
    expect_unreadable("half.exr", {"copy"});
}

TEST_F(BadInput, ATextRenamedToAPictureIsNoPicture) {
    std::vector<Refusal> cases;
    for (const std::string file : {"notes.exr", "notes.jpg", "notes"}) {
        write_bytes(folder / file, "shot 12, take 3: the ball was left in the van\n");
        cases.push_back({{"convert", file, "-o", "out.exr"}, {file}, 1});
    }
    expect_refusals(folder, cases);
}

TEST_F(BadInput, ASinglePixelHoldsNoBall) {
    write_exr(folder / "dot.exr", Image({1, 1}, 3));
    expect_refusal(folder, {"convert", "dot.exr", "-o", "out.exr"}, 4, {"dot.exr", "--ball"});
    expect_refusal(folder, {"convert", "dot.exr", "--from", "latlong", "-o", "out.exr"}, 1,
                   {"dot.exr", "1x1", "--from"});
    EXPECT_EQ(run(folder, {"info", "dot.exr"}).status, 0);
    // Told so, it is a ball one pixel wide.
    const Outcome told = run(folder, {"convert", "dot.exr", "--ball", "0.5,0.5,0.5", "--size", "16",
                                      "-o", "dot-map.exr"});
    EXPECT_EQ(told.status, 0) << told.err;
}

TEST_F(BadInput, ALineOfFiftyThousandPixelsHoldsNoBall) {
    write_exr(folder / "line.exr", Image({1, 50000}, 3));
    write_exr(folder / "lying.exr", Image({50000, 1}, 3));
    expect_refusal(folder, {"convert", "line.exr", "-o", "out.exr"}, 4, {"line.exr", "--ball"});
    expect_refusal(folder, {"convert", "lying.exr", "-o", "out.exr"}, 4, {"lying.exr", "--ball"});
    EXPECT_EQ(run(folder, {"info", "line.exr"}).status, 0);
}

TEST_F(BadInput, GreyPhotosAreConvertedAsGrey) {
    const Image color = a_ball_photo();
    for (const int channels : {1, 2}) {
        Image grey(kSize, channels == 1 ? 1 : 4);
        for (int y = 0; y < kSize.height; ++y)
            for (int x = 0; x < kSize.width; ++x) {
                grey.pixel(x, y)[0] = color.pixel(x, y)[1];  // (d_y + 1) / 2
                for (int c = 1; c < grey.channels(); ++c)
                    grey.pixel(x, y)[c] = c == 3 ? 1 : color.pixel(x, y)[1];
            }
        const std::string name = channels == 1 ? "grey.exr" : "grey-alpha.exr";
        if (channels == 1)
            write_exr(folder / name, grey);
        else
            write_grey_alpha(folder / name, grey);
        const std::string out = std::to_string(channels) + ".exr";
        const Outcome outcome = run(folder, {"convert", name, "--ball", "60,48,40", "--size", "32",
                                             "--orthographic", "--float", "-o", out});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        const Image map = read_floats(folder / out);
        ASSERT_EQ(map.channels(), 4);
        for (int x = 0; x < map.width(); x += 7) {
            const float* top = map.pixel(x, 0);
            const float* bottom = map.pixel(x, 31);
            EXPECT_NEAR(top[0], 1, 0.03);
            EXPECT_NEAR(bottom[0], 0, 0.03);
            EXPECT_NEAR(top[0], top[1], 1e-5);
            EXPECT_NEAR(top[0], top[2], 1e-5);
            EXPECT_NEAR(top[3], 1, 1e-5);
        }
    }
}

TEST_F(BadInput, NansAndInfinitiesInThePhotoAreCountedAndStayOut) {
    Image photo = a_ball_photo();
    photo.pixel(50, 40)[0] = std::numeric_limits<float>::quiet_NaN();
    photo.pixel(70, 40)[1] = std::numeric_limits<float>::infinity();
    photo.pixel(60, 60)[2] = -std::numeric_limits<float>::infinity();
    write_unrepaired_exr(folder / "sick.exr", photo);
    const Outcome outcome =
        run(folder, {"convert", "sick.exr", "--ball", "60,48,40", "--orthographic", "--size", "32",
                     "--float", "-o", "well.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.says("warning: sick.exr: 3 pixels are NaN or infinite")) << outcome.err;
    const Image map = read_floats(folder / "well.exr");
    for (int y = 0; y < map.height(); ++y)
        for (int i = 0; i < map.width() * 4; ++i) ASSERT_TRUE(std::isfinite(map.row(y)[i]));
    // 3e-2: a ball 80 pixels across, and three holes in it.
    EXPECT_LT(difference(map, *find_layout("latlong"), {}, -0.8).worst, 3e-2);
    const Outcome found = run(folder, {"detect", "sick.exr"});
    EXPECT_TRUE(found.status == 0 || found.status == 4) << found.err;
}

/// Refused with little memory: before anything of that size is allocated.
void expect_too_large(const TempFolder& folder, const std::string& file) {
    Circumstances little;
    little.memory_bytes = rlim_t{1} << 30;
    expect_refusal(folder, {"convert", file, "-o", "out.exr"}, 1, {file, "--max-pixels"}, little);
    expect_refusal(folder, {"info", file}, 1, {file, "--max-pixels"}, little);
    const Outcome found = run(folder, {"detect", file}, little);
    EXPECT_EQ(found.status, 1);
    EXPECT_TRUE(found.says("--max-pixels")) << found.err;
}

TEST_F(BadInput, AnExrThatClaimsTenBillionPixelsIsRefusedBeforeAllocating) {
    write_exr(folder / "huge.exr", a_ball_photo());
    std::string bytes = read_bytes(folder / "huge.exr");
    const std::int32_t last[2] = {99999, 99999};
    for (const std::string name : {"dataWindow", "displayWindow"}) {
        const auto at = bytes.find(name + '\0' + "box2i" + '\0');
        ASSERT_NE(at, std::string::npos);
        // Name, type, length of four bytes, then the window's first and last pixel.
        std::memcpy(bytes.data() + at + name.size() + 1 + 6 + 4 + 8, last, sizeof last);
    }
    write_bytes(folder / "huge.exr", bytes);
    expect_too_large(folder, "huge.exr");
}

TEST_F(BadInput, APngThatClaimsTenBillionPixelsIsRefusedBeforeAllocating) {
    write_picture(folder / "huge.png", a_ball_photo());
    std::string bytes = read_bytes(folder / "huge.png");
    bytes.replace(16, 8, std::string("\x00\x01\x86\xa0\x00\x01\x86\xa0", 8));  // 100000 each
    write_bytes(folder / "huge.png", bytes);
    Circumstances little;
    little.memory_bytes = rlim_t{1} << 30;
    // The checksum of the size is wrong now, which may be what is noticed first.
    expect_refusal(folder, {"convert", "huge.png", "-o", "out.exr"}, 1, {"huge.png"}, little);
}

TEST_F(BadInput, AnHdrThatClaimsTenBillionPixelsIsRefusedBeforeAllocating) {
    write_bytes(folder / "huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n");
    expect_too_large(folder, "huge.hdr");
}

TEST_F(BadInput, LargerPicturesThanAllowedAreRefused) {
    write_exr(folder / "photo.exr", a_ball_photo());
    expect_refusal(folder, {"convert", "photo.exr", "--max-pixels", "10000", "-o", "out.exr"}, 1,
                   {"photo.exr", "120x96", "10000", "--max-pixels"});
    expect_refusal(folder, {"convert", "photo.exr", "--max-pixels", "0", "-o", "out.exr"}, 2,
                   {"--max-pixels"});
}

TEST_F(BadInput, APhotoWithoutABallIsStatusFourAndTheWayOutIsNamed) {
    Image photo({160, 120}, 3);
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x)
            for (int c = 0; c < 3; ++c)
                photo.pixel(x, y)[c] = static_cast<float>(0.2 + 0.1 * std::sin(0.3 * x + 0.1 * y));
    write_picture(folder / "wall.png", photo);
    expect_refusal(folder, {"convert", "wall.png", "-o", "out.exr"}, 4,
                   {"wall.png", "no mirror ball", "--ball CX,CY,R", "--cropped"});
    const Outcome found = run(folder, {"detect", "wall.png", "--quiet"});
    EXPECT_EQ(found.status, 4);
    EXPECT_NE(found.out.find("\"found\": false"), std::string::npos);
    EXPECT_NE(found.out.find("--ball CX,CY,R"), std::string::npos);
}

TEST_F(BadInput, AMapIsNoPhotoAndTheWayOutIsNamed) {
    write_exr(folder / "world.exr", world_map(*find_layout("latlong"), 64));
    ASSERT_EQ(
        run(folder, {"convert", "world.exr", "--from", "latlong", "--size", "64", "-o", "map.exr"})
            .status,
        0);
    expect_refusal(folder, {"convert", "map.exr", "-o", "out.exr"}, 4,
                   {"map.exr", "--from latlong"});
}

TEST_F(BadInput, ABallPartlyOutsideTheFrameWorksAndItsCoverageSaysSo) {
    // A third of the ball is beyond the left edge: directions to the left were not photographed.
    write_exr(folder / "cut.exr", ball_photo(kSize, distant_ball(15, 48, 40)));
    const Outcome outcome =
        run(folder, {"convert", "cut.exr", "--ball", "15,48,40", "--orthographic", "--size", "64",
                     "--float", "-o", "cut-map.exr"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const Image map = read_floats(folder / "cut-map.exr");
    EXPECT_TRUE(outcome.says("warning: cut.exr: the ball is partly outside")) << outcome.err;
    const Difference d = difference(map, *find_layout("latlong"), {}, -0.8);
    EXPECT_LT(d.worst, 3e-2);
    EXPECT_GT(map.pixel(32, 32)[3], 0.99F);  // to the right
    EXPECT_EQ(map.pixel(96, 32)[3], 0.0F);   // to the left, beyond the edge
    // The disk shows equal solid angles in equal areas: s from -15 / 40 on.
    const double s = 15.0 / 40;
    const double seen = 0.5 + (std::asin(s) + s * std::sqrt(1 - s * s)) / std::numbers::pi;
    double sum = 0, all = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const double weight = std::sin(std::numbers::pi * (y + 0.5) / 64);
            sum += weight * map.pixel(x, y)[3];
            all += weight;
        }
    EXPECT_NEAR(sum / all, seen, 5e-3);
    const Outcome told = run(folder, {"info", "cut-map.exr", "--json"});
    EXPECT_NE(told.out.find("\"covered\": 0.7"), std::string::npos) << told.out;
}

TEST_F(BadInput, ABallOutsideThePictureIsRefused) {
    write_exr(folder / "photo.exr", a_ball_photo());
    std::vector<Refusal> cases;
    for (const std::string ball : {"500,48,40", "60,-100,40", "-41,48,40", "1e9,1e9,1"})
        cases.push_back({{"convert", "photo.exr", "--ball", ball, "-o", "out.exr"},
                         {"photo.exr", "--ball " + ball, "outside", "120x96"},
                         2});
    cases.push_back({{"convert", "photo.exr", "--ellipse", "500,48,40,30,0", "-o", "out.exr"},
                     {"--ellipse 500,48,40,30,0", "outside"},
                     2});
    expect_refusals(folder, cases);
}

}  // namespace
}  // namespace chromeball
