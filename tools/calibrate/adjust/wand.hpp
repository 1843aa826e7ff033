#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace atrium::calibrate {

/// How the lights of a wand lie.
enum class WandForm : std::uint8_t { kPoint, kLine, kBody };

/// The lights of a calibration wand: 1 to 16, at fixed places.
struct Wand {
    std::vector<Eigen::Vector3d> lights_m;  // in the wand's frame

    std::size_t size() const { return lights_m.size(); }
    /// kLine: all lights lie within 0.5 mm of a line through two of them.
    WandForm form() const;
    /// Largest distance of two lights [m]; 0 for a single light.
    double length_m() const;
    /// Of a line: places of the lights along it, from light 0 [m].
    std::vector<double> places_on_line_m() const;
};

/// Four lights on a line, at 0, 10, 30 and 60 cm.
Wand default_wand();

/// Reads a wand: one `[[light]]` with `position_m = [x, y, z]` for each light. Errors name file and
/// line: lights less than 1 cm or more than 5 m apart, more than 16.
Expected<Wand> load_wand(const std::filesystem::path& file);

}  // namespace atrium::calibrate
