#pragma once

#include "core/base/latest_slot.hpp"
#include "world_server/config.hpp"
#include "world_server/scene.hpp"
#include "world_server/state_file.hpp"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <stop_token>

namespace atrium::world_server {

/// Writes states to the world's file on a thread of its own; a newer state replaces one that waits.
/// Thread-safe but for `run`.
class StateSaver {
public:
    explicit StateSaver(std::filesystem::path file) : file_(std::move(file)) {}

    /// Whether the world has a file at all.
    bool is_on() const { return !file_.empty(); }
    void put(SavedWorld world) { slot_.put(std::move(world)); }
    /// The body of the thread.
    void run(std::stop_token stop);
    /// Writes at once; logs what came of it.
    Expected<void> save(const SavedWorld& world);
    std::uint64_t num_saves() const { return num_saves_; }

private:
    std::filesystem::path file_;
    LatestSlot<SavedWorld> slot_;
    std::atomic<std::uint64_t> num_saves_{0};
};

/// The scene that `config.state_file` holds. Nothing where the file is not there; one that is
/// damaged, or of another world or version, is put aside, which is an error that says where.
Expected<std::optional<Scene>> load_scene(const WorldServerConfig& config);

/// As it was saved, or else, with the reason in the log, as it is `described`. Fails where the file
/// could not be written (kUnavailable).
Expected<Scene> start_scene(const WorldServerConfig& config, Scene described);

}  // namespace atrium::world_server
