#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::hull {

/// Tells fast whether points are inside all silhouettes, and so inside their visual hull. Keeps its
/// memory. Not thread-safe while `assign` runs.
class InsideSilhouettes {
public:
    /// Copies what it needs. Null views say nothing.
    void assign(std::span<const SilhouetteView* const> views);

    /// False behind a camera. What lies outside of a view's field is not outside its silhouette.
    bool contains(const Eigen::Vector3d& point_site) const;

private:
    static constexpr std::size_t kNumRows = 256;
    struct Segment {
        Eigen::Vector2d from;
        Eigen::Vector2d to;
    };
    // Segments of closed polygons, by the rows of the picture that they cross.
    struct Polygons {
        double first_y = 0.0;
        double rows_per_px = 0.0;
        std::vector<Segment> segments;
        std::vector<std::uint32_t> row_begin;  // kNumRows + 1
        std::vector<std::uint32_t> crossing;   // segments, row by row

        void assign(std::span<const std::vector<Eigen::Vector2d>> polygons);
        bool contains(const Eigen::Vector2d& point_px) const;  // even-odd rule
        std::size_t row_of(double y) const;
    };
    struct View {
        geometry::PinholeCamera intrinsics;
        Eigen::Matrix3d rotation;
        Eigen::Vector3d translation;
        Polygons contours;
        Polygons field;  // no segments: everywhere
    };

    std::vector<View> views_;
    std::size_t num_views_ = 0;
};

}  // namespace atrium::hull
