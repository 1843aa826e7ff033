#pragma once

#include "core/recording/world_file.hpp"

#include <string>
#include <vector>

namespace atrium::recording {

/// A sample with the key of its instance.
struct KeyedSample {
    PlayedSample sample;
    std::string key;
};

/// What shows the world at `time`, from a recording: written in this order, these samples bring a
/// program that joins to where one that saw everything is. For each instance that is alive: the
/// last sample of what is kept, of states and of statuses; for each site the newest mesh whose
/// textures are all there, before its textures (a viewer that sees the end of the mesh before the
/// jump then forgets none of them). Samples of streams and statuses count for their
/// lifespan only (1 s and 2.5 s), as on the bus; commands never.
std::vector<KeyedSample> moment(const std::shared_ptr<const WorldFile>& world, Timestamp time);

}  // namespace atrium::recording
