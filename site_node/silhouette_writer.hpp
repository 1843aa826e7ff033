#pragma once

#include "site_node/config.hpp"

#include <stop_token>

namespace atrium::site_node {

/// Writes what the site makes of the pictures of a recording (`config.capture.recording`), each
/// metaframe exactly once, into `config.write_silhouettes`: `<camera>/silhouettes/%06d.png`, and
/// the polygons of all cameras as `views/%06d.json` in the format that `visual_hull` reads.
/// Silhouettes of the recording itself are not used.
///
/// A picture that is missing leaves its camera out of that metaframe. Error kConfiguration where
/// the folder holds something and `config.overwrite` is false. A stop is no error.
Expected<void> write_silhouettes(const SiteNodeConfig& config, std::stop_token stop);

}  // namespace atrium::site_node
