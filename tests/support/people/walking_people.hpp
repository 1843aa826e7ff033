#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "simulation/person.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::test {

struct WalkOptions {
    std::uint64_t seed = 1;
    int num_people = 1;
    double reach_m = 0.8;    // of the paths, from the middle of the room
    double speed_m_s = 0.9;  // about
};

/// People of the simulated room who walk through it on random smooth paths.
class WalkingPeople {
public:
    explicit WalkingPeople(const WalkOptions& options);

    /// Points of the skins at a time, site frame [m], in the same order at all times. `every`: of
    /// all vertices, one in so many. The convex hull of their pictures is the exact convex hull of
    /// the silhouettes of a body that these points span.
    std::vector<Eigen::Vector3d> points(double time_s, std::size_t every = 4) const;

    std::size_t size() const { return people_.size(); }
    /// All vertices of person `index`, and the triangles of every person's skin.
    std::vector<Eigen::Vector3d> skin(std::size_t index, double time_s) const;
    const std::vector<std::array<std::uint32_t, 3>>& triangles(std::size_t index) const {
        return people_[index].person.skin().mesh.triangles;
    }

private:
    struct Walker {
        simulation::Person person;
        Eigen::Array2d phase, rate;
        double stride_phase = 0.0;
    };
    std::vector<Walker> people_;
    WalkOptions options_;
};

/// Turns a camera about its centre and moves its centre: `turn` is a rotation vector [rad],
/// `move_m` a translation, both in the axes of the site.
geometry::CalibratedCamera bumped(const geometry::CalibratedCamera& camera,
                                  const Eigen::Vector3d& turn,
                                  const Eigen::Vector3d& move_m);

}  // namespace atrium::test
