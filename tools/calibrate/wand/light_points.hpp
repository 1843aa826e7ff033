#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A bright point in the picture of a camera: a light of the wand, or a reflection.
struct LightPoint {
    std::uint32_t instant = 0;
    std::optional<std::uint32_t> light;  // index in the wand, if known
    /// Distorted, pixel centres at integer coordinates.
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
};

struct LightCamera {
    std::string name;
    std::vector<LightPoint> points;  // ascending by instant
};

/// The points of a sweep, by camera, in the order in which the file names the cameras.
using LightPoints = std::vector<LightCamera>;

/// Reads CSV with the columns `camera`, `instant`, `x_px` and `y_px`, and maybe `light`, in any
/// order, named in the first line. `light` may be empty. Errors name file and line.
Expected<LightPoints> load_light_points(const std::filesystem::path& file);

/// Writes such a file, with all five columns.
Expected<void> save_light_points(const LightPoints& cameras, const std::filesystem::path& file);

}  // namespace atrium::calibrate
