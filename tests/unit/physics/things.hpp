#pragma once

#include "world_server/physics/world.hpp"

#include <gtest/gtest.h>

#include <cmath>

/// Objects and helpers for tests of objects.
namespace atrium::physics {

inline constexpr std::uint32_t kFloorId = 1;

inline RigidObject floor_plane() {
    return {.id = kFloorId, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}, .friction = 0.8};
}

inline RigidObject box_at(std::uint32_t id,
                          const Eigen::Vector3d& position,
                          const Eigen::Vector3d& size_m = {0.2, 0.2, 0.2}) {
    return {.id = id,
            .size_m = size_m,
            .mass_kg = 500.0 * size_m.prod(),
            .world_from_object = {Eigen::Quaterniond::Identity(), position}};
}

inline std::vector<Eigen::Vector3d> corners_of_box(const Eigen::Vector3d& centre,
                                                   const Eigen::Vector3d& size_m) {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d sign(
            (i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5);
        corners.push_back(centre + sign.cwiseProduct(size_m));
    }
    return corners;
}

inline void run(World& world, double seconds) {
    const int num_ticks = static_cast<int>(std::lround(seconds * 120.0));
    for (int i = 0; i < num_ticks; ++i) world.tick();
}

inline RigidState state_of(const World& world, std::uint32_t id) {
    std::vector<RigidState> states;
    world.get_states(states);
    for (const RigidState& s : states) {
        if (s.id == id) return s;
    }
    ADD_FAILURE() << "no object " << id;
    return {};
}

/// Current position of a point of an object. The point is given at its start in the world.
inline Eigen::Vector3d now_at(const World& world,
                              const RigidObject& object,
                              const Eigen::Vector3d& place_at_start) {
    return state_of(world, object.id).world_from_object *
           (object.world_from_object.inverse() * place_at_start);
}

}  // namespace atrium::physics
