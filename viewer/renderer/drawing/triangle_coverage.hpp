#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

/// Pixels of one row: from `begin` up to, but not including, `end`.
struct PixelRun {
    int row;
    int begin;
    int end;

    friend bool operator==(const PixelRun&, const PixelRun&) = default;
};

struct CoverageScratch {
    struct Corner {
        Eigen::Vector2f px;
        Eigen::Vector2i cell;  // first pixel centre at or after it, in x and y
    };
    std::vector<Corner> corners;
    std::vector<std::int32_t> changes;
};

/// Finds the pixels of a square picture whose centres lie in any of the triangles, of either
/// orientation. `corners_px` has pixel centres at integers. Clips at the border of the picture.
void find_covered(std::span<const Eigen::Vector2f> corners_px,
                  std::span<const std::array<std::uint32_t, 3>> triangles,
                  int side_px,
                  CoverageScratch& scratch,
                  std::vector<PixelRun>& out);

}  // namespace atrium::renderer
