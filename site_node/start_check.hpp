#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/config.hpp"

namespace atrium::site_node {

/// Checks that the files and folders that the configuration names exist, and that what this run
/// writes fits on its disk. Errors name key, file and line.
Expected<void> check_places(const SiteNodeConfig& config);

/// Loads the rig of the source, without opening the source: that may take minutes. Judgements about
/// it go to the log; what makes any hull impossible is an error.
Expected<config::Rig> load_checked_rig(const SiteNodeConfig& config);

/// Checks the description of a site as a whole: options, places, rig, hosts, regions. Opens no
/// source. Returns the rig.
Expected<config::Rig> load_checked_description(const SiteNodeConfig& config);

/// Completes the hull's bounds from the rig, unless the configuration has its own or regions.
void take_bounds(const config::Rig& rig, HullStageOptions& hull);

}  // namespace atrium::site_node
