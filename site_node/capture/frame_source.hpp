#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/metaframe.hpp"

#include <filesystem>
#include <functional>
#include <stop_token>
#include <vector>

namespace atrium::capture {

/// Source of pictures: a simulated room, a recording or cameras.
///
/// Used by one thread at a time. `run` delivers in real time: its sink must hand over the frame and
/// return.
class FrameSource {
public:
    using Sink = std::function<void(CameraFrame)>;
    /// Receives a picture of the empty room; returns false once it needs no more of this camera.
    using BackgroundSink = std::function<bool(std::size_t camera, const image::YuvView&)>;

    virtual ~FrameSource() = default;

    virtual const config::Rig& rig() const = 0;

    /// True if every frame carries its silhouette; then no background is needed.
    virtual bool has_silhouettes() const = 0;

    /// True if the pictures show a real room at this moment, without end.
    virtual bool is_live() const { return false; }

    /// False if there are no pictures of the empty room of this camera.
    virtual bool has_empty_room(std::size_t /*camera*/) const { return true; }

    /// Folder with the rooms that a site knew when it recorded these pictures: with them the same
    /// masks are found. Empty: there is none.
    virtual std::filesystem::path learned_rooms() const { return {}; }

    /// Number of instants that `read_picture` can read, in any order; 0: only `run` shows them. The
    /// last ones may be missing.
    virtual std::size_t num_frames() const { return 0; }

    /// Number of instants after which `run` repeats itself, all readable by `read_picture`; 0: it
    /// does not.
    virtual std::size_t loop_length() const { return num_frames(); }

    /// Of `num_frames`, the number that `run` has passed. Thread-safe.
    virtual std::size_t num_passed() const { return 0; }

    /// Reads picture `index` of one camera. An error if it is missing or unreadable. Threads may
    /// read different cameras at the same time.
    virtual Expected<CameraFrame> read_picture(std::size_t camera, std::size_t index);

    /// Shows pictures of the empty room of `cameras`, which must be distinct: live cameras in
    /// parallel, others one after the other. Ends when the sink has enough of all, when no picture
    /// is left, or at once with a stop. Returns one result per entry of `cameras`: kNotFound
    /// without any picture, kUnavailable if pictures cease or the stop comes first.
    virtual std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                        const BackgroundSink& sink,
                                                        std::stop_token stop) = 0;

    /// Delivers pictures at the rate of the source until the stop or the end of the source. A frame
    /// without image reports a lost picture; a picture of the same time may still follow.
    virtual Expected<void> run(std::stop_token stop, const Sink& sink) = 0;

    /// Returns the counts of each camera in rig order; empty if the source does not count.
    /// Thread-safe.
    virtual std::vector<CameraCounters> camera_counters() const { return {}; }
};

/// Implements `show_background` for sources that show one camera after the other. `show(camera)`
/// shows one camera until its sink has enough.
std::vector<Expected<void>> one_after_another(
    const std::vector<std::size_t>& cameras,
    const std::function<Expected<void>(std::size_t camera)>& show,
    const std::stop_token& stop);

}  // namespace atrium::capture
