#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "site_node/coherence/tangency.hpp"
#include "tests/support/people/walking_people.hpp"

#include <span>

namespace atrium::test {

/// What cameras see of walking people at a time, through masks of whole pixels and the outlines
/// that a site makes of them. Without the instant before.
coherence::Sight masked_sight(const WalkingPeople& people,
                              double time_s,
                              std::span<const geometry::CalibratedCamera> cameras);

}  // namespace atrium::test
