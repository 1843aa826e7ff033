#pragma once

#include "core/bus/messages.hpp"
#include "core/keys/member.hpp"
#include "world_server/description/rights.hpp"

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace atrium::world_server {

/// The right that a command or an edit needs; one of the first seven, as [rights] has them.
keys::Right right_for(bus::CommandKind kind);
keys::Right right_for(bus::EditKind kind);

/// Why `sender` may not do what needs `right`: neither the world file nor its key may forbid it.
/// `proven` is what the key allows (bus::SceneCommand::proven_rights). nullopt: it may.
std::optional<std::string> refusal(const Rights& rights,
                                   keys::Right right,
                                   const std::string& sender,
                                   const std::optional<keys::Rights>& proven);

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
