#pragma once

#include "core/bus/world_listener.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace atrium::presence {

/// A world and who is in it.
struct HeardWorld {
    std::string name;
    std::vector<std::string> servers;  // hosts of its world servers; usually one
    std::vector<std::string> sites;    // names
    std::size_t num_viewers = 0;
    std::size_t num_others = 0;
};

/// Groups programs by world, in the order of the names. Counts only programs that hold their name.
std::vector<HeardWorld> worlds_of(std::span<const bus::HeardProgram> programs);

/// "world server on lab, 2 sites: alice, bob; 1 viewer". Lists at most 8 sites.
std::string describe(const HeardWorld& world);

}  // namespace atrium::presence
