#include "world_server/physics/rigid/manifold_points.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace atrium::physics {
namespace {

// Removes the old points that no new one replaces. The others keep their impulses.
void remove_others(btPersistentManifold& manifold,
                   const btTransform& body0_from_world,
                   std::span<const btVector3> on_0) {
    const btScalar near = manifold.getContactBreakingThreshold();
    for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
        const btVector3& old = manifold.getContactPoint(i).m_localPointA;
        const bool is_kept = std::any_of(on_0.begin(), on_0.end(), [&](const auto& p) {
            return (body0_from_world * p - old).length2() < near * near;
        });
        if (!is_kept) manifold.removeContactPoint(i);
    }
}

}  // namespace

void add_touch(btManifoldResult& result, const FlatTouch& touch, bool is_0_end, bool is_whole) {
    btPersistentManifold& manifold = *result.getPersistentManifold();
    // normals point to the manifold's first body; places are on its second
    const btVector3 to_0 = is_0_end ? touch.normal : -touch.normal;
    std::array<btVector3, 4> on_0;
    std::array<btVector3, 4> on_1;
    for (std::size_t i = 0; i < touch.points.size(); ++i) {
        const FlatPoint& p = touch.points[i];
        const btVector3 on_end = p.on_face + p.gap * touch.normal;
        on_0[i] = is_0_end ? on_end : p.on_face;
        on_1[i] = is_0_end ? p.on_face : on_end;
    }
    if (is_whole) remove_others(manifold, manifold.getBody0()->getWorldTransform().inverse(), on_0);
    for (std::size_t i = 0; i < on_1.size(); ++i)
        result.addContactPoint(to_0, on_1[i], touch.points[i].gap);
}

}  // namespace atrium::physics
