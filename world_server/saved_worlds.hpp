#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"
#include "world_server/scene.hpp"

#include <cstddef>
#include <filesystem>
#include <string>

namespace atrium::world_server {

/// The text of a world file of the scene as it is now: rigid objects where they are and at rest,
/// joined and soft ones at their start. The plain options are those of `config`; the path of
/// models is relative to `folder`.
std::string world_text(const WorldServerConfig& config,
                       const Scene& scene,
                       const std::filesystem::path& folder);

/// The folder in which a world server keeps saved worlds: one world file each, named after the
/// world. Names from the network cannot leave it. Not thread-safe.
class SavedWorldsFolder {
public:
    SavedWorldsFolder(std::filesystem::path folder, std::size_t max_worlds)
        : folder_(std::move(folder)), max_worlds_(max_worlds) {}

    bool is_on() const { return !folder_.empty(); }
    const std::filesystem::path& folder() const { return folder_; }
    /// Creates the folder if needed. kUnavailable with the reason if it cannot be written.
    Expected<void> open() const;
    /// Replaces the file of that world as a whole.
    Expected<void> save(const std::string& name, const std::string& text) const;
    /// Reads a saved world. Sites, rights and plain options stay those of `config`.
    Expected<WorldServerConfig> load(const std::string& name,
                                     const WorldServerConfig& config) const;
    /// Sorted by name; at most as many as a message may have.
    bus::SavedWorlds list(const std::string& world) const;

private:
    Expected<std::filesystem::path> file_of(const std::string& name) const;

    std::filesystem::path folder_;
    std::size_t max_worlds_;
};

}  // namespace atrium::world_server
