#include "world_server/description/world_text.hpp"

#include "core/geometry/roll_pitch_yaw.hpp"
#include "world_server/description/shared_entries.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace atrium::world_server {
namespace {

using physics::JointKind;
using physics::ObjectShape;
using physics::PinPlace;
using physics::SoftShape;
using Names = std::map<std::uint32_t, std::string>;

// Micrometres, and millionths of a degree. Removes negative zeros.
double rounded(double value) { return std::round(value * 1e6) / 1e6 + 0.0; }

// The shortest digits that read back as the same value. Values that came in a message are floats:
// 0.9, not 0.8999999761581421.
std::string digits(double value) {
    const auto single = static_cast<float>(value);
    if (static_cast<double>(single) == value) return fmt::format("{}", single + 0.0f);
    return fmt::format("{}", value);
}

std::string list(const Eigen::Vector3d& v, int size = 3) {
    if (size == 2) return fmt::format("[{}, {}]", digits(v.x()), digits(v.y()));
    return fmt::format("[{}, {}, {}]", digits(v.x()), digits(v.y()), digits(v.z()));
}

std::string place(const Eigen::Vector3d& v) {
    return list(v.unaryExpr([](double x) { return rounded(x); }));
}

// To a tenth of a millimetre.
std::string places(const std::vector<Eigen::Vector3f>& nodes) {
    std::string text = "[";
    for (const Eigen::Vector3f& node : nodes)
        for (const float x : node) text += fmt::format("{}{:.4f}", text.size() > 1 ? ", " : "", x);
    return text + "]";
}

// Lines `key = value` of one table.
class Table {
public:
    Table(std::string& text, const char* header) : text_(text) {
        text_ += fmt::format("\n{}\n", header);
    }
    void number(const char* key, double value) { raw(key, digits(value)); }
    void name(const char* key, const std::string& value) {
        text_ += fmt::format("{} = \"{}\"\n", key, value);
    }
    void raw(const char* key, const std::string& value) {
        text_ += fmt::format("{} = {}\n", key, value);
    }
    void pose(const geometry::RigidTransform& world_from_object) {
        raw("position_m", place(world_from_object.translation));
        const Eigen::Vector3d angles = geometry::roll_pitch_yaw_deg(world_from_object.rotation);
        if (angles.cwiseAbs().maxCoeff() > 1e-6) raw("roll_pitch_yaw_deg", place(angles));
    }
    void look(const Eigen::Vector3d& colour, const std::string& texture) {
        raw("colour", list(colour));
        picture(texture);
    }
    void picture(const std::string& texture) {
        if (!texture.empty()) name("texture", texture);
    }
    void model(const std::string& file, double scale) {
        name("model", file);
        if (scale != 1.0) number("scale", scale);
    }

private:
    std::string& text_;
};

void write(const WorldObject& object, const std::string& name, std::string& text) {
    static const std::map<ObjectShape, const char*> kNames{{ObjectShape::kBox, "box"},
                                                           {ObjectShape::kSphere, "sphere"},
                                                           {ObjectShape::kCylinder, "cylinder"},
                                                           {ObjectShape::kCapsule, "capsule"},
                                                           {ObjectShape::kPlane, "plane"},
                                                           {ObjectShape::kConvex, "convex"},
                                                           {ObjectShape::kCompound, "compound"}};
    const physics::RigidObject& rigid = object.rigid;
    Table table(text, "[[object]]");
    table.name("name", name);
    table.name("shape", kNames.at(rigid.shape));
    if (!object.look.model.empty())
        table.model(object.look.model, object.look.model_scale);
    else if (rigid.shape == ObjectShape::kBox)
        table.raw("size_m", list(rigid.size_m));
    else if (rigid.shape == ObjectShape::kPlane)
        table.raw("size_m", list(rigid.size_m, 2));
    else
        table.number("diameter_m", rigid.size_m.x());
    if (rigid.shape == ObjectShape::kCylinder || rigid.shape == ObjectShape::kCapsule)
        table.number("height_m", rigid.size_m.z());
    table.number("mass_kg", rigid.mass_kg);
    table.number("friction", rigid.friction);
    table.number("restitution", rigid.restitution);
    table.number("rolling_friction_m", rigid.rolling_friction_m);
    if (rigid.drag_per_s != physics::RigidObject{}.drag_per_s)
        table.number("drag_per_s", rigid.drag_per_s);
    table.look(object.look.colour, object.look.texture);
    table.pose(rigid.world_from_object);
}

std::string quoted_list(const std::vector<std::string>& names) {
    return fmt::format("[\"{}\"]", fmt::join(names, "\", \""));
}

// Its places that are fixed in the world or tied to an object: one for all, or one for each.
void write_pins(const physics::SoftObject& soft, const Names& names, Table& table) {
    std::vector<std::string> pins, tied, holders;
    for (const physics::SoftPin& pin : soft.pins) {
        const std::string where = pin_name(pin.place, soft.shape);
        const auto holder = names.find(pin.object_id);
        if (pin.object_id == 0) {
            pins.push_back(where);
        } else if (holder != names.end()) {
            tied.push_back(where);
            holders.push_back(holder->second);
        }
    }
    if (!pins.empty()) table.raw("pins", quoted_list(pins));
    if (tied.empty()) return;
    if (std::ranges::count(holders, holders.front()) == std::ssize(holders))
        table.name("tied_to", holders.front());
    else
        table.raw("tied_to", quoted_list(holders));
    table.raw("tied", quoted_list(tied));
}

void write_size(const WorldSoftObject& soft, Table& table) {
    const Eigen::Vector3d& size = soft.object.size_m;
    switch (soft.object.shape) {
        case SoftShape::kCloth:
            table.name("shape", "cloth");
            table.raw("size_m", list(size, 2));
            table.number("thickness_m", size.z());
            if (soft.object.span_m) table.number("span_m", *soft.object.span_m);
            return;
        case SoftShape::kRope:
            table.name("shape", "rope");
            table.number("length_m", size.x());
            table.number("diameter_m", size.y());
            return table.number("span_m", size.z());
        case SoftShape::kBall:
            table.name("shape", "ball");
            return table.number("diameter_m", size.x());
        case SoftShape::kBox:
            table.name("shape", "box");
            return table.raw("size_m", list(size));
        case SoftShape::kModel:
            table.name("shape", "model");
            return table.model(soft.model, soft.model_scale);
    }
}

void write(const WorldSoftObject& soft, const Names& names, std::string& text) {
    const physics::SoftObject& object = soft.object;
    Table table(text, "[[soft]]");
    table.name("name", soft.name);
    write_size(soft, table);
    if (object.shape != SoftShape::kModel) table.number("spacing_m", object.spacing_m);
    table.number("mass_kg", object.mass_kg);
    table.number("stiffness", object.stiffness);
    table.number("damping_hz", object.damping_hz);
    table.number("friction", object.friction);
    table.look(soft.colour, soft.texture);
    table.pose(object.world_from_object);
    if (!object.start_nodes.empty()) table.raw("nodes_m", places(object.start_nodes));
    write_pins(object, names, table);
}

void write_limits(const physics::Joint& joint, const char* key, double unit, Table& table) {
    if (!joint.limits) return;
    const auto& [low, high] = *joint.limits;
    table.raw(key, fmt::format("[{}, {}]", rounded(low / unit), rounded(high / unit)));
}

void write_spring(const physics::Joint& joint, Table& table) {
    table.raw("anchor_b_m", list(joint.anchor_b_m));
    table.number("stiffness_npm", joint.stiffness_npm);
    table.number("damping_nspm", joint.damping);
    table.number("rest_length_m", joint.rest_length_m);
    table.number("force_max_n", joint.force_max);
    table.raw("pulls_only", joint.pulls_only ? "true" : "false");
}

void write(const physics::Joint& joint, const Names& names, std::string& text) {
    constexpr std::array kKinds{"hinge", "ball", "slider", "spring"};
    Table table(text, "[[joint]]");
    table.name("kind", kKinds.at(static_cast<std::size_t>(joint.kind)));
    table.name("a", names.at(joint.a));
    table.name("b", joint.b == 0 ? "world" : names.at(joint.b));
    table.raw("anchor_m", list(joint.anchor_m));
    table.raw("collide", joint.collides ? "true" : "false");
    if (joint.kind == JointKind::kSpring) return write_spring(joint, table);
    table.raw("axis", list(joint.axis));
    const bool is_slider = joint.kind == JointKind::kSlider;
    table.number(is_slider ? "damping_nspm" : "damping_nms", joint.damping);
    if (joint.swing_rad) table.number("swing_deg", rounded(*joint.swing_rad / kRadPerDeg));
    if (joint.twist_rad) table.number("twist_deg", rounded(*joint.twist_rad / kRadPerDeg));
    if (joint.kind == JointKind::kBall) return;
    write_limits(joint, is_slider ? "limits_m" : "limits_deg", is_slider ? 1.0 : kRadPerDeg, table);
    if (joint.motor_max == 0.0) return;
    table.number(is_slider ? "motor_mps" : "motor_deg_per_s",
                 is_slider ? joint.motor_speed : rounded(joint.motor_speed / kRadPerDeg));
    table.number(is_slider ? "motor_max_n" : "motor_max_nm", joint.motor_max);
}

void write(const WorldScenery& scenery, std::string& text) {
    Table table(text, "[[scenery]]");
    table.name("name", scenery.name);
    table.model(scenery.look.model, scenery.look.model_scale);
    table.pose(scenery.world_from_model);
    table.raw("solid", scenery.is_solid ? "true" : "false");
    table.number("friction", scenery.friction);
    table.number("restitution", scenery.restitution);
    // without one, parts for which the file states none have this colour, too
    if (scenery.look.colour != Look().colour) table.raw("colour", list(scenery.look.colour));
    table.picture(scenery.look.texture);
}

void write(const NamedPlacement& site, std::string& text) {
    Table table(text, "[[site]]");
    table.name("name", site.site);
    table.raw("position_m", place(site.world_from_site.translation));
    table.number("yaw_deg",
                 rounded(geometry::roll_pitch_yaw_deg(site.world_from_site.rotation).z()));
}

void write(const Rights& rights, std::string& text) {
    Table table(text, "[rights]");
    for (const auto& [key, member] : kRights) {
        const Right& right = rights.*member;
        if (right.everyone || right.names.empty())
            table.name(key, right.everyone ? "everyone" : "nobody");
        else
            table.raw(key, fmt::format("[\"{}\"]", fmt::join(right.names, "\", \"")));
    }
    table.number("max_per_s", rights.max_per_s);
}

void write(const physics::WorldOptions& world, std::string& text) {
    const geometry::Aabb box = box_of(world);
    Table table(text, "[bounds]");
    table.raw("min_m", list(box.min));
    table.raw("max_m", list(box.max));
    table.name("leave",
               world.leaving == physics::LeavePolicy::kRemove   ? "remove"
               : world.leaving == physics::LeavePolicy::kBounce ? "bounce"
                                                                : "reset");
}

// A world file needs names that differ; objects that two viewers add at once may share one.
Names unique_names(const std::vector<WorldObject>& objects,
                   const std::vector<WorldSoftObject>& soft) {
    constexpr std::size_t kMaxLength = 63;
    std::set<std::string> used{"world"};
    for (const WorldSoftObject& other : soft) used.insert(other.name);
    Names names;
    for (const WorldObject& object : objects) {
        std::string name = object.name;
        for (int i = 2; !used.insert(name).second; ++i) {
            const std::string ending = fmt::format("_{}", i);
            name = object.name.substr(0, kMaxLength - ending.size()) + ending;
        }
        names[object.rigid.id] = name;
    }
    return names;
}

}  // namespace

std::string to_toml(const WorldDescription& description,
                    const std::vector<WorldObject>& objects,
                    const std::vector<WorldSoftObject>& soft,
                    const std::string& world_table) {
    std::string text = "[world]\n" + world_table;
    text += fmt::format("gravity = {}\n", list(description.world.gravity));
    write(description.world, text);
    write(description.rights, text);
    for (const NamedPlacement& site : description.placements) write(site, text);
    for (const WorldScenery& scenery : description.scenery) write(scenery, text);
    const Names names = unique_names(objects, soft);
    for (const WorldObject& object : objects) write(object, names.at(object.rigid.id), text);
    for (const WorldSoftObject& object : soft) write(object, names, text);
    for (const physics::Joint& joint : description.joints) {
        if (names.contains(joint.a) && (joint.b == 0 || names.contains(joint.b)))
            write(joint, names, text);
    }
    return text;
}

}  // namespace atrium::world_server
