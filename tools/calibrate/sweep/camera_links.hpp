#pragma once

#include <cstddef>
#include <vector>

namespace atrium::calibrate {

/// How many instants cameras share: what ties their places to each other.
class CameraLinks {
public:
    explicit CameraLinks(std::size_t num_cameras)
        : num_cameras_(num_cameras), shared_(num_cameras * num_cameras, 0) {}

    /// Counts an instant that these cameras share.
    void count(const std::vector<std::size_t>& cameras);

    /// Counted instants with both cameras; with a camera and itself, all with this camera.
    std::size_t shared(std::size_t a, std::size_t b) const { return shared_[a * num_cameras_ + b]; }

    /// The cameras that are not linked to the one with most instants, directly or over others, by
    /// `least` shared instants.
    std::vector<std::size_t> unlinked(std::size_t least) const;

private:
    std::size_t num_cameras_;
    std::vector<std::size_t> shared_;  // a * n + b
};

}  // namespace atrium::calibrate
