#include "core/base/process_threads.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <latch>
#include <thread>

namespace atrium {
namespace {

// how many threads are called `name`
std::ptrdiff_t count(const std::string& name) {
    std::error_code failure;
    const std::vector<ProcessThread> threads = process_threads(failure);
    EXPECT_FALSE(failure) << failure.message();
    return std::count_if(
        threads.begin(), threads.end(), [&](const auto& thread) { return thread.name == name; });
}

TEST(ProcessThreads, ListsThreadsWithNamesUntilTheyEnd) {
    EXPECT_EQ(count("counted"), 0);
    std::latch named(2);
    std::latch may_end(1);
    const auto wait = [&] {
        pthread_setname_np(pthread_self(), "counted");
        named.count_down();
        may_end.wait();
    };
    std::thread first(wait);
    std::thread second(wait);
    named.wait();
    EXPECT_EQ(count("counted"), 2);
    may_end.count_down();
    first.join();
    second.join();
    // the kernel lists a thread for a moment after it was joined
    while (count("counted") != 0) std::this_thread::yield();
}

TEST(ProcessThreads, ListsTheCallingThread) {
    std::error_code failure;
    const std::vector<ProcessThread> threads = process_threads(failure);
    ASSERT_FALSE(failure) << failure.message();
    EXPECT_TRUE(std::any_of(threads.begin(), threads.end(), [](const ProcessThread& thread) {
        return thread.id == gettid();
    }));
}

}  // namespace
}  // namespace atrium
