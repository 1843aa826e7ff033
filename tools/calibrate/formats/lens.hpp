#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"

#include <string>
#include <vector>

namespace atrium::calibrate {

/// Intrinsics with OpenCV's meaning, as numbers of a file.
struct LensNumbers {
    std::vector<double> matrix;      // 9 row by row, or fx, fy, cx, cy
    std::vector<double> distortion;  // k1, k2, p1, p2, k3, k4 ..., or those of `model`
    std::string model;               // "fisheye", "equidistant", ...; empty: Brown's
    std::vector<double> size;        // width, height; empty: unknown
    double pixel_centre = 0.0;       // coordinate of the first pixel's centre
};

/// For errors on a list with too many numbers: it takes a decimal comma for a separator.
inline constexpr const char* kCommaMakesTwo =
    "; a decimal comma makes two numbers of one: decimals have a point";

/// Whether `model` is a name of OpenCV's fisheye lens, whose coefficients are k1 to k4.
bool is_fisheye(std::string model);

/// Checks the numbers and fills `camera.lens`. Lenses of other models are fitted; a fit that is off
/// by more than a pixel is an error. Adds to `notes` what was changed. `where` is the file.
Expected<void> set_lens(ForeignCamera& camera,
                        const LensNumbers& lens,
                        const std::string& where,
                        std::vector<std::string>& notes);

/// Applies a fit, or refuses it: see above. `model` is for messages.
Expected<void> accept_fit(ForeignCamera& camera,
                          const std::array<double, 5>& distortion,
                          double error_px,
                          const std::string& model,
                          const std::string& where,
                          std::vector<std::string>& notes);

}  // namespace atrium::calibrate
