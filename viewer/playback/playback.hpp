#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/recording/player.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/control/playback_events.hpp"
#include "viewer/playback/thumbnails.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

namespace atrium::viewer {

/// A recording that the viewer shows: plays it on a bus of this process alone, from which the
/// viewer receives it like a living world.
class Playback {
public:
    /// Opens the recording and logs what is wrong with it. `options` becomes the private bus.
    /// `path`: file of the camera path to which keys are added; empty: FILE.path.json.
    static Expected<std::unique_ptr<Playback>> open(const std::filesystem::path& file,
                                                    const std::filesystem::path& path,
                                                    bus::BusOptions& options);

    /// Plays to the participant's world; paused if the user is to begin.
    Expected<void> start(const bus::Participant& participant, const RecordingConfig& config);
    /// Ends playing. Call it before the participant's session ends.
    void stop();

    /// Does what the user wants. Returns a message for the user; empty: the picture tells.
    /// `camera`: the viewpoint now.
    std::string apply(const PlaybackEvent& event, const renderer::ViewCamera& camera);
    recording::PlayState state() const;
    /// From `start` on.
    const Thumbnails& thumbnails() const { return *thumbnails_; }
    const recording::WorldFile& world() const { return *world_; }
    /// Shared, for those who play it themselves.
    const std::shared_ptr<const recording::WorldFile>& file() const { return world_; }

private:
    Playback(std::shared_ptr<const recording::WorldFile> world, std::filesystem::path path)
        : world_(std::move(world)), path_file_(std::move(path)) {}
    std::string keep_view(std::chrono::nanoseconds time, const renderer::ViewCamera& camera);

    std::shared_ptr<const recording::WorldFile> world_;
    std::unique_ptr<recording::Player> player_;
    std::unique_ptr<Thumbnails> thumbnails_;
    std::filesystem::path path_file_;
    std::jthread playing_;  // last: uses the player
};

}  // namespace atrium::viewer
