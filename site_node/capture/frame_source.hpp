#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/capture/camera_counters.hpp"
#include "site_node/capture/metaframe.hpp"

#include <functional>
#include <stop_token>
#include <vector>

namespace atrium::capture {

/// Where pictures come from: a simulated room, a recording, cameras.
///
/// One thread at a time. `run` delivers in real time and must never be held up: a sink only hands
/// over.
class FrameSource {
public:
    using Sink = std::function<void(CameraFrame)>;
    /// Takes a picture of the empty room; false: these are enough of this camera.
    using BackgroundSink = std::function<bool(std::size_t camera, const image::YuvView&)>;

    virtual ~FrameSource() = default;

    virtual const config::Rig& rig() const = 0;

    /// True where every frame carries its silhouette, so that no background has to be learned.
    virtual bool has_silhouettes() const = 0;

    /// True where the empty room is shown for as long as somebody looks, and seen as it is now.
    virtual bool is_live() const { return false; }

    /// Shows pictures of the empty room of `cameras`, different ones: live cameras at the same
    /// time, others one after another. Ends once the sink has enough of all, nothing is left to be
    /// shown, or at once with a stop. One result for each of `cameras`: kNotFound where there are
    /// no pictures, kUnavailable where none come any more, or the stop came before its end.
    virtual std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                        const BackgroundSink& sink,
                                                        std::stop_token stop) = 0;

    /// Delivers pictures at the source's rate until the stop or the end of the source. A frame
    /// without image says that a picture is lost; a picture of that time may still follow.
    virtual Expected<void> run(std::stop_token stop, const Sink& sink) = 0;

    /// What became of the pictures of each camera, in the order of the rig; empty where nobody
    /// counts. Thread-safe.
    virtual std::vector<CameraCounters> camera_counters() const { return {}; }
};

/// `show_background` for those who show one camera after another: `show(camera)` does so for one,
/// and ends with its sink.
std::vector<Expected<void>> one_after_another(
    const std::vector<std::size_t>& cameras,
    const std::function<Expected<void>(std::size_t camera)>& show,
    const std::stop_token& stop);

}  // namespace atrium::capture
