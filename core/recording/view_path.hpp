#pragma once

#include "core/base/expected.hpp"

#include <Eigen/Core>

#include <chrono>
#include <filesystem>
#include <vector>

namespace atrium::recording {

/// A viewpoint at a time of a recording.
struct ViewKey {
    std::chrono::nanoseconds time{0};                      // since the beginning of the recording
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // world
    Eigen::Vector3d target_m = Eigen::Vector3d::Zero();    // world; differs from `position_m`
    double fov_deg = 45.0;                                 // vertical
};

/// The way of a camera through a recording: viewpoints at rising times, between which it moves
/// smoothly (Catmull-Rom, through every key). Before the first and behind the last it stands still.
///
/// As JSON: {"keys": [{"time_s": 0, "position_m": [2, -3, 1.7], "target_m": [0, 0, 1],
/// "fov_deg": 40}, ...]}.
class ViewPath {
public:
    /// kNotFound, or kConfiguration that names the key and what is wrong with it.
    static Expected<ViewPath> load(const std::filesystem::path& file);
    Expected<void> save(const std::filesystem::path& file) const;

    /// Adds a key, or replaces the one of the same time (to a hundredth of a second).
    void add(const ViewKey& key);
    /// Viewpoint at a time. There must be a key.
    ViewKey at(std::chrono::nanoseconds time) const;
    /// Place of the last key up to `time`, from 1; 0: it is before all.
    std::size_t number_at(std::chrono::nanoseconds time) const;
    const std::vector<ViewKey>& keys() const { return keys_; }

private:
    std::vector<ViewKey> keys_;
};

}  // namespace atrium::recording
