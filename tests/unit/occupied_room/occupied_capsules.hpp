#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace atrium::occupied_room::test {

/// Cameras on a ring in a patterned room with a person made of capsules.
class CapsuleFilm {
public:
    explicit CapsuleFilm(int num_cameras = 4);

    /// A picture of `camera` with its own noise; the person stands at `floor_site` with clothes of
    /// two colours. Writes the true mask.
    image::YuvImage picture(std::size_t camera,
                            const Eigen::Vector3d& floor_site,
                            image::Mask* truth = nullptr);
    image::YuvImage empty(std::size_t camera);
    /// The room as learned from empty pictures.
    segmentation::BackgroundStatistics learned_empty(std::size_t camera);

    std::vector<geometry::CalibratedCamera> cameras;
    geometry::Aabb bounds_site;

private:
    // The masks of a person at one place. Tests show the same place many times.
    struct Drawn {
        Eigen::Vector3d floor_site;
        image::Mask body;
        image::Mask legs;
    };
    const Drawn& drawn(std::size_t camera, const Eigen::Vector3d& floor_site);
    void add_noise(image::YuvImage& picture);
    std::vector<image::YuvImage> rooms_;       // without noise
    std::vector<std::optional<Drawn>> drawn_;  // the last of each camera
    std::uint32_t seed_ = 1;
};

}  // namespace atrium::occupied_room::test
