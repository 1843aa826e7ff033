#pragma once

#include "world_server/physics/rigid/flat_area.hpp"

#include <btBulletCollisionCommon.h>

namespace atrium::physics {

/// Adds the points of a touch to the manifold of `result`. `is_0_end`: whether the manifold's first
/// body is the one with the end, its second the one with the face. With `is_whole` the touch is all
/// that there is: points that no new one replaces are removed. Points that stay keep their
/// impulses.
void add_touch(btManifoldResult& result, const FlatTouch& touch, bool is_0_end, bool is_whole);

}  // namespace atrium::physics
