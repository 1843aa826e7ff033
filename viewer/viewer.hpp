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
    /// When the surface is opened. A window or GL context belongs to one thread: kOpenedNow saves
    /// time, but `create`, `run` and the destructor are called on the same thread then.
    enum class SurfaceIs { kOpenedNow, kOpenedByRun };

    /// Checks the configuration and joins the world.
    static Expected<std::unique_ptr<Viewer>> create(const ViewerConfig& config,
                                                    std::stop_token stop = {},
                                                    SurfaceIs surface_is = SurfaceIs::kOpenedByRun);
    ~Viewer();

    /// Shows the world until `stop`, or until `frames` or `seconds` are over or the window is
    /// closed; then writes `output` and finishes the video. The calling thread draws (with a
    /// window: the main thread); others are started, see docs/architecture.md.
    Expected<void> run(std::stop_token stop);

    /// The figures as they are now; any thread.
    bus::ViewerStatus status() const;

private:
    struct Impl;
    explicit Viewer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::viewer
