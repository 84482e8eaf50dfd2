#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "core/parallel.h"
#include "detect/detect.h"
#include "detect/random_picture.h"
#include "detect/reliability.h"

namespace chromeball {
namespace {

constexpr int kLeastAnswers = 20;  // for a bin to be judged
constexpr double kBias = 0.05;     // what a smooth model may be off, on the average and in a bin
constexpr double kMostTaken =
    0.08;  // of what is no mirror ball; much of it made to be hard to tell
constexpr double kLeastFound = 0.2;  // of the balls, half of them small, blurred, dark, hidden, cut
constexpr double kLeastSure = 0.1;  // of the pictures: answers above a half, or the bins say little

int number_from(const char* variable, int usual) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : usual;
}

/// What was said of one candidate, and whether it was so.
struct Answer {
    double confidence = 0;
    bool right = false;
};

/// The answers for one picture, best first.
struct Verdict {
    std::string kind;
    bool ball = false;
    std::vector<Answer> answers;
};

Verdict verdict_on(const Photo& photo, const std::vector<Outline>& balls, std::string kind) {
    Verdict verdict{std::move(kind), !balls.empty(), {}};
    for (const Candidate& c : find_balls(photo))
        verdict.answers.push_back({c.confidence, right_one(c.outline, balls)});
    return verdict;
}

std::vector<Verdict> random_verdicts(int first, int count) {
    std::vector<Verdict> verdicts(static_cast<std::size_t>(count));
    for_each_band(count, 1, [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            const auto picture = painted::random_picture(static_cast<unsigned>(first + i));
            verdicts[static_cast<std::size_t>(i)] =
                verdict_on(picture.photo, picture.balls, picture.kind);
        }
    });
    return verdicts;
}

/// Photographs with known outlines: `index.txt` in a folder, a line each, "file" or "file cx cy a
/// b angle" (Outline's convention), the latter once for each mirror ball.
std::vector<Verdict> verdicts_on_set(const std::string& folder) {
    std::ifstream index(folder + "/index.txt");
    std::map<std::string, std::vector<Outline>> set;
    for (std::string line; std::getline(index, line);) {
        std::istringstream words(line);
        std::string file;
        Outline o;
        if (!(words >> file)) continue;
        auto& balls = set[file];
        if (words >> o.cx >> o.cy >> o.a >> o.b >> o.angle) balls.push_back(o);
    }
    std::vector<Verdict> verdicts;
    for (const auto& [file, balls] : set)
        verdicts.push_back(verdict_on(read_photo(folder + "/" + file), balls, file));
    return verdicts;
}

/// Answers of about one confidence.
struct Bin {
    int count = 0, right = 0;
    double confidence = 0;
    void add(const Answer& answer) {
        ++count, right += answer.right, confidence += answer.confidence;
    }
    double said() const { return confidence / count; }
    double was() const { return double(right) / count; }
    /// Standard deviation of was() if what was said is true.
    double deviation() const { return std::sqrt(said() * (1 - said()) / count); }
};
using Table = std::array<Bin, 10>;

Bin& bin_of(Table& table, const Answer& answer) {
    return table[static_cast<std::size_t>(std::clamp(10 * answer.confidence, 0.0, 9.0))];
}

void print(const char* title, const Table& table) {
    std::printf("%s\nconfidence   answers  said   right  +-\n", title);
    for (std::size_t b = 0; b < table.size(); ++b)
        if (const Bin& bin = table[b]; bin.count > 0)
            std::printf("%.1f to %.1f   %7d  %.3f  %.3f  %.3f\n", 0.1 * double(b),
                        0.1 * double(b + 1), bin.count, bin.said(), bin.was(), bin.deviation());
}

Table table_of_best(const std::vector<Verdict>& verdicts) {
    Table table;
    for (const Verdict& v : verdicts) {
        const Answer best = v.answers.empty() ? Answer{} : v.answers.front();
        bin_of(table, best).add(best);
    }
    return table;
}

Table table_of_all(const std::vector<Verdict>& verdicts) {
    Table table;
    for (const Verdict& v : verdicts)
        for (const Answer& answer : v.answers) bin_of(table, answer).add(answer);
    return table;
}

/// Mean difference of said and right over all answers, and what chance makes of it.
double calibration_error(const Table& table) {
    double sum = 0, count = 0;
    for (const Bin& bin : table)
        if (bin.count > 0) sum += bin.count * std::abs(bin.was() - bin.said()), count += bin.count;
    return sum / count;
}
double noise_of(const Table& table) {
    double sum = 0, count = 0;
    for (const Bin& bin : table)  // 0.8: the mean size of normal errors
        if (bin.count > 0) sum += bin.count * 0.8 * bin.deviation(), count += bin.count;
    return sum / count;
}

struct Counts {
    int pictures = 0, taken = 0, right = 0;
};

std::map<std::string, Counts> kinds_of(const std::vector<Verdict>& verdicts) {
    std::map<std::string, Counts> kinds;
    for (const Verdict& v : verdicts) {
        Counts& counts = kinds[v.ball ? "with a mirror ball" : v.kind];
        const bool taken = !v.answers.empty() && v.answers.front().confidence >= 0.5;
        ++counts.pictures;
        counts.taken += taken;
        counts.right += taken && v.answers.front().right;
    }
    return kinds;
}

void print(const std::map<std::string, Counts>& kinds) {
    std::printf("%-20s pictures  taken for a mirror ball  right\n", "");
    for (const auto& [kind, counts] : kinds)
        std::printf("%-20s %8d  %23d  %5d\n", kind.c_str(), counts.pictures, counts.taken,
                    counts.right);
}

// CHROMEBALL_DETECT_PICTURES looks at so many random pictures, CHROMEBALL_DETECT_FIRST is the
// number of the first (the weights were fitted on 100000 and up: see README.md).
TEST(Reliability, ConfidenceIsTheChanceToBeRight) {
    const int count = number_from("CHROMEBALL_DETECT_PICTURES", 160);
    const auto verdicts = random_verdicts(number_from("CHROMEBALL_DETECT_FIRST", 1), count);
    const Table best = table_of_best(verdicts), all = table_of_all(verdicts);
    print("The best candidate of each picture", best);
    print("All candidates told", all);
    const auto kinds = kinds_of(verdicts);
    print(kinds);
    for (const Table& table : {best, all})
        for (const Bin& bin : table) {
            if (bin.count < kLeastAnswers) continue;
            // Three standard deviations, and what a smooth model may be off.
            EXPECT_NEAR(bin.was(), bin.said(), 3 * bin.deviation() + kBias) << bin.count;
        }
    EXPECT_LT(calibration_error(best), kBias + noise_of(best));
    int sure = 0;
    for (std::size_t b = 5; b < best.size(); ++b) sure += best[b].count;
    EXPECT_GE(sure, kLeastSure * count);
    int others = 0, taken = 0;
    for (const auto& [kind, counts] : kinds)
        if (kind != "with a mirror ball") others += counts.pictures, taken += counts.taken;
    EXPECT_LE(taken, kMostTaken * others);
    const Counts balls = kinds.at("with a mirror ball");
    EXPECT_GE(balls.right, kLeastFound * balls.pictures);
}

// CHROMEBALL_DETECT_SET: a folder of photographs with known outlines, see README.md.
TEST(Reliability, ConfidenceHoldsForASetOfPhotographs) {
    const char* folder = std::getenv("CHROMEBALL_DETECT_SET");
    if (!folder) GTEST_SKIP() << "CHROMEBALL_DETECT_SET names no folder";
    const auto verdicts = verdicts_on_set(folder);
    ASSERT_FALSE(verdicts.empty());
    const Table best = table_of_best(verdicts);
    print("The best candidate of each photograph", best);
    print("All candidates told", table_of_all(verdicts));
    for (const Verdict& v : verdicts) {
        const Answer answer = v.answers.empty() ? Answer{} : v.answers.front();
        std::printf("%-30s %-7s %.3f %s\n", v.kind.c_str(), v.ball ? "ball" : "no ball",
                    answer.confidence, answer.right ? "right" : "not right");
    }
    for (const Bin& bin : best)
        if (bin.count >= kLeastAnswers) {
            EXPECT_NEAR(bin.was(), bin.said(), 3 * bin.deviation() + kBias) << bin.count;
        }
}

}  // namespace
}  // namespace chromeball
