#pragma once

#include "core/base/expected.hpp"
#include "site_node/silhouette_stage/silhouette_stage_options.hpp"
#include "site_node/views/named_view.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::hull_tool {

/// Reads `[segmentation]` and `[silhouette]` of a site file; an empty path gives the defaults.
/// Ignores the other tables.
Expected<site_node::SilhouetteStageOptions> read_silhouette_options(
    const std::filesystem::path& file);

/// Loads the silhouettes of one frame of a recording: its masks if it has any, else segmented
/// against the empty room, as site_node does. Cameras in `without` need no pictures: their views
/// are empty. Errors name the missing part.
Expected<std::vector<views::NamedView>> load_recording_views(
    const std::filesystem::path& folder,
    std::size_t frame,
    const std::vector<std::string>& without,
    const site_node::SilhouetteStageOptions& options = {});

}  // namespace atrium::hull_tool
