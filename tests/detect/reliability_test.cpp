#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "detect/detect.h"
#include "detect/random_picture.h"

namespace chromeball {
namespace {

int number_from(const char* variable, int usual) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : usual;
}

/// The contract's measure: centre and both axes within 2 % of the radius.
bool right(const Outline& found, const Outline& truth) {
    const double part = 0.02 * std::sqrt(truth.a * truth.b);
    return std::hypot(found.cx - truth.cx, found.cy - truth.cy) <= part &&
           std::abs(found.a - truth.a) <= 0.02 * truth.a &&
           std::abs(found.b - truth.b) <= 0.02 * truth.b;
}

/// Answers of about one confidence.
struct Bin {
    int count = 0, right = 0;
    double confidence = 0;
};

// CHROMEBALL_DETECT_PICTURES=2000 looks at so many random pictures instead of a few, and
// CHROMEBALL_DETECT_FIRST is the number of the first (confidence was fitted on 100000 and up).
// CHROMEBALL_DETECT_ROWS=1 prints a row a picture.
TEST(Reliability, ConfidenceIsTheChanceToBeRight) {
    const int count = number_from("CHROMEBALL_DETECT_PICTURES", 60);
    const int first = number_from("CHROMEBALL_DETECT_FIRST", 1);
    const bool rows = number_from("CHROMEBALL_DETECT_ROWS", 0) != 0;
    std::array<Bin, 10> bins;
    int balls = 0, found = 0, false_positives = 0;
    double expected = 0, rights = 0;
    for (int i = first; i < first + count; ++i) {
        const auto picture = painted::random_picture(static_cast<unsigned>(i));
        const auto candidates = find_balls(picture.photo);
        const Candidate best = candidates.empty() ? Candidate{} : candidates.front();
        const bool hit = picture.ball && right(best.outline, *picture.ball);
        const Outline truth = picture.ball.value_or(Outline{});
        Bin& bin = bins[static_cast<std::size_t>(std::min(9.0, 10 * best.confidence))];
        ++bin.count;
        bin.right += hit;
        bin.confidence += best.confidence;
        expected += best.confidence;
        rights += hit;
        balls += picture.ball.has_value();
        found += hit && best.confidence >= 0.5;
        false_positives += !picture.ball && best.confidence >= 0.5;
        if (rows)
            std::printf("row %d %s confidence %.3f %s off %.2f %.2f %.2f %.2f of %.0f\n", i,
                        picture.kind.c_str(), best.confidence, hit ? "right" : "wrong",
                        best.outline.cx - truth.cx, best.outline.cy - truth.cy,
                        best.outline.a - truth.a, best.outline.b - truth.b, truth.b);
    }
    std::printf("confidence   pictures  said   right\n");
    for (std::size_t b = 0; b < bins.size(); ++b)
        if (const Bin& bin = bins[b]; bin.count > 0)
            std::printf("%.1f to %.1f   %8d  %.3f  %.3f\n", 0.1 * double(b), 0.1 * double(b + 1),
                        bin.count, bin.confidence / bin.count, double(bin.right) / bin.count);
    std::printf("%d of %d balls found right; %d of %d others taken for one\n", found, balls,
                false_positives, count - balls);
    // Four standard deviations of a sum of answers that are right half the time.
    EXPECT_NEAR(rights, expected, 2 * std::sqrt(double(count)) + 0.05 * count);
    EXPECT_LE(false_positives, 0.12 * count);  // the others are most wicked: 2 of 5 pictures
}

}  // namespace
}  // namespace chromeball
