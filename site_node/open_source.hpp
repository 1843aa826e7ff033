#pragma once

#include "site_node/capture/frame_source.hpp"
#include "site_node/config.hpp"

#include <memory>
#include <stop_token>

namespace atrium::site_node {

/// The source that the configuration names, ready to run. What it has to say goes to the log.
Expected<std::unique_ptr<capture::FrameSource>> open_source(const SiteNodeConfig& config,
                                                            std::stop_token stop);

}  // namespace atrium::site_node
