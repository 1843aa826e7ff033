#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"

#include <array>
#include <string>

namespace atrium::calibrate {

/// Pictures whose shape differs by more are never scaled ones.
inline constexpr double kMostDifference = 0.01;

/// Gives cameras a picture size: to those without one, and, in the same shape, instead of another
/// one, with scaled intrinsics. Error kConfiguration for another shape.
Expected<void> set_picture_size(ForeignCamera& camera, const std::array<int, 2>& size);

/// Adds the middle of the picture to principal points that are offsets from it, as Meshroom,
/// Metashape and RealityCapture write them: of all cameras they lie near pixel 0, where no
/// principal point is. Says so in `checks`. Does nothing as long as a picture size is unknown.
void read_point_offsets(ForeignRig& rig);

/// How far the shapes of two picture sizes differ, as a share; 0 if rounding by two pixels explains
/// it, as of pictures that were scaled, or without a size.
double shape_difference(const std::array<int, 2>& a, const std::array<int, 2>& b);

/// What to do about pictures of `size` that show a part of what was calibrated. `format`: of the
/// calibration.
std::string cure_of_crop(const std::string& format, const std::array<int, 2>& size);

/// Says that the pictures may be cropped, with the cure, if set_picture_size gave cameras another
/// shape than rounding explains; else empty.
std::string doubt_of_shapes(const ForeignRig& before, const ForeignRig& after);

}  // namespace atrium::calibrate
