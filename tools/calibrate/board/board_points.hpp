#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A corner of a board in the picture of an instant.
struct BoardCorner {
    std::uint32_t instant = 0;
    std::uint32_t corner = 0;                      // of all boards, as in detect.hpp
    Eigen::Vector2d px = Eigen::Vector2d::Zero();  // distorted
};

/// What one camera showed.
struct BoardCamera {
    std::string name;
    int width = 0, height = 0;
    std::size_t num_pictures = 0;
    std::vector<BoardCorner> corners;  // ascending by instant, then by corner
};

using BoardPoints = std::vector<BoardCamera>;

}  // namespace atrium::calibrate
