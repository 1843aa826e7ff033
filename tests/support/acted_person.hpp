#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/body_shape.hpp"
#include "simulation/skeleton.hpp"

#include <functional>
#include <memory>
#include <string>

namespace atrium::test {

/// What somebody does in a room, over time; all times in seconds since its beginning.
struct Act {
    std::string name;  // tells its films apart
    std::string look;  // who; empty: nobody, only the prop
    double seconds = 0.0;
    std::function<simulation::BodyPose(double)> pose;
    std::function<geometry::RigidTransform(double)> site_from_feet;
    /// A thing that the cameras see with the person, in a frame of its own; may be empty.
    geometry::TriangleMesh prop;
    std::function<geometry::RigidTransform(double)> site_from_prop;
    /// Where what is held or carried belongs: the middle between the palms, or the place on a palm
    /// or tray with +Z up.
    std::function<geometry::RigidTransform(double)> site_from_grip;
};

/// An arm whose palm has its middle at `palm_m`, in metres from the feet (+X outwards, +Y forwards,
/// +Z up), for a person of `scale` times the nominal height. `fingers` and `palm` are square to
/// each other.
simulation::ArmPose reach(const Eigen::Vector3d& palm_m,
                          const Eigen::Vector3d& fingers,
                          const Eigen::Vector3d& palm,
                          const Eigen::Vector3d& elbow_towards,
                          double scale);

/// How far the wrists stay behind where the pose wants them, because the arms are too short, in
/// metres of a person of the nominal height; the larger of both.
double out_of_reach_m(const simulation::BodyPose& pose);

/// Height over the nominal one of one of `simulation::look_names()`.
double scale_of(const std::string& look);

/// The skin of somebody who acts. The look must exist.
class ActedPerson {
public:
    explicit ActedPerson(const Act& act);

    /// Person and prop at a time, closed meshes in the site frame.
    geometry::TriangleMesh mesh_site(double time_s) const;

private:
    Act act_;
    double scale_ = 1.0;
    std::shared_ptr<const simulation::Skin> skin_;  // null: nobody
};

}  // namespace atrium::test
