#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// Inputs of the hull benchmarks.
namespace atrium::bench {

/// One simulated person (limbs as round cones, always in the same pose), seen by a ring of cameras,
/// with about `segments_per_view` segments in each view. Views are consistent: finer outlines and
/// more cameras show the same body.
std::vector<hull::SilhouetteView> person_views(int num_views, int segments_per_view);

/// A set of ../shared/data/hulls; nullopt if that folder is missing.
std::optional<std::vector<hull::SilhouetteView>> shared_set(const std::string& name);

/// The folder of one recording, which may be missing.
std::filesystem::path recording_folder(const std::string& name);

std::size_t num_segments(const std::vector<hull::SilhouetteView>& views);

}  // namespace atrium::bench
