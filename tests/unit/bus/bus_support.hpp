#pragma once

#include "core/bus/bus.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace atrium::bus::testing {

/// A world that no other test and no other process uses.
inline BusOptions own_world(const std::string& name, std::uint32_t domain = 101) {
    BusOptions options;
    options.domain = domain;
    options.world = name + "-" + std::to_string(::getpid());
    return options;
}

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

/// A reader with everything that it received and every instance that it lost.
template <typename Message>
struct Listener {
    explicit Listener(const Participant& participant)
        : reader(value(Reader<Message>::create(participant))),
          waiter(value(Waiter::create(participant))) {
        waiter.add(reader);
    }

    void take() {
        const TakeReport report =
            reader.take([this](Message&& message) { samples.push_back(std::move(message)); },
                        [this](const Message& key, Ending how) {
                            gone.push_back(key);
                            endings.push_back(how);
                        });
        num_rejected += report.num_rejected;
        if (!report.first_rejection.empty()) first_rejection = report.first_rejection;
    }

    /// Takes everything that has arrived, and drops it.
    void forget() {
        take();
        samples.clear();
        gone.clear();
        endings.clear();
    }

    /// Takes samples until the condition holds. Returns false after the time limit.
    bool await(const std::function<bool()>& condition,
               std::chrono::milliseconds limit = std::chrono::seconds(10)) {
        const auto end = std::chrono::steady_clock::now() + limit;
        for (;;) {
            take();
            if (condition()) return true;
            const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
                end - std::chrono::steady_clock::now());
            if (left.count() <= 0) return false;
            waiter.wait(left);
        }
    }

    Reader<Message> reader;
    Waiter waiter;
    std::vector<Message> samples;
    std::vector<Message> gone;
    std::vector<Ending> endings;  // of each lost instance
    std::size_t num_rejected = 0;
    std::string first_rejection;
};

}  // namespace atrium::bus::testing
