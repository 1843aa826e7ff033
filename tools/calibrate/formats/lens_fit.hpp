#pragma once

#include "core/geometry/pinhole_camera.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <span>

namespace atrium::calibrate {

/// Takes a point on the normalised plane to where the lens shows it.
using Distort = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

struct LensFit {
    std::array<double, 5> distortion{};  // k1, k2, p1, p2, k3
    double error_px = 0.0;               // the largest deviation in the picture
};

/// Fits our distortion to a lens of another model, over the whole picture. `camera` gives size,
/// focal lengths and principal point.
LensFit fit_lens(const geometry::PinholeCamera& camera, const Distort& distort);

/// The same from a model in the other direction: `straighten` takes a pixel of the picture to the
/// normalised plane.
LensFit fit_lens_inverse(const geometry::PinholeCamera& camera, const Distort& straighten);

/// OpenCV's model of k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4; missing ones are 0.
Distort rational_lens(std::span<const double> coefficients);

/// Kannala and Brandt's equidistant model of k1 to k4, as in OpenCV's fisheye module and Kalibr.
Distort equidistant_lens(std::span<const double> coefficients);

}  // namespace atrium::calibrate
