#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"

#include <memory>
#include <stop_token>

namespace atrium::world_server {

/// One shared world: takes the people of all sites and everybody's commands from the bus, simulates
/// in real time, and publishes where things are.
///
/// `run` uses four threads: one receives, one (the caller's) simulates, one publishes, one writes
/// the world's file. Up to four workers, started when they are needed, decode and prepare meshes.
/// Every hand-over keeps the newest of each site, object or state; only commands queue up, a
/// bounded number of them.
class WorldServer {
public:
    /// Builds the world, as its file has it where there is one, and joins the bus; fails where the
    /// world has a server. The world is heard from once `run` is called.
    static Expected<std::unique_ptr<WorldServer>> create(const WorldServerConfig& config,
                                                         std::stop_token stop = {});
    ~WorldServer();
    WorldServer(const WorldServer&) = delete;
    WorldServer& operator=(const WorldServer&) = delete;

    /// Until a stop is requested, `config.seconds` have passed, or an older server of the same
    /// world is found, which is an error. Call once.
    Expected<void> run(std::stop_token stop);

    /// As last published, but of now. Thread-safe.
    bus::WorldStatus status() const;

private:
    struct Impl;
    explicit WorldServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::world_server
