#pragma once

#include "site_node/hull/visual_hull.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace atrium::hull {

/// Fixture with valid silhouettes of a sphere. Tests change them.
class HullOfASphere : public testing::Test {
protected:
    std::vector<SilhouetteView> views_ =
        test::views_of(test::Sphere{{0.0, 0.1, 0.9}, 0.4}, test::make_ring_rig({}), 40);
    HullScratch scratch_;
};

}  // namespace atrium::hull
