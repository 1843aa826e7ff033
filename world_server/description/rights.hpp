#pragma once

#include "core/config/table_reader.hpp"

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
    Right edit;                                  // changing and placing objects
    Right save{.everyone = false, .names = {}};  // includes restoring, saved worlds
    double max_per_s = 200.0;                    // commands per sender; a dragging mouse sends 60
};

/// Reads `[rights]`. Each key is "everyone", "nobody" or a list of names.
void read_rights(config::TableReader& reader, Rights& rights);

}  // namespace atrium::world_server
