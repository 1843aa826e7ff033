#pragma once

#include "viewer/config/viewer_config.hpp"

#include <stop_token>

namespace atrium::viewer {

/// Runs the viewer as the user started it and returns the exit code of the program. Without a world
/// in `config`: lets the user choose one on the start screen; without a display, prints the worlds
/// heard; a run that needs no user (headless, frames, a picture or video, a wall) joins "atrium".
/// Main thread.
int run_viewer(ViewerConfig config, std::stop_token stop);

}  // namespace atrium::viewer
