#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/adjust/reprojection.hpp"
#include "tools/calibrate/adjust/wand.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A camera while it is adjusted: one focal length for both axes, no skew.
struct BundleCamera {
    std::string name;
    int width = 0, height = 0;
    std::array<double, 6> pose{};  // camera_from_world: rotation vector, translation [m]
    LensValues lens{};
    bool is_placed = false;

    geometry::PinholeCamera intrinsics() const;
    geometry::RigidTransform camera_from_world() const;
    void set_camera_from_world(const geometry::RigidTransform& transform);
    Eigen::Vector3d centre_world() const { return camera_from_world().inverse().translation; }
};

/// A light of the wand in the picture of a camera.
struct Sighting {
    std::uint32_t camera = 0;
    std::uint32_t instant = 0;  // index in Bundle::wands
    std::uint32_t light = 0;
    Eigen::Vector2d px = Eigen::Vector2d::Zero();  // distorted
    bool is_used = true;                           // false: an outlier, or held out
};

/// The wand at an instant.
struct WandPose {
    geometry::RigidTransform world_from_wand;
    bool is_placed = false;
};

/// Cameras that saw a wand in motion, and all that is adjusted. Calibration boards take its place
/// in the same way (tools/calibrate/board/views.hpp).
struct Bundle {
    Wand wand;
    std::vector<BundleCamera> cameras;
    std::vector<WandPose> wands;
    std::vector<Sighting> sightings;  // grouped by instant, and within it by camera
};

/// Which values of the lenses are adjusted. The others stay as they are.
enum class LensFreedom : std::uint8_t {
    kFixed,
    kFocal,        // f
    kRadial,       // f, k1
    kAll,          // f, cx, cy, k1, k2, p1, p2
    kAllAndThird,  // and k3
};

struct AdjustOptions {
    LensFreedom lens = LensFreedom::kAll;
    double robust_px = 1.0;  // errors beyond this count less (Cauchy); 0: all count alike
    int max_iterations = 50;
    int num_threads = 1;
    bool are_cameras_fixed = false;  // only the wands are adjusted
};

/// Lowers the reprojection error of all used sightings of placed cameras and wands, over their
/// poses and the lenses: bundle adjustment (Triggs et al., 2000) with Ceres. The wand is rigid, so
/// its lengths give the scale. With a single light, the scale stays as it is. The first placed
/// camera stays where it is. Error kInternal with the solver's reason.
Expected<void> adjust(Bundle& bundle, const AdjustOptions& options);

/// Where the light would be seen [px, distorted]; NaN behind the camera.
Eigen::Vector2d project(const BundleCamera& camera, const Eigen::Vector3d& point_world);

Eigen::Vector3d light_world(const Bundle& bundle, const Sighting& sighting);

/// Seen minus projected [px]; NaN if camera or wand has no place.
Eigen::Vector2d error_px(const Bundle& bundle, const Sighting& sighting);

}  // namespace atrium::calibrate
