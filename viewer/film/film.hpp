#pragma once

#include "core/base/expected.hpp"
#include "viewer/config/viewer_config.hpp"

#include <stop_token>

namespace atrium::viewer {

/// Renders a recording into the video of the configuration: every picture, at its own time, however
/// long it takes; along the camera path of the configuration, if it names one. Logs the progress.
/// After a stop the video ends there, playable.
Expected<void> render_film(const ViewerConfig& config, std::stop_token stop);

}  // namespace atrium::viewer
