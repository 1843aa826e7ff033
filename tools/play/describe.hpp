#pragma once

#include "core/recording/world_file.hpp"

#include <string>

namespace atrium::play {

/// What a recording has, for people: length, sites, programs, topics with counts and rates, damage.
/// Several lines.
std::string describe(const recording::WorldFile& world);
/// The same as one line of JSON.
std::string describe_json(const recording::WorldFile& world);

}  // namespace atrium::play
