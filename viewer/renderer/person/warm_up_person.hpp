#pragma once

#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace atrium::renderer {

/// Makes a person of a few triangles that face `eye_site`, around `target_site`, with pictures of
/// `num_cameras` cameras, at least 6. It has one triangle for each possible number of cameras per
/// triangle (`kCamerasPerTriangle`), so drawing it uses every shader of people.
PersonModel make_warm_up_person(const Eigen::Vector3f& eye_site,
                                const Eigen::Vector3f& target_site,
                                std::size_t num_cameras);

}  // namespace atrium::renderer
