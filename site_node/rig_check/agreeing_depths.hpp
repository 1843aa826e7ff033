#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::rig_check {

/// A part of a ray `centre + depth * direction`; `end` may be infinite.
struct DepthInterval {
    double begin = 0.0;
    double end = 0.0;
};

/// One camera and its silhouette, prepared for rays of other cameras.
class Projector {
public:
    /// `view` must outlive this. `knows_outside`: what lies outside the picture is nobody; else it
    /// is unknown, and the camera agrees with everything there.
    Projector(const hull::SilhouetteView& view, bool knows_outside);

    /// Finds the depths of a ray (site frame) where this camera sees a silhouette (`seen`), and
    /// where it does not contradict one (`agreeing`). Both sorted, in reused memory.
    void find(const Eigen::Vector3d& centre_site,
              const Eigen::Vector3d& direction_site,
              std::vector<DepthInterval>& seen,
              std::vector<DepthInterval>& agreeing);

    /// True if the point is in front of the camera and inside its picture.
    bool is_in_picture(const Eigen::Vector3d& p_site) const;

    const Eigen::Vector3d& centre_site() const { return centre_site_; }
    /// Direction in the site of an undistorted pixel, with depth 1 along the camera's axis.
    Eigen::Vector3d direction_site(const Eigen::Vector2d& pixel) const;

private:
    struct Crossings;
    void cross(const std::vector<std::vector<Eigen::Vector2d>>& outlines,
               const Eigen::Vector3d& at_start,
               const Eigen::Vector3d& along,
               std::vector<DepthInterval>& inside);

    const hull::SilhouetteView& view_;
    std::vector<std::vector<Eigen::Vector2d>> border_;  // of the picture or the field; empty: none
    Eigen::Matrix3d pixel_from_site_;                   // of directions, homogeneous
    Eigen::Vector3d centre_site_;
    std::vector<double> toggles_;            // scratch
    std::vector<DepthInterval> in_picture_;  // scratch
};

}  // namespace atrium::rig_check
