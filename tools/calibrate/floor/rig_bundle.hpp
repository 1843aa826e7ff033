#pragma once

#include "core/config/rig.hpp"
#include "tools/calibrate/adjust/bundle.hpp"

#include <optional>
#include <string>

namespace atrium::calibrate {

/// The cameras of a rig in a bundle, with a lens without distortion, skew and different fx and fy:
/// pixels have to be moved by `undistorted`.
std::vector<BundleCamera> ideal_cameras(const config::Rig& rig);

/// Where the ideal camera of `lens` sees what the real one sees at `px`. Empty where the distortion
/// has no inverse.
std::optional<Eigen::Vector2d> undistorted(const geometry::PinholeCamera& lens,
                                           const Eigen::Vector2d& px);

/// The camera of the rig with this name. Error kConfiguration, with the names that it has.
Expected<std::size_t> camera_index(const config::Rig& rig, const std::string& name);

}  // namespace atrium::calibrate
