#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "tests/support/random.hpp"

#include <Eigen/Core>

#include <vector>

namespace atrium::test {

/// The pixels of one camera whose centres solid bodies cover.
class MaskPainter {
public:
    /// `camera` has no lens distortion.
    explicit MaskPainter(const geometry::CalibratedCamera& camera);

    void clear();
    /// `mesh_site` is closed and lies completely in front of the camera.
    void draw(const geometry::TriangleMesh& mesh_site);
    /// Each pixel that shares an edge with the other side changes sides with this probability, like
    /// the flickering border of a segmented person.
    void flicker(double probability, Random& random);

    const image::Mask& mask() const { return mask_; }

private:
    geometry::CalibratedCamera camera_;
    image::Mask mask_;
    image::Mask before_;                      // scratch
    std::vector<Eigen::Vector2d> projected_;  // scratch
};

}  // namespace atrium::test
