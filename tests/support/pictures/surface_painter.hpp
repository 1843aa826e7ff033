#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "tests/support/random.hpp"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <span>
#include <vector>

namespace atrium::test {

/// The pictures of one camera of surfaces whose paint moves with them.
class SurfacePainter {
public:
    /// The brightness, 0 to 255, of a place on the surface at rest.
    using Paint = std::function<double(const Eigen::Vector3d& place_at_rest)>;

    /// `camera` has no lens distortion, and an even width and height.
    explicit SurfacePainter(const geometry::CalibratedCamera& camera);

    /// Draws a closed mesh before a grey room, lit by a lamp near the ceiling. `places_at_rest`:
    /// of its vertices. Adds noise of two grey levels to each pixel. The mesh lies in front of the
    /// camera.
    void draw(const geometry::TriangleMesh& mesh_site,
              std::span<const Eigen::Vector3d> places_at_rest,
              const Paint& paint,
              Random& random);

    const image::YuvImage& picture() const { return picture_; }  // grey
    const image::Mask& mask() const { return mask_; }

private:
    geometry::CalibratedCamera camera_;
    image::YuvImage picture_;
    image::Mask mask_;
    std::array<double, 4096> noise_{};  // [grey levels]
    std::vector<float> depth_m_;        // scratch
};

/// Smooth random brightness in space, about -1 to 1, with structure of 1 / `per_m`.
double noise_at(const Eigen::Vector3d& place, double per_m);

}  // namespace atrium::test
