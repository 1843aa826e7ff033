#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"
#include "tools/calibrate/judge/measured_heights.hpp"

#include <Eigen/Core>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Which direction of a calibration's frame is up.
struct UpConclusion {
    std::optional<Eigen::Vector3d> up;  // unit vector; none: the frame of the file stays
    bool is_axis = true;                // `up` is an axis of the frame
    std::optional<double> floor_m;      // along `up`, from two or more measured heights
    std::vector<std::string> told;      // sentences, as in Conclusion
    std::vector<std::string> checks;
    std::vector<std::string> problems;
};

/// What the user has measured, by cameras.
struct Measurements {
    std::vector<MeasuredHeight> heights;
    std::optional<Said::Distance> distance;
};

/// Finds up from `said` ("+Z", or "0.1,-0.98,0.2" in the axes of the file; empty: not said), else
/// from two or more measured heights, else from the cameras, which are in the frame of the file.
/// Compares them. With heights, the cameras are in metres.
UpConclusion conclude_up(const ForeignRig& foreign,
                         std::span<const geometry::CalibratedCamera> cameras,
                         const std::string& said,
                         const Measurements& measured = {});

}  // namespace atrium::calibrate
