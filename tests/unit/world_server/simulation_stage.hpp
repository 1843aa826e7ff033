#pragma once

#include "world_server/simulation.hpp"

#include <functional>
#include <string>
#include <utility>

/// A floor and a ball of 20 cm that rests on it.
namespace atrium::world_server {

inline WorldServerConfig floor_and_ball() {
    WorldServerConfig config;
    WorldObject floor;
    floor.rigid.id = 1;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    WorldObject ball;
    ball.rigid.id = 2;
    ball.name = "ball";
    ball.rigid.shape = physics::ObjectShape::kSphere;
    ball.rigid.size_m.setConstant(0.2);
    ball.rigid.mass_kg = 0.5;
    ball.rigid.world_from_object.translation = {0, 0, 0.1};
    config.objects = {floor, ball};
    config.tick_hz = 120.0;
    return config;
}

inline Simulation simulation_of(const WorldServerConfig& config,
                                std::function<void(const std::string&)> reject) {
    return {config, Scene::create(config).value(), std::move(reject)};
}

}  // namespace atrium::world_server
