#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/body_shape.hpp"
#include "simulation/skeleton.hpp"

#include <functional>
#include <memory>
#include <string>

namespace atrium::test {

/// The motion of a person in a room. All times are in seconds since its beginning.
struct Act {
    std::string name;  // distinguishes its films
    std::string look;  // the person's look; empty: no person, only the prop
    double seconds = 0.0;
    std::function<simulation::BodyPose(double)> pose;
    std::function<geometry::RigidTransform(double)> site_from_feet;
    /// An object that the cameras see with the person, in its own frame. May be empty.
    geometry::TriangleMesh prop;
    std::function<geometry::RigidTransform(double)> site_from_prop;
    /// Target place of a held or carried object: the middle between the palms, or the place on a
    /// palm or tray with +Z up.
    std::function<geometry::RigidTransform(double)> site_from_grip;
};

/// An arm whose palm has its middle at `palm_m`, in metres from the feet (+X outwards, +Y forwards,
/// +Z up), for a person of `scale` times the nominal height. `fingers` and `palm` are
/// perpendicular.
simulation::ArmPose reach(const Eigen::Vector3d& palm_m,
                          const Eigen::Vector3d& fingers,
                          const Eigen::Vector3d& palm,
                          const Eigen::Vector3d& elbow_towards,
                          double scale);

/// Distance by which the wrists miss their place in the pose because the arms are too short, in
/// metres of a person of nominal height. The larger of both wrists.
double out_of_reach_m(const simulation::BodyPose& pose);

/// Height relative to the nominal height of one of `simulation::look_names()`.
double scale_of(const std::string& look);

/// The skin of a person who performs an act. The look must exist.
class ActedPerson {
public:
    explicit ActedPerson(const Act& act);

    /// Person and prop at a time, as closed meshes in the site frame.
    geometry::TriangleMesh mesh_site(double time_s) const;

private:
    Act act_;
    double scale_ = 1.0;
    std::shared_ptr<const simulation::Skin> skin_;  // null: no person
};

}  // namespace atrium::test
