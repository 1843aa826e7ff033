#pragma once

#include "core/bus/messages.hpp"
#include "core/config/table_reader.hpp"

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Who may ask for something.
struct Right {
    bool everyone = true;
    std::vector<std::string> names;  // where not everyone: these; none: nobody

    bool allows(const std::string& sender) const;
};

/// What the world's file allows to whom. A sender is who it says it is: its name is unique in the
/// world, but nobody proves it.
struct Rights {
    Right add;
    Right remove;
    Right reset;
    Right push;
    Right grab;                                  // and to move and release what one holds
    Right save{.everyone = false, .names = {}};  // and to restore
    double max_per_s = 200.0;  // commands of one sender: a mouse that drags sends 60

    const Right& of(bus::CommandKind kind) const;
};

const char* to_string(bus::CommandKind kind);

/// Reads `[rights]`: each key is "everyone", "nobody" or a list of names.
void read_rights(config::TableReader& reader, Rights& rights);

/// Holds every sender to so many commands a second, in bursts of half of that. Not thread-safe.
class CommandRates {
public:
    using Clock = std::chrono::steady_clock;

    explicit CommandRates(double max_per_s) : max_per_s_(max_per_s) {}
    /// False: this one is too many.
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
