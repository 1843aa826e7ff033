#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

/// Directions in words.
namespace atrium::calibrate {

/// "(0.00, 1.00, 0.00)", without negative zeros.
std::string vector_text(const Eigen::Vector3d& v);

/// "0.503,-0.736,0.454", as --up takes it.
std::string direction_text(const Eigen::Vector3d& v);

/// As --up takes it: "-Y" for an axis, else three numbers.
std::string option_text(const Eigen::Vector3d& v);

/// "door", "door and desk", "door, desk and stairs".
std::string enumerated(const std::vector<std::string>& names);

}  // namespace atrium::calibrate
