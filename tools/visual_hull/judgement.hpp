#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/views/named_view.hpp"
#include "tools/visual_hull/tool.hpp"

#include <span>
#include <string>
#include <vector>

namespace atrium::hull_tool {

/// Loads the rig of the recording. Adds what looks wrong about it to `warnings`; what makes any
/// hull impossible is an error.
Expected<config::Rig> load_checked_rig(const std::filesystem::path& recording,
                                       std::vector<std::string>& warnings);

/// Says what is wrong about the cameras of a views file.
std::vector<std::string> judge_cameras(std::span<const views::NamedView> views);

/// Says why the silhouettes contradict each other, if they do, and what is implausible about the
/// hull's size. `partial`: what lies outside a picture is unknown.
std::vector<std::string> judge_hull(std::span<const views::NamedView> views,
                                    const hull::VisualHull& hull,
                                    const std::optional<geometry::Aabb>& bounds,
                                    bool partial);

}  // namespace atrium::hull_tool
