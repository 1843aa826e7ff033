#pragma once

#include "core/bus/messages.hpp"
#include "world_server/description/rights.hpp"

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

namespace atrium::world_server {

/// Returns the right that a command or an edit needs.
const Right& right_to(const Rights& rights, bus::CommandKind kind);

const Right& right_to(const Rights& rights, bus::EditKind kind);

/// Returns the key of that right in the world file.
const char* right_name(bus::CommandKind kind);
const char* right_name(bus::EditKind kind);

const char* to_string(bus::CommandKind kind);
const char* to_string(bus::EditKind kind);

/// Limits the commands per second of each sender, with bursts of half of that number. Not
/// thread-safe.
class CommandRates {
public:
    using Clock = std::chrono::steady_clock;

    explicit CommandRates(double max_per_s) : max_per_s_(max_per_s) {}
    /// Counts a command. False if it exceeds the limit.
    bool admit(const std::string& sender, Clock::time_point now);
    void forget(const std::string& sender) { budgets_.erase(sender); }
    std::size_t num_senders() const { return budgets_.size(); }

private:
    struct Budget {
        double commands = 0.0;
        Clock::time_point counted;
    };
    double max_per_s_;
    std::map<std::string, Budget> budgets_;
};

}  // namespace atrium::world_server
