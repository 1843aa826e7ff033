#pragma once

#include "site_node/capture/frame_source.hpp"
#include "site_node/config.hpp"

#include <memory>
#include <stop_token>

namespace atrium::site_node {

/// Opens the frame source that the configuration names. Progress and warnings go to the log.
Expected<std::unique_ptr<capture::FrameSource>> open_source(const SiteNodeConfig& config,
                                                            std::stop_token stop);

}  // namespace atrium::site_node
