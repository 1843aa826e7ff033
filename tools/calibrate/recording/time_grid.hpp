#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Instants of cameras that took their pictures at about the same times.
namespace atrium::calibrate {

/// Times of the pictures of each camera in nanoseconds, ascending.
using CameraTimes = std::map<std::string, std::vector<std::uint64_t>>;

/// Pictures of one number are of one instant; a number without pictures is a gap.
struct TimeGrid {
    double period_ns = 0.0;
    std::map<std::string, std::map<std::uint64_t, std::size_t>> numbers;  // by camera and time
    std::map<std::string, double> offset_ns;  // of a camera, from the median one
    std::size_t num_beside = 0;  // pictures without number: another one is nearer to the instant
};

/// Numbers the times of all cameras by one grid from 0. The cameras take pictures together, up to
/// an offset of each camera below a quarter of a period, and up to a third of a period of jitter.
/// Pictures may be missing, and the period may change slowly. Needs four pictures of some camera,
/// else it is empty.
std::optional<TimeGrid> grid_of(const CameraTimes& cameras);

}  // namespace atrium::calibrate
