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

/// Writes states to the state file on its own thread. A newer state replaces one that waits.
/// Thread-safe, except for `run`.
class StateSaver {
public:
    explicit StateSaver(std::filesystem::path file) : file_(std::move(file)) {}

    /// True if the world has a state file.
    bool is_on() const { return !file_.empty(); }
    void put(SavedWorld world) { slot_.put(std::move(world)); }
    /// Body of the saving thread.
    void run(std::stop_token stop);
    /// Writes immediately and logs the result.
    Expected<void> save(const SavedWorld& world);
    std::uint64_t num_saves() const { return num_saves_; }

private:
    std::filesystem::path file_;
    LatestSlot<SavedWorld> slot_;
    std::atomic<std::uint64_t> num_saves_{0};
};

/// Loads the scene from `config.state_file`. Empty if there is no file. A file that is damaged, or
/// belongs to another world or version, is renamed; the error names the new file.
Expected<std::optional<Scene>> load_scene(const WorldServerConfig& config);

/// Returns the saved scene, or `described` if there is none. If the saved one is not usable, logs
/// the reason and returns `described`. Fails with kUnavailable if the file cannot be written.
Expected<Scene> start_scene(const WorldServerConfig& config, Scene described);

}  // namespace atrium::world_server
