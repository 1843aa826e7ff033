#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "viewer/viewer_config.hpp"

#include <memory>
#include <stop_token>

namespace atrium::viewer {

/// A whole viewer: bus, decoding, drawing, files.
class Viewer {
public:
    /// Checks the configuration and joins the world. Opens no window yet.
    static Expected<std::unique_ptr<Viewer>> create(const ViewerConfig& config,
                                                    std::stop_token stop = {});
    ~Viewer();

    /// Shows the world until `stop`, or until `frames` or `seconds` are over or the window is
    /// closed; then writes `output` and finishes the video. The calling thread draws (with a
    /// window: the main thread); two more are started, and one for a video.
    Expected<void> run(std::stop_token stop);

    /// The figures as they are now; any thread.
    bus::ViewerStatus status() const;

private:
    struct Impl;
    explicit Viewer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::viewer
