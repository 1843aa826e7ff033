#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"

#include <filesystem>
#include <vector>

namespace atrium::viewer {

/// The worlds that the user joined last, newest first: name, domain and network. In a file of the
/// user.
class RecentWorlds {
public:
    static constexpr std::size_t kMax = 8;

    /// An empty `file` keeps them until the viewer ends. Logs a file that cannot be read and goes
    /// on without it.
    explicit RecentWorlds(std::filesystem::path file);

    /// Puts the world first. Error kUnavailable if the file cannot be written.
    Expected<void> add(const bus::BusOptions& world);
    /// Removes the world. Error kUnavailable if the file cannot be written.
    Expected<void> forget(const bus::BusOptions& world);
    const std::vector<bus::BusOptions>& list() const { return worlds_; }

private:
    Expected<void> save() const;

    std::filesystem::path file_;
    std::vector<bus::BusOptions> worlds_;
};

}  // namespace atrium::viewer
