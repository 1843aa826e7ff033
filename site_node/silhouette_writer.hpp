#pragma once

#include "site_node/config.hpp"

#include <stop_token>

namespace atrium::site_node {

/// Segments every metaframe of a recording (`config.capture.recording`) once. Writes masks as
/// `<camera>/silhouettes/%06d.png` and the polygons of all cameras as `views/%06d.json`, the format
/// that `visual_hull` reads, into `config.write_silhouettes`. Ignores silhouettes that the
/// recording itself has.
///
/// A metaframe lacks every camera whose picture is missing. Error kConfiguration if the folder is
/// not empty and `config.overwrite` is false. A stop is not an error.
Expected<void> write_silhouettes(const SiteNodeConfig& config, std::stop_token stop);

}  // namespace atrium::site_node
