#include "core/base/keyed_workers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <latch>
#include <memory>
#include <random>
#include <semaphore>

namespace atrium {
namespace {

TEST(KeyedWorkers, HandlesAKeyInOrderAndOneValueAtATime) {
    constexpr std::size_t kKeys = 7;
    constexpr int kProducers = 3;
    constexpr int kPuts = 20'000;
    for (const std::size_t max_threads : {1, 2, 4}) {
        struct Key {
            std::atomic<bool> is_busy = false;
            std::array<int, kProducers> last{};  // of each producer: its values are in order
        };
        std::array<Key, kKeys> keys;
        std::atomic<bool> is_right = true;
        std::atomic<int> num_handled = 0;
        std::atomic<int> num_now = 0;
        using Value = std::pair<int, int>;  // producer, number
        KeyedWorkers<Value> sut(
            "test", max_threads, [&](const std::string& name, Value value, std::size_t worker) {
                Key& key = keys.at(static_cast<std::size_t>(name.front() - 'a'));
                if (key.is_busy.exchange(true)) is_right = false;
                if (static_cast<std::size_t>(++num_now) > max_threads) is_right = false;
                if (worker >= max_threads) is_right = false;
                int& last = key.last.at(static_cast<std::size_t>(value.first));
                if (value.second <= last) is_right = false;
                last = value.second;
                --num_now;
                ++num_handled;
                key.is_busy = false;
            });
        std::atomic<int> num_replaced = 0;
        {
            std::vector<std::jthread> producers;
            for (int producer = 0; producer < kProducers; ++producer) {
                producers.emplace_back([&, producer] {
                    std::mt19937 random(static_cast<unsigned>(producer));
                    for (int i = 1; i <= kPuts; ++i) {
                        const std::string name(1, static_cast<char>('a' + random() % kKeys));
                        if (sut.put(name, {producer, i})) ++num_replaced;
                    }
                });
            }
        }
        // every value is either replaced or handled, without a further `put`
        while (num_handled + num_replaced < kProducers * kPuts) std::this_thread::yield();
        EXPECT_TRUE(is_right);
        EXPECT_EQ(num_handled + num_replaced, kProducers * kPuts);
        EXPECT_LE(sut.num_threads(), max_threads);
    }
}

TEST(KeyedWorkers, ReplacesTheWaitingValueByANewerOne) {
    std::binary_semaphore began(0);
    std::binary_semaphore go_on(0);
    std::vector<int> handled;
    KeyedWorkers<int> sut("test", 2, [&](const std::string&, int value, std::size_t) {
        handled.push_back(value);
        began.release();
        go_on.acquire();
    });
    EXPECT_FALSE(sut.put("a", 1));
    began.acquire();
    EXPECT_FALSE(sut.put("a", 2)) << "the value waits although a thread was available";
    EXPECT_EQ(sut.put("a", 3), 2);
    EXPECT_EQ(sut.num_threads(), 1U);
    go_on.release();
    began.acquire();
    go_on.release();
    sut.stop();
    EXPECT_EQ(handled, (std::vector{1, 3}));
}

TEST(KeyedWorkers, HandlesDifferentKeysInParallel) {
    std::latch both(2);
    std::counting_semaphore<2> done(0);
    KeyedWorkers<int> sut("test", 2, [&](const std::string&, int, std::size_t) {
        both.arrive_and_wait();
        done.release();
    });
    sut.put("a", 1);
    sut.put("b", 1);
    done.acquire();
    done.acquire();
    EXPECT_EQ(sut.num_threads(), 2U);
}

TEST(KeyedWorkers, StartsNoMoreThreadsThanAllowedForManyKeys) {
    constexpr int kKeys = 500;
    std::atomic<int> num_handled = 0;
    KeyedWorkers<int> sut("test", 3, [&](const std::string&, int, std::size_t) { ++num_handled; });
    EXPECT_EQ(sut.num_threads(), 0U);
    for (int i = 0; i < kKeys; ++i) EXPECT_FALSE(sut.put("site " + std::to_string(i), i));
    while (num_handled < kKeys) std::this_thread::yield();
    EXPECT_LE(sut.num_threads(), 3U);
}

TEST(KeyedWorkers, BusyKeyDoesNotStarveAnother) {
    std::binary_semaphore began(0);
    std::binary_semaphore go_on(0);
    std::vector<std::string> handled;
    KeyedWorkers<int> sut("test", 1, [&](const std::string& key, int, std::size_t) {
        handled.push_back(key);
        began.release();
        go_on.acquire();
    });
    sut.put("a", 1);
    began.acquire();
    sut.put("b", 1);
    sut.put("a", 2);  // all the time
    for (int i = 0; i < 3; ++i) {
        sut.put("a", 3 + i);
        go_on.release();
        if (i < 2) began.acquire();
    }
    began.acquire();
    go_on.release();
    sut.stop();
    ASSERT_GE(handled.size(), 2U);
    EXPECT_EQ(handled[1], "b");
}

TEST(KeyedWorkers, StopWaitsForHandlersAndDropsWaitingValues) {
    std::binary_semaphore began(0);
    std::atomic<bool> is_finished = false;
    std::atomic<int> num_handled = 0;
    KeyedWorkers<std::unique_ptr<int>> sut(
        "test", 1, [&](const std::string&, std::unique_ptr<int> value, std::size_t) {
            EXPECT_EQ(*value, 1);
            began.release();
            ++num_handled;
            is_finished = true;
        });
    sut.stop();
    EXPECT_TRUE(sut.put("a", std::make_unique<int>(1))) << "put after stop is not handled";

    std::atomic<bool> is_replaced = false;
    KeyedWorkers<int> busy("test", 1, [&](const std::string&, int, std::size_t) {
        began.release();
        // blocks until the others wait
        while (!is_replaced) std::this_thread::yield();
        is_finished = true;
        ++num_handled;
    });
    busy.put("a", 1);
    began.acquire();
    busy.put("b", 1);
    is_replaced = busy.put("b", 2).has_value();
    busy.stop();
    EXPECT_TRUE(is_finished);
    EXPECT_LE(num_handled, 2) << "more than the newest value of b was handled";
    EXPECT_EQ(busy.num_threads(), 0U);
}

}  // namespace
}  // namespace atrium
