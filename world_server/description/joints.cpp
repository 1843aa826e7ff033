#include "world_server/description/joints.hpp"

#include "world_server/description/shared_entries.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace atrium::world_server {
namespace {

constexpr config::Range kAmount{0.0, 1e5};

// " (did you mean door?)", or advice.
std::string meant_end(const std::string& written, const std::vector<WorldObject>& objects) {
    const std::string question = object_meant_by(written, objects);
    return question.empty()
               ? "; soft objects have pins and tied_to instead, and what is joined to scenery is "
                 "joined to the world: leave b out"
               : question;
}

void read_ends(config::TableReader& reader,
               const std::vector<WorldObject>& objects,
               physics::Joint& joint) {
    std::string a, b = "world";
    reader.require("a");
    reader.read("a", a);
    reader.read("b", b);
    const WorldObject* object_a = find_object(objects, a);
    const WorldObject* object_b = find_object(objects, b);
    if (object_a == nullptr)
        return reader.reject("a", "must be the name of an object" + meant_end(a, objects));
    if (object_b == nullptr && b != "world")
        return reader.reject("b",
                             "must be the name of an object, or world" + meant_end(b, objects));
    joint.a = object_a->rigid.id;
    joint.b = object_b == nullptr ? 0 : object_b->rigid.id;
    const bool b_moves = object_b != nullptr && object_b->rigid.mass_kg > 0.0;
    if (object_a->rigid.mass_kg == 0.0 && !b_moves)
        reader.reject("a", "must have a mass if b has none");
}

void read_axis(config::TableReader& reader, physics::Joint& joint, bool is_required) {
    if (is_required) reader.require("axis");
    reader.read("axis", joint.axis.data(), 3, {-1.0, 1.0});
}

// Reads `[lower, upper]` in units of `unit`.
void read_limits(config::TableReader& reader,
                 const std::string& key,
                 double unit,
                 physics::Joint& joint) {
    if (!reader.has(key)) return;
    std::array<double, 2> limits{};
    reader.read(key, limits.data(), 2, {-1000.0, 1000.0});
    joint.limits = {{unit * limits[0], unit * limits[1]}};
}

void read_angle(config::TableReader& reader,
                const std::string& key,
                std::optional<double>& angle_rad) {
    if (!reader.has(key)) return;
    double angle_deg = 0.0;
    reader.read(key, angle_deg, {0.0, 180.0});
    angle_rad = kRadPerDeg * angle_deg;
}

void read_hinge(config::TableReader& reader, physics::Joint& joint) {
    read_axis(reader, joint, true);
    read_limits(reader, "limits_deg", kRadPerDeg, joint);
    reader.read("damping_nms", joint.damping, kAmount);
    double speed_deg = 0.0;
    reader.forbid("motor_rpm", "write motor_deg_per_s, 6 times that");
    reader.forbid("motor_rad_per_s", "write motor_deg_per_s, 57.3 times that");
    reader.read("motor_deg_per_s", speed_deg, {-3600.0, 3600.0});
    reader.read("motor_max_nm", joint.motor_max, kAmount);
    joint.motor_speed = kRadPerDeg * speed_deg;
    if (speed_deg != 0.0) reader.require("motor_max_nm");
}

void read_ball(config::TableReader& reader, physics::Joint& joint) {
    read_axis(reader, joint, false);
    read_angle(reader, "swing_deg", joint.swing_rad);
    read_angle(reader, "twist_deg", joint.twist_rad);
    reader.read("damping_nms", joint.damping, kAmount);
}

void read_slider(config::TableReader& reader, physics::Joint& joint) {
    read_axis(reader, joint, true);
    read_limits(reader, "limits_m", 1.0, joint);
    reader.read("damping_nspm", joint.damping, kAmount);
    reader.read("motor_mps", joint.motor_speed, {-100.0, 100.0});
    reader.read("motor_max_n", joint.motor_max, kAmount);
    if (joint.motor_speed != 0.0) reader.require("motor_max_n");
}

void read_spring(config::TableReader& reader, physics::Joint& joint) {
    reader.require("anchor_b_m");
    reader.read("anchor_b_m", joint.anchor_b_m.data(), 3, kPositionRange);
    reader.require("stiffness_npm");
    reader.read("stiffness_npm", joint.stiffness_npm, {0.0, 1e6});
    reader.read("damping_nspm", joint.damping, kAmount);
    joint.rest_length_m = (joint.anchor_m - joint.anchor_b_m).norm();
    reader.read("rest_length_m", joint.rest_length_m, {0.0, 1000.0});
    reader.read("force_max_n", joint.force_max, kAmount);
    reader.read("pulls_only", joint.pulls_only);
}

void read_kind(config::TableReader& reader, std::string& kind) {
    static const std::vector<std::string> kKinds{"hinge", "ball", "slider", "spring"};
    static const std::vector<std::string> kRigid{
        "fixed", "rigid", "weld", "welded", "glue", "glued", "lock", "locked"};
    std::string written;
    reader.read("kind", written);
    if (std::ranges::find(kRigid, written) == kRigid.end())
        return reader.read("kind", kind, kKinds);
    reader.reject("kind",
                  "must be one of hinge, ball, slider, spring; a hinge with limits_deg = [0, 0] "
                  "holds rigidly, and parts that never move belong in one compound");
}

physics::Joint read_joint(config::TableReader& reader, const std::vector<WorldObject>& objects) {
    physics::Joint joint;
    std::string kind;
    reader.require("kind");
    read_kind(reader, kind);
    read_ends(reader, objects, joint);
    reader.require("anchor_m");
    reader.read("anchor_m", joint.anchor_m.data(), 3, kPositionRange);
    reader.read("collide", joint.collides);
    if (kind == "hinge") {
        joint.kind = physics::JointKind::kHinge;
        read_hinge(reader, joint);
    } else if (kind == "slider") {
        joint.kind = physics::JointKind::kSlider;
        read_slider(reader, joint);
    } else if (kind == "spring") {
        joint.kind = physics::JointKind::kSpring;
        read_spring(reader, joint);
    } else {
        joint.kind = physics::JointKind::kBall;
        read_ball(reader, joint);
    }
    if (const auto problem = physics::find_problem(joint))
        reader.reject(std::string(problem->field), std::string(problem->allowed));
    return joint;
}

}  // namespace

void read_joints(config::TableReader& reader,
                 const std::vector<WorldObject>& objects,
                 std::vector<physics::Joint>& joints) {
    for (config::TableReader& table : reader.tables("joint"))
        joints.push_back(read_joint(table, objects));
}

}  // namespace atrium::world_server
