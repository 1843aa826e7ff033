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
/// `run` uses three threads: one receives and turns meshes into shapes, one (the caller's)
/// simulates, one publishes. Every hand-over keeps the newest of each site, object or state; only
/// commands queue up, a bounded number of them.
class WorldServer {
public:
    /// Joins the bus and builds the world. The world is heard from once `run` is called.
    static Expected<std::unique_ptr<WorldServer>> create(const WorldServerConfig& config);
    ~WorldServer();
    WorldServer(const WorldServer&) = delete;
    WorldServer& operator=(const WorldServer&) = delete;

    /// Until a stop is requested, or `config.seconds` have passed. Call once.
    Expected<void> run(std::stop_token stop);

    /// As last published, but of now. Thread-safe.
    bus::WorldStatus status() const;

private:
    struct Impl;
    explicit WorldServer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::world_server
