#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The parts of a COLMAP model that describe cameras, as in its files.
struct ColmapCamera {
    std::string model;
    double width = 0.0;
    double height = 0.0;
    std::vector<double> parameters;
};
struct ColmapImage {
    std::string name;
    std::int64_t camera = 0;
    Eigen::Quaterniond rotation;  // camera_from_world, as in the file
    Eigen::Vector3d translation;
};
struct ColmapModel {
    std::map<std::int64_t, ColmapCamera> cameras;
    std::vector<ColmapImage> images;
};

inline constexpr std::size_t kMaxColmapImages = 100'000;
inline constexpr std::size_t kMaxColmapBytes = std::size_t{1} << 30;

Expected<void> read_colmap_text(const std::filesystem::path& cameras,
                                const std::filesystem::path& images,
                                ColmapModel& model);
Expected<void> read_colmap_binary(const std::filesystem::path& cameras,
                                  const std::filesystem::path& images,
                                  ColmapModel& model);

}  // namespace atrium::calibrate
