#include "core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace chromeball {
namespace {

using Ranges = std::set<std::pair<int, int>>;

Ranges ranges_of(int rows, int grain) {
    Ranges ranges;
    std::mutex adding;
    for_each_band(rows, grain, [&](int first, int last) {
        const std::lock_guard lock(adding);
        ranges.emplace(first, last);
    });
    return ranges;
}

TEST(ForEachBand, CoversEveryRowOnce) {
    for (const int rows : {1, 7, 8, 9, 100, 101}) {
        std::vector<std::atomic<int>> visits(static_cast<std::size_t>(rows));
        for_each_band(rows, 8, [&](int first, int last) {
            for (int y = first; y < last; ++y) ++visits[static_cast<std::size_t>(y)];
        });
        for (const auto& count : visits) EXPECT_EQ(count, 1) << rows << " rows";
    }
}

TEST(ForEachBand, HasTheSameRangesForAnyNumberOfThreads) {
    const Ranges free = ranges_of(20, 8);
    EXPECT_EQ(free, (Ranges{{0, 8}, {8, 16}, {16, 20}}));
    const ThreadLimit one(1);
    EXPECT_EQ(ranges_of(20, 8), free);
}

TEST(ForEachBand, OfNoRowsDoesNothing) {
    for_each_band(0, 8, [](int, int) { FAIL() << "called"; });
}

TEST(ForEachBand, TellsProgressUpToOne) {
    std::vector<double> told;
    Watch watch;
    watch.progress = [&](double part) { told.push_back(part); };  // one thread at a time
    for_each_band(
        100, 8, [](int, int) {}, watch);
    ASSERT_EQ(told.size(), 13U);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GT(told.front(), 0);
    EXPECT_DOUBLE_EQ(told.back(), 1);
}

Error::Kind kind_thrown(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& e) {
        return e.kind();
    }
    ADD_FAILURE() << "no error";
    return Error::Kind::failed;
}

TEST(ForEachBand, StopsBetweenBandsWhenAsked) {
    const ThreadLimit one(1);
    std::atomic<bool> stop = false;
    int bands = 0;
    const auto kind = kind_thrown([&] {
        for_each_band(1000, 1,
                      [&](int, int) {
                          ++bands;
                          stop = bands == 3;
                      },
                      {.stop = &stop});
    });
    EXPECT_EQ(kind, Error::Kind::interrupted);
    EXPECT_EQ(bands, 3);
}

TEST(ForEachBand, PassesOnWhatTheWorkThrows) {
    const auto kind = kind_thrown([] {
        for_each_band(10, 1, [](int first, int) {
            if (first == 5) throw Error(Error::Kind::no_ball, "five");
        });
    });
    EXPECT_EQ(kind, Error::Kind::no_ball);
}

TEST(Watch, SaysNothingUntilAStopIsAsked) {
    std::atomic<bool> stop = false;
    const Watch watch{.stop = &stop};
    EXPECT_NO_THROW(watch.check());
    stop = true;
    EXPECT_TRUE(watch.stopping());
    EXPECT_EQ(kind_thrown([&] { watch.check(); }), Error::Kind::interrupted);
    EXPECT_FALSE(Watch{}.stopping());
}

std::set<std::thread::id> threads_used() {
    std::set<std::thread::id> threads;
    std::mutex adding;
    for_each_band(64, 1, [&](int, int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // so that others get their turn
        const std::lock_guard lock(adding);
        threads.insert(std::this_thread::get_id());
    });
    return threads;
}

TEST(ThreadLimit, OfOneKeepsTheWorkOnTheCallersThread) {
    const ThreadLimit one(1);
    EXPECT_EQ(threads_used(), std::set{std::this_thread::get_id()});
}

TEST(ThreadLimit, HoldsOnlyWhileItLives) {
    {
        const ThreadLimit one(1);
        const ThreadLimit no_limit(0);  // adds nothing, takes nothing away
        EXPECT_EQ(threads_used().size(), 1U);
    }
    if (std::thread::hardware_concurrency() > 1) {
        EXPECT_GT(threads_used().size(), 1U);
    }
}

TEST(Error, CarriesItsExitStatus) {
    EXPECT_EQ(static_cast<int>(Error::Kind::failed), 1);
    EXPECT_EQ(static_cast<int>(Error::Kind::usage), 2);
    EXPECT_EQ(static_cast<int>(Error::Kind::partial), 3);
    EXPECT_EQ(static_cast<int>(Error::Kind::no_ball), 4);
    EXPECT_EQ(static_cast<int>(Error::Kind::interrupted), 130);
    EXPECT_STREQ(Error(Error::Kind::failed, "plate.exr: gone").what(), "plate.exr: gone");
}

}  // namespace
}  // namespace chromeball
