#pragma once

#include "tools/calibrate/recording/matching.hpp"

#include <string>
#include <vector>

/// Cameras that one program counts from 0 and another one from 1.
namespace atrium::calibrate {

struct ShiftedCount {
    Originals names;      // of the pictures, for match_shots; empty if nothing is shifted
    std::string pairing;  // "'camera_0' has 'Cam1', 'camera_1' has 'Cam2'"
};
/// Finds out whether the numbers of all cameras, which follow each other, are those of as many
/// pictures, shifted by one, and the only thing that the names have in common.
ShiftedCount find_shifted_count(const std::vector<std::string>& cameras,
                                const std::vector<Shots>& shots,
                                const Originals& originals);

/// A hint if the first camera has no pictures and pictures of the number after the last one are
/// left, or the other way round; else empty. `cameras` and `missing` as the user knows them,
/// `unused` are labels.
std::string doubt_of_count(const std::vector<std::string>& cameras,
                           const std::vector<std::string>& missing,
                           const std::vector<std::string>& unused);

}  // namespace atrium::calibrate
