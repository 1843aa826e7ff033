#pragma once

#include "tests/support/world/physics_meshes.hpp"
#include "ticks.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

/// Soft objects, and a stage on which tests let them fall, hang and be touched.
namespace atrium::physics {

inline constexpr std::uint32_t kSoft = 50;

inline SoftObject ball_at(const Eigen::Vector3d& position) {
    SoftObject ball;
    ball.id = kSoft;
    ball.shape = SoftShape::kBall;
    ball.size_m.setConstant(0.35);
    ball.spacing_m = 0.04;
    ball.mass_kg = 0.5;
    ball.world_from_object.translation = position;
    return ball;
}

inline SoftObject curtain_at(const Eigen::Vector3d& position) {
    SoftObject cloth;
    cloth.id = kSoft;
    cloth.size_m = {0.7, 1.9, 0.01};
    cloth.spacing_m = 0.08;
    cloth.mass_kg = 0.4;
    cloth.damping_hz = 1.5;
    cloth.pins = {{PinPlace::kTop}};
    cloth.world_from_object.translation = position;
    return cloth;
}

inline SoftObject rope_at(const Eigen::Vector3d& position) {
    SoftObject rope;
    rope.id = kSoft;
    rope.shape = SoftShape::kRope;
    rope.size_m = {2.0, 0.02, 1.2};
    rope.mass_kg = 0.2;
    rope.pins = {{PinPlace::kLeft}, {PinPlace::kRight}};
    rope.world_from_object.translation = position;
    return rope;
}

// A world with a floor and one person, whose meshes arrive at 30 Hz.
class SoftStage {
public:
    explicit SoftStage(const WorldOptions& options = {}) : world(options) {
        world.add({.id = 1, .shape = ObjectShape::kPlane, .size_m = {10, 10, 0}});
    }

    void run(
        double seconds, const std::function<void()>& look = [] {}) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kTickS)); ++i) {
            world.tick();
            look();
        }
    }
    void play(
        double seconds,
        const std::function<geometry::TriangleMesh(double)>& mesh_at,
        const std::function<void(double)>& look = [](double) {}) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kMeshPeriodS)); ++i) {
            const Timestamp time{1'000'000'000 + std::int64_t{33'333'333} * num_meshes_++};
            world.set_person("anna", shaper.shape(mesh_at(i * kMeshPeriodS), time));
            for (int tick = 1; tick <= 4; ++tick) {
                world.tick();
                look(i * kMeshPeriodS + tick * kTickS);
            }
        }
    }

    const SoftState& soft(std::uint32_t id = kSoft) {
        world.get_soft_states(states_);
        for (const SoftState& state : states_) {
            if (state.id == id) return state;
        }
        ADD_FAILURE() << "no soft object " << id;
        return states_.front();
    }
    Eigen::Vector3d centre(std::uint32_t id = kSoft) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const SoftState& state = soft(id);
        for (const Eigen::Vector3f& p : state.positions) sum += p.cast<double>();
        return sum / static_cast<double>(state.positions.size());
    }
    double lowest_m(std::uint32_t id = kSoft) {
        double low = 1e9;
        for (const Eigen::Vector3f& p : soft(id).positions) low = std::min<double>(low, p.z());
        return low;
    }
    /// Momentum of an object whose nodes have about equal mass [kg m/s].
    Eigen::Vector3d momentum(const SoftObject& object) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        const SoftState& state = soft(object.id);
        for (const Eigen::Vector3f& v : state.velocities) sum += v.cast<double>();
        return object.mass_kg * sum / static_cast<double>(state.velocities.size());
    }
    double fastest_mps(std::uint32_t id = kSoft) {
        double fastest = 0.0;
        for (const Eigen::Vector3f& v : soft(id).velocities)
            fastest = std::max<double>(fastest, v.norm());
        return fastest;
    }
    double mean_square_speed(std::uint32_t id = kSoft) {
        double sum = 0.0;
        const SoftState& state = soft(id);
        for (const Eigen::Vector3f& v : state.velocities) sum += v.squaredNorm();
        return sum / static_cast<double>(state.velocities.size());
    }
    double volume_m3(std::uint32_t id = kSoft) {
        const SoftState& state = soft(id);
        geometry::TriangleMesh mesh;
        for (const Eigen::Vector3f& p : state.positions) mesh.vertices.push_back(p.cast<double>());
        mesh.triangles = world.soft_topology(id)->triangles;
        return geometry::volume_m3(mesh);
    }
    double rope_length_m() {
        const SoftState& state = soft();
        double length = 0.0;
        for (const auto& s : world.soft_topology(kSoft)->segments) {
            length += (state.positions[s[0]] - state.positions[s[1]]).norm();
        }
        return length;
    }
    /// Gives all nodes of a soft object one velocity.
    void throw_soft(std::uint32_t id, const Eigen::Vector3d& velocity) {
        SoftState state = soft(id);
        for (Eigen::Vector3f& v : state.velocities) v = velocity.cast<float>();
        ASSERT_TRUE(world.restore_soft(state));
    }
    RigidState rigid(std::uint32_t id) {
        std::vector<RigidState> states;
        world.get_states(states);
        for (const RigidState& state : states) {
            if (state.id == id) return state;
        }
        return {};
    }

    World world;
    PersonShaper shaper{PersonShapeOptions{}};

private:
    int num_meshes_ = 0;
    std::vector<SoftState> states_;
};

}  // namespace atrium::physics
