#pragma once

#include "core/base/timestamp.hpp"
#include "core/presence/membership.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <thread>

namespace atrium::bench {

/// Prints "knows NS", the time at which this program knew of this many programs, including itself,
/// accurate to 20 ms. Then it costs nothing. With 0 members it prints nothing.
class SayWhenAllAreThere {
public:
    SayWhenAllAreThere(const presence::Membership& membership, std::size_t num_members)
        : thread_([&membership, num_members](std::stop_token stop) {
              if (num_members == 0) return;
              while (!stop.stop_requested() && membership.present().size() < num_members)
                  std::this_thread::sleep_for(std::chrono::milliseconds(20));
              fmt::print("knows {}\n", Timestamp::now().ns);
              std::fflush(stdout);
          }) {}

private:
    std::jthread thread_;
};

}  // namespace atrium::bench
