// Weighs the signs by which detection tells how sure it is: makes random pictures, looks for the
// balls in them, and fits a logistic regression of "this is a mirror ball, and the outline is right
// to 2 %" to what comes out. Prints src/detect/weights.cpp, or, with the word `moved` as the last
// argument, src/detect/moved_weights.cpp. See README.md.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>
#include <string>

#include "core/parallel.h"
#include "detect/detect.h"
#include "detect/moving_picture.h"
#include "detect/random_picture.h"
#include "detect/reliability.h"
#include "detect/weights.h"

namespace chromeball {
namespace {

using namespace detecting;

/// A candidate that was told: its signs and whether it was right.
struct Case {
    std::vector<double> signs;
    bool right = false;
    double weight = 1;
};

bool overlap(const Outline& one, const Outline& other) {
    return std::hypot(one.cx - other.cx, one.cy - other.cy) < std::max(one.b, other.b);
}

constexpr std::size_t kRamps = 3;

/// Logistic regression below what the gates allow, on the parts of all ramps, each allowed to push
/// in its sign's direction only, with a ridge that keeps the pieces of a sign, and the signs, from
/// doing much each.
class Fit {
public:
    Fit(const std::vector<Case>& cases, std::span<const Sign> signs, bool gated) : signs_(signs) {
        for (const Case& c : cases) {
            rows_.push_back({});
            for (std::size_t i = 0; i < signs_.size(); ++i)
                for (std::size_t k = 0; k < kRamps; ++k) {
                    const auto& knots = signs_[i].knots;
                    rows_.back().push_back(part_between(c.signs[i], knots[k], knots[k + 1]));
                }
            most_.push_back(gated ? most_for(c.signs) : 1);
            right_.push_back(c.right);
            weight_.push_back(c.weight);
            odds_.push_back(0);
        }
        for (int round = 0; round < 3000; ++round)
            if (sweep() < 1e-5) break;
    }

    void print() const {
        std::printf("constexpr std::array<double, 3> kGains[] = {\n");
        for (std::size_t i = 0; i < signs_.size(); ++i)
            std::printf("    {%.3f, %.3f, %.3f},  // %s\n", gains_[kRamps * i],
                        gains_[kRamps * i + 1], gains_[kRamps * i + 2], signs_[i].name);
        std::printf("};\nconstexpr double kBias = %.3f;\n\n", bias_);
    }
    std::size_t cases() const { return rows_.size(); }
    long right() const { return std::count(right_.begin(), right_.end(), true); }

private:
    static constexpr double kRidge = 0.5;  // of the least loss on pictures held out

    /// One Newton step for each number in turn; the largest change.
    double sweep() {
        double largest = std::abs(step(
            bias_, 0, [](const auto&) { return 1.0; }, 0));
        for (std::size_t j = 0; j < gains_.size(); ++j)
            largest =
                std::max(largest, std::abs(step(
                                      gains_[j], kRidge, [j](const auto& row) { return row[j]; },
                                      signs_[j / kRamps].direction)));
        return largest;
    }

    template <class Part>
    double step(double& gain, double ridge, const Part& part, int direction) {
        double slope = -ridge * gain, curve = ridge + 1e-6;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            const double x = part(rows_[i]);
            if (x == 0) continue;
            // Said is p = most * s(odds); what the log-likelihood gains with the odds, and on
            // average its curvature.
            const double s = 1 / (1 + std::exp(-odds_[i])), p = most_[i] * s;
            const double steep = (1 - s) / std::max(1 - p, 1e-9);
            slope += weight_[i] * steep * (right_[i] - p) * x;
            curve += weight_[i] * std::max(p * (1 - s) * steep, 0.02) * x * x;
        }
        double next = gain + std::clamp(slope / curve, -1.0, 1.0);
        if (direction != 0 && next * direction < 0) next = 0;
        const double change = next - gain;
        gain = next;
        if (change != 0)
            for (std::size_t i = 0; i < rows_.size(); ++i) odds_[i] += change * part(rows_[i]);
        return change;
    }

    std::span<const Sign> signs_;
    std::vector<double> gains_ = std::vector<double>(kRamps * signs_.size());
    double bias_ = 0;
    std::vector<std::vector<double>> rows_;
    std::vector<double> odds_, weight_, most_;
    std::vector<bool> right_;
};

/// Some pictures are large: there the rim is fitted at several scales. In some everything moved, or
/// there would be too few of these; in half of those nothing else makes it hard.
painted::RandomPicture picture_for(unsigned number) {
    if (number % 8 == 4) {
        painted::Dice dice(number + 1);
        const auto made = painted::moving_picture(number, dice.log_uniform(0.06, 0.4));
        return {made.photo, {made.outline}, "mirror-moving"};
    }
    if (number % 8 == 0) return painted::random_picture(number, 320, 640, true);
    if (number % 8 == 1) return painted::random_picture(number, 420, 720);
    return painted::random_picture(number);
}

/// Half hold a ball that moved and is hard for nothing else, in a grainy picture or not; the
/// others, all that moved in a picture that may be hard, and pictures in which little did, so that
/// what is but taken for a moved ball is among the cases.
painted::RandomPicture moved_picture_for(unsigned number) {
    if (number % 4 < 2) {
        painted::Dice dice(number + 1);
        const double part = dice.log_uniform(0.05, 0.42);
        const auto made = painted::moving_picture(number, part, number % 2 ? dice.whole(4, 16) : 0);
        return {made.photo, {made.outline}, "mirror-moving"};
    }
    if (number % 4 == 2) return painted::random_picture(number, 280, 560, true);
    return painted::random_picture(number, 200, 500);
}

/// The cases of one picture, in the order told: of what stood still, or of what moved.
std::vector<Case> cases_of(unsigned number, bool moved) {
    const auto picture = moved ? moved_picture_for(number) : picture_for(number);
    std::vector<Case> cases;
    std::vector<Outline> found;
    for (const Candidate& c : find_balls(picture.photo)) {
        if ((c.motion.length2() > 0) != moved) continue;
        // The signs are weighed as if the better candidates in the same place were wrong.
        if (std::any_of(found.begin(), found.end(),
                        [&](const Outline& o) { return overlap(o, c.outline); }))
            continue;
        const bool right = right_one(c.outline, picture.balls);
        cases.push_back({c.signs, right, cases.empty() ? 1.0 : 0.5});
        if (right) found.push_back(c.outline);
    }
    return cases;
}

using CasesByPicture = std::map<unsigned, std::vector<Case>>;

/// What an earlier run found: a line "number right weight signs..." a case, "number done" a
/// picture.
CasesByPicture kept_in(const std::string& file) {
    CasesByPicture cases;
    std::map<unsigned, std::vector<Case>> open;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        unsigned number = 0;
        std::string first;
        words >> number >> first;
        if (first == "done") {
            cases[number] = open[number];
            continue;
        }
        Case c;
        c.right = first == "1";
        words >> c.weight;
        for (double sign = 0; words >> sign;) c.signs.push_back(sign);
        open[number].push_back(c);
    }
    return cases;
}

/// `count` pictures from `first` on, or with a count of 0 those in the file; those that the file
/// does not hold are made and added to it.
CasesByPicture all_cases(unsigned first, int count, const std::string& file, bool moved) {
    CasesByPicture cases = kept_in(file);
    if (count == 0) return cases;
    cases.erase(cases.begin(), cases.lower_bound(first));
    cases.erase(cases.lower_bound(first + unsigned(count)), cases.end());
    const CasesByPicture before = cases;
    std::ofstream out(file, std::ios::app);
    out.precision(9);
    std::mutex mutex;
    for_each_band(count, 1, [&](int from, int to) {
        for (unsigned i = first + unsigned(from); i < first + unsigned(to); ++i) {
            if (before.contains(i)) continue;
            auto some = cases_of(i, moved);
            const std::lock_guard lock(mutex);
            for (const Case& c : some) {
                out << i << ' ' << c.right << ' ' << c.weight;
                for (const double sign : c.signs) out << ' ' << sign;
                out << '\n';
            }
            out << i << " done" << std::endl;
            cases[i] = std::move(some);
            if (cases.size() % 100 == 0) std::cerr << cases.size() << " pictures\n";
        }
    });
    return cases;
}

}  // namespace
}  // namespace chromeball

int main(int count, char** values) {
    using namespace chromeball;
    const int pictures = count > 1 ? std::atoi(values[1]) : 6000;
    const int first = count > 2 ? std::atoi(values[2]) : 100000;
    const bool moved = std::string(values[count - 1]) == "moved";
    const auto by_picture =
        all_cases(unsigned(first), pictures, count > 3 ? values[3] : "cases.txt", moved);
    std::vector<Case> cases;
    for (const auto& [number, some] : by_picture)
        cases.insert(cases.end(), some.begin(), some.end());
    const Fit fit(cases, moved ? moved_signs() : all_signs(), !moved);
    std::printf(
        "// Written by tests/detect/fit_confidence.cpp (see README.md there) from %zu of the "
        "random\n"
        "// pictures %u to %u: %zu candidates that %s, %ld of them right.\n\n"
        "#include \"detect/weights.h\"\n\n"
        "namespace chromeball::detecting {\nnamespace {\n\n",
        by_picture.size(), by_picture.begin()->first, by_picture.rbegin()->first, fit.cases(),
        moved ? "seemed to have moved" : "stood still", fit.right());
    fit.print();
    std::printf(
        "}  // namespace\n\n"
        "const Weights& %s() {\n"
        "    static const Weights kWeights{%s(), kBias, kGains, %s};\n"
        "    return kWeights;\n}\n\n"
        "}  // namespace chromeball::detecting\n",
        moved ? "moved_weights" : "weights", moved ? "moved_signs" : "all_signs",
        moved ? "false" : "true");
}
