#pragma once

#include "core/bus/messages.hpp"
#include "core/config/table_reader.hpp"

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace atrium::world_server {

/// The senders that may use a command.
struct Right {
    bool everyone = true;
    std::vector<std::string> names;  // used if not everyone; empty: nobody

    bool allows(const std::string& sender) const;
};

/// Rights of senders according to the world file. Senders are not authenticated: their names are
/// unique in the world, but unproven.
struct Rights {
    Right add;
    Right remove;
    Right reset;
    Right push;
    Right grab;                                  // includes moving and releasing held objects
    Right save{.everyone = false, .names = {}};  // includes restoring
    double max_per_s = 200.0;                    // commands per sender; a dragging mouse sends 60

    const Right& of(bus::CommandKind kind) const;
};

const char* to_string(bus::CommandKind kind);

/// Reads `[rights]`. Each key is "everyone", "nobody" or a list of names.
void read_rights(config::TableReader& reader, Rights& rights);

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
