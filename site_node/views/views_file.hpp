#pragma once

#include "core/base/expected.hpp"
#include "site_node/views/named_view.hpp"

#include <filesystem>
#include <vector>

namespace atrium::views {

/// Reads silhouettes from a JSON file:
/// `{"views": [{name, width, height, fx, fy, cx, cy, [skew], rotation, translation, contours}]}`
/// Pixel centres are at integer coordinates. `rotation` (row-major, 9 numbers) and `translation`
/// [m] are camera_from_site, `skew` defaults to 0, and `contours` is a list of closed polygons
/// `[[x, y], ...]` in undistorted pixels. Other keys, and repeated ones, are errors. Errors name
/// the file, the view and the key.
Expected<std::vector<NamedView>> load_views_file(const std::filesystem::path& path);

/// Writes the format that load_views_file reads. Error kUnavailable.
Expected<void> save_views_file(const std::vector<NamedView>& views,
                               const std::filesystem::path& path);

}  // namespace atrium::views
