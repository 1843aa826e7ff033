#pragma once

#include "core/config/table_reader.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace atrium::world_server {

/// The senders that may use a command.
struct Right {
    bool everyone = true;
    std::vector<std::string> names;  // used if not everyone; empty: nobody

    bool allows(const std::string& sender) const;
};

/// Rights of senders according to the world file. In a world with keys the names are proven; in one
/// without they are unique, but anybody may take any of them.
struct Rights {
    Right add;
    Right remove;
    Right reset;
    Right push;
    Right grab;                                  // includes moving and releasing held objects
    Right edit;                                  // changing and placing objects
    Right save{.everyone = false, .names = {}};  // includes restoring, saved worlds
    double max_per_s = 200.0;                    // commands per sender; a dragging mouse sends 60
};

/// The keys of `[rights]` that say who may do something.
inline constexpr std::array<std::pair<const char*, Right Rights::*>, 7> kRights{{
    {"add", &Rights::add},
    {"remove", &Rights::remove},
    {"reset", &Rights::reset},
    {"push", &Rights::push},
    {"grab", &Rights::grab},
    {"edit", &Rights::edit},
    {"save", &Rights::save},
}};

/// Reads `[rights]`. Each key is "everyone", "nobody" or a list of names.
void read_rights(config::TableReader& reader, Rights& rights);

}  // namespace atrium::world_server
