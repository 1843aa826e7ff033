#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <span>
#include <string>
#include <vector>

namespace atrium::rig_check {

struct Finding {
    bool is_error = false;  // no hull is possible; else a judgement
    std::string text;       // names cause and cure
};

/// Checks a rig without pictures: lengths in another unit, cameras that share no view, extrinsics
/// in the other direction or of another axis convention, another up direction, intrinsics in
/// another unit or of another picture size. Errors first. `unit_m` is the unit of the file
/// (config::Rig).
std::vector<Finding> check_rig(std::span<const geometry::CalibratedCamera> cameras,
                               double unit_m = 1.0);

/// The part of check_rig that concerns one camera's intrinsics: focal lengths and principal points
/// of another unit or picture size.
std::vector<Finding> check_lens(const geometry::CalibratedCamera& camera);

/// Ways to misread all extrinsics at once.
enum class Misreading {
    kNone,
    kInverted,        // the file has site_from_camera
    kOpenGl,          // its cameras look along -Z with +Y up
    kInvertedOpenGl,  // both
};
inline constexpr Misreading kMisreadings[] = {
    Misreading::kInverted, Misreading::kOpenGl, Misreading::kInvertedOpenGl};

/// What the file means if it was misread in this way.
geometry::RigidTransform corrected(const geometry::RigidTransform& camera_from_site,
                                   Misreading misreading);

/// Cause and cure, for messages.
std::string explain(Misreading misreading);

/// The greatest number of cameras that see one point in common, and the mean of the unit vectors
/// from this point to them: shorter than 1 if they look from different sides.
struct CommonView {
    std::size_t num_cameras = 0;
    double one_sidedness = 1.0;
};
CommonView find_common_view(std::span<const geometry::CalibratedCamera> cameras);

}  // namespace atrium::rig_check
