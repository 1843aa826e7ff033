#include "world_server/description/puppet.hpp"

#include "core/geometry/alignment.hpp"
#include "world_server/description/shared_entries.hpp"

#include <cmath>

namespace atrium::world_server {
namespace {

using Eigen::Vector3d;
using physics::ObjectShape;

// A freely swinging limb comes to rest within about this time.
constexpr double kSettle_s = 0.25;
// Air drag of a light, clothed figure: it swings on its strings for seconds, not for minutes.
constexpr double kDrag_per_s = 0.2;
// Stretch of a string under the weight of the whole puppet.
constexpr double kStringStretch_m = 0.01;
// Largest force of a string, in puppet weights. A string that pulled harder would fling a forearm
// like a catapult when it slips out of a hand. A puppet that swings overhead weighs three times as
// much as at rest.
constexpr double kStringMaxWeights = 3.0;

// All lengths below are in puppet heights, all places in the puppet's frame.
class Builder {
public:
    Builder(const PuppetDescription& description, std::uint32_t first_id)
        : d_(description), next_id_(first_id) {}

    Puppet build() {
        build_trunk();
        build_arm("l", 1.0);
        build_arm("r", -1.0);
        build_leg("l", 1.0);
        build_leg("r", -1.0);
        if (d_.string_m > 0.0) hang();
        return std::move(puppet_);
    }

private:
    void build_trunk() {
        pelvis_ = add("pelvis", ObjectShape::kBox, {0.10, 0.16, 0.10}, {0, 0, 0.52}, d_.colour);
        chest_ = add("chest", ObjectShape::kBox, {0.11, 0.20, 0.20}, {0, 0, 0.69}, d_.colour);
        ball(chest_, pelvis_, {0, 0, 0.58}, Vector3d::UnitZ(), 35, 30);
        head_ = add("head", ObjectShape::kSphere, {0.16, 0.16, 0.16}, {0, 0, 0.92}, d_.head_colour);
        ball(head_, chest_, {0, 0, 0.815}, Vector3d::UnitZ(), 40, 60);
    }

    void build_arm(const std::string& side, double sign) {
        const Vector3d along = Vector3d(0, sign, -1).normalized();
        const Vector3d shoulder(0, sign * 0.115, 0.765);
        const Vector3d elbow = shoulder + 0.185 * along;
        const std::uint32_t upper =
            limb("upper_arm_" + side, {0.060, 0.060, 0.17}, shoulder + 0.095 * along, along);
        ball(upper, chest_, shoulder, along, 75, 45);
        const std::uint32_t fore =
            limb("forearm_" + side, {0.055, 0.055, 0.17}, elbow + 0.09 * along, along);
        // the forearm bends forwards
        hinge(fore, upper, elbow, along.cross(Vector3d::UnitX()), -5, 130);
        hands_.push_back({fore, elbow + 0.175 * along});
    }

    void build_leg(const std::string& side, double sign) {
        const double y = sign * 0.05;
        const Vector3d down = -Vector3d::UnitZ();
        const std::uint32_t thigh =
            limb("thigh_" + side, {0.085, 0.085, 0.22}, {0, y, 0.355}, down);
        ball(thigh, pelvis_, {0, y, 0.47}, down, 75, 25);
        const std::uint32_t shin = limb("shin_" + side, {0.075, 0.075, 0.20}, {0, y, 0.135}, down);
        // the shin bends backwards
        hinge(shin, thigh, {0, y, 0.24}, Vector3d::UnitY(), -3, 130);
        const std::uint32_t foot = add("foot_" + side,
                                       ObjectShape::kBox,
                                       {0.13, 0.065, 0.03},
                                       {0.025, y, 0.015},
                                       d_.limb_colour);
        hinge(foot, shin, {0, y, 0.03}, Vector3d::UnitY(), -35, 35);
    }

    // Adds strings that lead straight up from the head and both hands.
    void hang() {
        double mass_kg = 0.0;
        for (const WorldObject& part : puppet_.parts) mass_kg += part.rigid.mass_kg;
        string(head_, {0, 0, 1.0}, mass_kg);
        for (const auto& [hand, place] : hands_) string(hand, place, mass_kg);
    }

    void string(std::uint32_t part, const Vector3d& place, double mass_kg) {
        physics::Joint joint;
        joint.kind = physics::JointKind::kSpring;
        joint.a = part;
        joint.anchor_m = d_.world_from_puppet * (d_.height_m * place);
        joint.anchor_b_m = joint.anchor_m + Vector3d(0, 0, d_.string_m);
        joint.rest_length_m = d_.string_m;
        joint.stiffness_npm = mass_kg * 9.81 / kStringStretch_m;
        joint.damping = 0.4 * std::sqrt(joint.stiffness_npm * mass_kg);
        joint.force_max = kStringMaxWeights * mass_kg * 9.81;
        joint.pulls_only = true;
        puppet_.joints.push_back(joint);
    }

    std::uint32_t limb(const std::string& part,
                       const Vector3d& size,
                       const Vector3d& centre,
                       const Vector3d& along) {
        return add(part,
                   ObjectShape::kCapsule,
                   size,
                   centre,
                   d_.limb_colour,
                   geometry::rotation_between(-Vector3d::UnitZ(), along));
    }

    std::uint32_t add(const std::string& part,
                      ObjectShape shape,
                      const Vector3d& size,
                      const Vector3d& centre,
                      const Vector3d& colour,
                      const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
        WorldObject object;
        object.rigid.id = next_id_++;
        object.name = d_.name + "." + part;
        object.puppet = d_.name;
        object.rigid.shape = shape;
        object.rigid.size_m = d_.height_m * size;
        object.look.colour = colour;
        object.rigid.world_from_object =
            d_.world_from_puppet * geometry::RigidTransform{turn, d_.height_m * centre};
        object.rigid.friction = d_.friction;
        object.rigid.restitution = 0.1;
        object.rigid.drag_per_s = kDrag_per_s;
        object.rigid.mass_kg = d_.density_kg_per_m3 * physics::volume_m3(to_rigid(object));
        puppet_.parts.push_back(object);
        return object.rigid.id;
    }

    physics::Joint joint_of(std::uint32_t a,
                            std::uint32_t b,
                            const Vector3d& place,
                            const Vector3d& axis) const {
        const physics::RigidObject& part = puppet_.parts[a - puppet_.parts.front().rigid.id].rigid;
        physics::Joint joint;
        joint.a = a;
        joint.b = b;
        joint.anchor_m = d_.world_from_puppet * (d_.height_m * place);
        joint.axis = d_.world_from_puppet.rotation * axis.normalized();
        const double length_m = part.size_m.maxCoeff();
        joint.damping = part.mass_kg * length_m * length_m / 3.0 / kSettle_s;
        return joint;
    }

    void ball(std::uint32_t a,
              std::uint32_t b,
              const Vector3d& place,
              const Vector3d& axis,
              double swing_deg,
              double twist_deg) {
        physics::Joint joint = joint_of(a, b, place, axis);
        joint.kind = physics::JointKind::kBall;
        joint.swing_rad = kRadPerDeg * swing_deg;
        joint.twist_rad = kRadPerDeg * twist_deg;
        puppet_.joints.push_back(joint);
    }

    void hinge(std::uint32_t a,
               std::uint32_t b,
               const Vector3d& place,
               const Vector3d& axis,
               double lower_deg,
               double upper_deg) {
        physics::Joint joint = joint_of(a, b, place, axis);
        joint.kind = physics::JointKind::kHinge;
        joint.limits = {{kRadPerDeg * lower_deg, kRadPerDeg * upper_deg}};
        puppet_.joints.push_back(joint);
    }

    struct Hand {
        std::uint32_t part;
        Vector3d place;
    };
    const PuppetDescription& d_;
    std::uint32_t next_id_;
    std::uint32_t pelvis_ = 0, chest_ = 0, head_ = 0;
    std::vector<Hand> hands_;
    Puppet puppet_;
};

}  // namespace

Puppet make_puppet(const PuppetDescription& description, std::uint32_t first_id) {
    return Builder(description, first_id).build();
}

}  // namespace atrium::world_server
