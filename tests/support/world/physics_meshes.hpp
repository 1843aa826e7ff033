#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

namespace atrium::physics_test {

/// A closed box of full extents `size_m`. Each face is `num_cuts` x `num_cuts` squares of two
/// triangles.
geometry::TriangleMesh make_box_mesh(const Eigen::Vector3d& size_m,
                                     const geometry::RigidTransform& world_from_box,
                                     int num_cuts);

/// A closed sphere around `centre` with 2 * num_cuts * num_cuts * 2 triangles.
geometry::TriangleMesh make_sphere_mesh(double radius_m,
                                        const Eigen::Vector3d& centre,
                                        int num_cuts);

/// A figure of about a person's size and surface that stands at `feet`: torso, head, two legs, and
/// arms stretched to the front by `reach_m`. It has several closed parts, and about 10 k triangles
/// with num_cuts = 20.
geometry::TriangleMesh make_person_mesh(const Eigen::Vector3d& feet, double reach_m, int num_cuts);

}  // namespace atrium::physics_test
