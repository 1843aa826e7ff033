#include "core/base/two_stage_order.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>
#include <vector>

namespace atrium {
namespace {

using Order = TwoStageOrder<int, int>;

std::stop_token stopped() {
    std::stop_source source;
    source.request_stop();
    return source.get_token();
}

TEST(TwoStageOrder, PassesItemsOnInOrder) {
    Order order;
    for (int i = 1; i <= 3; ++i) {
        order.offer(i);
        const auto begun = order.begin({});
        ASSERT_TRUE(begun);
        EXPECT_EQ(begun->value, i);
        EXPECT_FALSE(begun->dropped);
        order.hand_over(10 * i);
        EXPECT_EQ(order.take({}), 10 * i);
    }
    EXPECT_EQ(order.num_dropped(), 0u);
}

TEST(TwoStageOrder, KeepsTheNewestBeforeTheFirstStage) {
    Order order;
    for (int i = 1; i <= 4; ++i) order.offer(i);
    EXPECT_EQ(order.num_dropped(), 3u);
    EXPECT_EQ(order.begin({})->value, 4);
    EXPECT_FALSE(order.begin(stopped()));
}

TEST(TwoStageOrder, DropsTheItemThatWaitsForTheSecondStageWhenANewerOneBegins) {
    Order order;
    order.offer(1);
    order.begin({});
    order.hand_over(1);
    EXPECT_EQ(order.take({}), 1);  // the second stage is busy from here on
    order.offer(2);
    order.begin({});
    order.hand_over(2);
    order.offer(3);
    EXPECT_EQ(order.num_dropped(), 0u) << "2 can still be taken";
    const auto begun = order.begin({});
    EXPECT_EQ(begun->value, 3);
    EXPECT_EQ(begun->dropped, 2) << "the dropped item must be returned for reuse";
    EXPECT_EQ(order.num_dropped(), 1u);
    order.hand_over(3);
    EXPECT_EQ(order.take({}), 3);
}

TEST(TwoStageOrder, CountsEverythingABusySecondStageDoesNotTake) {
    Order order;
    constexpr int kNumRounds = 2000;
    std::vector<int> taken;
    std::jthread second([&](std::stop_token stop) {
        while (const auto value = order.take(stop)) {
            taken.push_back(*value);
            if (*value == kNumRounds) return;
        }
    });
    for (int i = 1; i <= kNumRounds; ++i) {
        order.offer(i);
        EXPECT_EQ(order.begin({})->value, i);
        order.hand_over(i);
    }
    second.join();
    EXPECT_EQ(taken.size() + order.num_dropped(), static_cast<std::size_t>(kNumRounds));
}

TEST(TwoStageOrder, StopEndsBothStagesAfterPendingItemsAreTaken) {
    Order order;
    order.offer(1);
    EXPECT_TRUE(order.begin(stopped()));
    EXPECT_FALSE(order.begin(stopped()));
    order.hand_over(1);
    EXPECT_EQ(order.take(stopped()), 1);
    EXPECT_FALSE(order.take(stopped()));
    {
        std::jthread first([&](std::stop_token stop) { EXPECT_FALSE(order.begin(stop)); });
        std::jthread second([&](std::stop_token stop) { EXPECT_FALSE(order.take(stop)); });
    }
}

// Three threads with random pauses. Items are taken in order, the last one always. Every other item
// is taken or counted, and none follows a newer one.
TEST(TwoStageOrder, KeepsOrderAndCountsEveryLoss) {
    constexpr int kNumValues = 5000;
    for (unsigned seed = 0; seed < 3; ++seed) {
        Order order;
        std::vector<int> taken;
        std::atomic<int> newest_begun{0};
        const auto pause = [](std::mt19937& random) {
            std::atomic<std::uint64_t> steps{random() % 2048};
            while (steps > 0) --steps;
        };
        std::jthread second([&](std::stop_token stop) {
            std::mt19937 random(seed);
            while (const auto value = order.take(stop)) {
                taken.push_back(*value);
                pause(random);
                if (*value == kNumValues) return;
            }
        });
        std::jthread first([&](std::stop_token stop) {
            std::mt19937 random(seed + 100);
            while (const auto begun = order.begin(stop)) {
                EXPECT_GT(begun->value, newest_begun);
                if (begun->dropped) {
                    EXPECT_LT(*begun->dropped, begun->value);
                }
                newest_begun = begun->value;
                pause(random);
                order.hand_over(begun->value);
                if (begun->value == kNumValues) return;
            }
        });
        std::mt19937 random(seed + 200);
        for (int i = 1; i <= kNumValues; ++i) {
            order.offer(i);
            pause(random);
        }
        first.join();
        second.join();
        ASSERT_FALSE(taken.empty());
        EXPECT_EQ(taken.back(), kNumValues);
        for (std::size_t i = 1; i < taken.size(); ++i) ASSERT_LT(taken[i - 1], taken[i]);
        EXPECT_EQ(taken.size() + order.num_dropped(), static_cast<std::size_t>(kNumValues));
    }
}

}  // namespace
}  // namespace atrium
