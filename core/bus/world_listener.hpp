#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <memory>
#include <string>
#include <vector>

namespace atrium::bus {

/// A program that is present in a world.
struct HeardProgram {
    std::string world;
    Presence presence;
};

/// Hears the programs of all worlds of one DDS domain on one network, without joining any of them.
/// With keys it hears those of their world only, and without keys none of worlds with keys. Not
/// heard: other domains, hosts that the network file does not reach, and programs of a version
/// whose Presence has another type.
class WorldListener {
public:
    /// Ignores `options.world`. Errors: see Participant::create.
    static Expected<WorldListener> create(const BusOptions& options);

    /// Takes what has arrived and returns all programs present, of at most 4096. Never blocks. One
    /// thread at a time.
    std::vector<HeardProgram> heard();

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

}  // namespace atrium::bus
