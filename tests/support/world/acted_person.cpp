#include "tests/support/world/acted_person.hpp"

#include <algorithm>
#include <cassert>
#include <map>

namespace atrium::test {
namespace {

// The middle of the palm on the skin, in the hand's frame: along the fingers and out of the palm.
constexpr double kAlongM = 0.095;
constexpr double kOutM = 0.021;

std::shared_ptr<const simulation::Skin> skin_of(const std::string& look) {
    // creation takes a tenth of a second, and every trial needs one
    static std::map<std::string, std::shared_ptr<const simulation::Skin>> skins;
    auto& skin = skins[look];
    if (!skin) {
        const auto found = simulation::find_look(look);
        assert(found);
        skin = std::make_shared<const simulation::Skin>(simulation::make_skin(*found));
    }
    return skin;
}

}  // namespace

simulation::ArmPose reach(const Eigen::Vector3d& palm_m,
                          const Eigen::Vector3d& fingers,
                          const Eigen::Vector3d& palm,
                          const Eigen::Vector3d& elbow_towards,
                          double scale) {
    simulation::ArmPose arm;
    arm.wrist = palm_m / scale - kAlongM * fingers.normalized() - kOutM * palm.normalized();
    arm.elbow_towards = elbow_towards;
    arm.fingers = fingers;
    arm.palm = palm;
    return arm;
}

double out_of_reach_m(const simulation::BodyPose& pose) {
    const simulation::RestJoints rest;
    const auto bones = simulation::pose_bones(pose);
    const auto mirrored = [](const Eigen::Vector3d& p) {
        return Eigen::Vector3d(-p.x(), p.y(), p.z());
    };
    const Eigen::Vector3d right = bones[simulation::kHand] * rest.wrist();
    const Eigen::Vector3d left =
        mirrored(bones[simulation::left_of(simulation::kHand)] * mirrored(rest.wrist()));
    return std::max((right - pose.right_arm.wrist).norm(), (left - pose.left_arm.wrist).norm());
}

double scale_of(const std::string& look) {
    const auto found = simulation::find_look(look);
    assert(found);
    return found->height_m / simulation::kNominalHeight;
}

ActedPerson::ActedPerson(const Act& act) : act_(act) {
    if (act.look.empty()) return;
    scale_ = scale_of(act.look);
    skin_ = skin_of(act.look);
}

geometry::TriangleMesh ActedPerson::mesh_site(double time_s) const {
    geometry::TriangleMesh mesh;
    if (skin_) {
        const simulation::SkinnedBody carried(*skin_, simulation::pose_bones(act_.pose(time_s)));
        const geometry::RigidTransform site_from_feet = act_.site_from_feet(time_s);
        mesh.triangles = skin_->mesh.triangles;
        for (std::size_t i = 0; i < skin_->mesh.vertices.size(); ++i)
            mesh.vertices.push_back(site_from_feet * (scale_ * carried.vertex(i).position));
    }
    if (act_.prop.empty()) return mesh;
    const geometry::RigidTransform site_from_prop = act_.site_from_prop(time_s);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3d& vertex : act_.prop.vertices)
        mesh.vertices.push_back(site_from_prop * vertex);
    for (const auto& [a, b, c] : act_.prop.triangles)
        mesh.triangles.push_back({first + a, first + b, first + c});
    return mesh;
}

}  // namespace atrium::test
