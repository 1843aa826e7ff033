#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <functional>
#include <vector>

/// People made of spheres, and what ideal cameras see of them.
namespace atrium::renderer::synthetic {

struct Sphere {
    Eigen::Vector3d centre;
    double radius_m = 0.5;
};

/// Closed surfaces of all spheres, about 2 * `num_rings`^2 * 2 triangles each.
geometry::TriangleMesh mesh_of(const std::vector<Sphere>& spheres, int num_rings);

/// A camera at `position` that looks at `target`; 640 x 480, 500 px focal length.
geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position,
                                     const Eigen::Vector3d& target);

/// `count` cameras around `target`, 3 m away.
std::vector<geometry::CalibratedCamera> ring(int count, const Eigen::Vector3d& target);

/// sRGB in [0, 1] of a surface point.
using Colour = std::function<Eigen::Vector3d(const Eigen::Vector3d& p_site)>;

/// What `camera` sees, at half resolution and cropped to the spheres, by casting a ray per pixel:
/// nothing is shared with the renderer.
CameraPicture picture_of(const std::vector<Sphere>& spheres,
                         const geometry::CalibratedCamera& camera,
                         const Colour& colour);

/// First hit of a ray; false where there is none.
bool hit(const std::vector<Sphere>& spheres,
         const Eigen::Vector3d& origin,
         const Eigen::Vector3d& direction,
         Eigen::Vector3d& p);

}  // namespace atrium::renderer::synthetic
