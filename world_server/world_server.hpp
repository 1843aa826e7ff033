#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"

#include <memory>
#include <stop_token>

namespace atrium::world_server {

/// Runs one shared world: receives the people of all sites and all commands from the bus, simulates
/// in real time, and publishes the state.
///
/// `run` uses four threads: receiving, simulating (the caller's), publishing, and writing the state
/// file. Up to four workers, started on demand, decode and prepare meshes. Every hand-over between
/// threads keeps only the newest item of each site, object or state. Only commands queue up, in
/// bounded number.
class WorldServer {
public:
    /// Builds the world, restored from its state file if there is one, and joins the bus. Fails if
    /// the world already has a server. Publishes nothing before `run`.
    static Expected<std::unique_ptr<WorldServer>> create(const WorldServerConfig& config,
                                                         std::stop_token stop = {});
    ~WorldServer();
    WorldServer(const WorldServer&) = delete;
    WorldServer& operator=(const WorldServer&) = delete;

    /// Runs until a stop is requested or `config.seconds` have passed. Ends with an error if an
    /// older server of the same world is found. Call once.
    Expected<void> run(std::stop_token stop);

    /// Returns the current status, as it would be published. Thread-safe.
    bus::WorldStatus status() const;

private:
    struct Impl;
    explicit WorldServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::world_server
