#include "shot/workers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "core/error.h"

namespace chromeball {
namespace {

TEST(Workers, DoEveryFrameOnceAndTellHowMany) {
    for (const int jobs : {1, 2, 7}) {
        std::vector<std::atomic<int>> done(50);
        std::size_t told = 0;
        for_each_frame(
            50, jobs, [&](std::size_t i) { ++done[i]; }, {},
            [&](std::size_t count) { EXPECT_EQ(count, ++told); });
        for (const auto& count : done) EXPECT_EQ(count, 1);
        EXPECT_EQ(told, 50U);
    }
    for_each_frame(0, 2, [](std::size_t) { ADD_FAILURE(); }, {});
}

TEST(Workers, AreNoMoreThanAskedFor) {
    std::atomic<int> now{0}, most{0};
    for_each_frame(20, 3,
                   [&](std::size_t) {
                       const int running = ++now;
                       for (int seen = most;
                            running > seen && !most.compare_exchange_weak(seen, running);) {
                       }
                       std::this_thread::sleep_for(std::chrono::milliseconds(2));
                       --now;
                   },
                   {});
    EXPECT_LE(most, 3);
    EXPECT_GE(most, 2);
}

TEST(Workers, EndWithTheFirstError) {
    std::atomic<int> begun{0};
    try {
        for_each_frame(1000, 2,
                       [&](std::size_t i) {
                           ++begun;
                           if (i == 3) throw Error(Error::Kind::failed, "full");
                       },
                       {});
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_STREQ(e.what(), "full");
    }
    EXPECT_LT(begun, 1000);
}

TEST(Workers, StopWhenAskedTo) {
    std::atomic<bool> stop{false};
    int begun = 0;
    try {
        for_each_frame(1000, 1, [&](std::size_t) { stop = ++begun == 5; }, {&stop, nullptr});
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), Error::Kind::interrupted);
    }
    EXPECT_EQ(begun, 5);
}

}  // namespace
}  // namespace chromeball
