#pragma once

#include "core/base/expected.hpp"
#include "site_node/views/named_view.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::hull_tool {

/// Loads the silhouettes of one frame of a recording: its masks if it has any, else segmented
/// against its pictures of the empty room. Cameras in `without` need no pictures: their views are
/// empty. Errors name the missing part.
Expected<std::vector<views::NamedView>> load_recording_views(
    const std::filesystem::path& folder,
    std::size_t frame,
    const std::vector<std::string>& without);

}  // namespace atrium::hull_tool
