#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <functional>
#include <vector>

/// People made of spheres, and their pictures in ideal cameras.
namespace atrium::renderer::synthetic {

struct Sphere {
    Eigen::Vector3d centre;
    double radius_m = 0.5;
};

/// Closed surfaces of all spheres, with about 2 * `num_rings`^2 * 2 triangles each.
geometry::TriangleMesh mesh_of(const std::vector<Sphere>& spheres, int num_rings);

/// A camera at `position` that looks at `target`, with 640 x 480 px and 500 px focal length.
geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position,
                                     const Eigen::Vector3d& target);

/// `count` cameras around `target`, 3 m away.
std::vector<geometry::CalibratedCamera> ring(int count, const Eigen::Vector3d& target);

/// sRGB colour in [0, 1] of a surface point.
using Colour = std::function<Eigen::Vector3d(const Eigen::Vector3d& p_site)>;

/// The picture of `camera` at half resolution, cropped to the spheres. It casts a ray per pixel and
/// shares nothing with the renderer.
CameraPicture picture_of(const std::vector<Sphere>& spheres,
                         const geometry::CalibratedCamera& camera,
                         const Colour& colour);

/// First hit of a ray. Returns false if it hits nothing.
bool hit(const std::vector<Sphere>& spheres,
         const Eigen::Vector3d& origin,
         const Eigen::Vector3d& direction,
         Eigen::Vector3d& p);

}  // namespace atrium::renderer::synthetic
