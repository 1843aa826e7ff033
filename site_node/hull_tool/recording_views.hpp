#pragma once

#include "core/base/expected.hpp"
#include "site_node/hull_tool/named_view.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::hull_tool {

/// Silhouettes of one frame of a recording: from its masks where it has some, else by the
/// background that its pictures of the empty room teach. The pictures of cameras in `without` are
/// not needed: their views are empty. Errors name what is missing.
Expected<std::vector<NamedView>> load_recording_views(const std::filesystem::path& folder,
                                                      std::size_t frame,
                                                      const std::vector<std::string>& without);

}  // namespace atrium::hull_tool
