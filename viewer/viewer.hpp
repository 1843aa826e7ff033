#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/ui/surface.hpp"

#include <memory>
#include <stop_token>

namespace atrium::viewer {

/// The whole viewer: bus, decoding, drawing, files.
class Viewer {
public:
    /// When the surface is opened. A window or GL context belongs to one thread: kOpenedNow saves
    /// time, but then `create`, `run` and the destructor must be called on the same thread.
    enum class SurfaceIs { kOpenedNow, kOpenedByRun };

    /// Checks the configuration and joins the world. Uses `surface`, if given, instead of one of
    /// its own.
    static Expected<std::unique_ptr<Viewer>> create(const ViewerConfig& config,
                                                    std::stop_token stop = {},
                                                    SurfaceIs surface_is = SurfaceIs::kOpenedByRun,
                                                    std::unique_ptr<Surface> surface = nullptr);
    ~Viewer();

    /// Shows the world until `stop`, until `frames` or `seconds` are over, or until the window is
    /// closed. Then writes `output` and finishes the video. Draws on the calling thread (with a
    /// window: the main thread) and starts the others, see docs/architecture.md.
    Expected<void> run(std::stop_token stop);

    /// After `run`: the surface, if the user asked for another world; else null.
    std::unique_ptr<Surface> take_surface();

    /// Before `run` with kOpenedNow: whether there is a window.
    bool has_window() const;
    /// Whether a world server or a site was heard in the world.
    bool has_met_others() const;
    /// Current status. Any thread.
    bus::ViewerStatus status() const;

private:
    struct Impl;
    explicit Viewer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::viewer
