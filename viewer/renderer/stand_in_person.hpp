#pragma once

#include "viewer/renderer/person_model.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace atrium::renderer {

/// A person of a few triangles, which face `eye_site` and lie around `target_site`, in the pictures
/// of `num_cameras` cameras, at least 6: one triangle for each number of cameras that can colour a
/// triangle (`kCamerasPerTriangle`). Whoever draws it uses every shader that people need.
PersonModel make_stand_in_person(const Eigen::Vector3f& eye_site,
                                 const Eigen::Vector3f& target_site,
                                 std::size_t num_cameras);

}  // namespace atrium::renderer
