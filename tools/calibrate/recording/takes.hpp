#pragma once

#include "tools/calibrate/recording/shots.hpp"

#include <string>
#include <vector>

/// The pictures of one recording among those of several in a folder.
namespace atrium::calibrate {

/// Whether a folder or the file of the pictures with this label has a name that matches a pattern
/// of a shell, or begins with it: "Gait 1" is the beginning of "Gait 1_cam2", not of "Gait
/// 10_cam2".
bool is_of_take(const std::string& pattern, const std::string& label);

/// What several names of folders or files begin with, without names of cameras: candidates for a
/// pattern.
std::vector<std::string> beginnings(const std::vector<std::string>& cameras,
                                    const std::vector<Shots>& shots);

}  // namespace atrium::calibrate
