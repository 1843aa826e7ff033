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
    using BackgroundSink = std::function<void(const image::YuvView&)>;

    virtual ~FrameSource() = default;

    virtual const config::Rig& rig() const = 0;

    /// True where every frame carries its silhouette, so that no background has to be learned.
    virtual bool has_silhouettes() const = 0;

    /// Shows the pictures of the empty room of one camera, one after another. Error kNotFound where
    /// there are none.
    virtual Expected<void> show_background(std::size_t camera, const BackgroundSink& sink) = 0;

    /// Delivers pictures at the source's rate until the stop or the end of the source. A frame
    /// without image says that a picture is lost; a picture of that time may still follow.
    virtual Expected<void> run(std::stop_token stop, const Sink& sink) = 0;

    /// What became of the pictures of each camera; empty where nothing can become of them.
    /// Thread-safe.
    virtual std::vector<CameraCounters> camera_counters() const { return {}; }
};

}  // namespace atrium::capture
