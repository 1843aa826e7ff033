#include "world_server/description/doubts.hpp"

#include "core/geometry/roll_pitch_yaw.hpp"
#include "world_server/description/amount_doubts.hpp"
#include "world_server/description/blocked_doubts.hpp"
#include "world_server/description/hollow_doubts.hpp"
#include "world_server/description/layout_doubts.hpp"
#include "world_server/description/load_doubts.hpp"
#include "world_server/description/reversed_doubts.hpp"
#include "world_server/description/scenery_doubts.hpp"
#include "world_server/description/scenery_starts.hpp"
#include "world_server/description/soft_doubts.hpp"
#include "world_server/description/start_doubts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string_view>

namespace atrium::world_server {
namespace {

// Twice this is a soft thing of a few triangles, which bends only at its corners.
constexpr double kLargeSoftEdge_m = 0.25;

void doubt_textures(const WorldDescription& world, std::vector<std::string>& lines) {
    std::map<std::string, std::string> undrawn;  // by model
    const auto look_at = [&](const std::string& model, const std::string& own, bool has_texture) {
        if (!own.empty() && !has_texture) undrawn[model] = own;
    };
    for (const WorldObject& object : world.objects)
        look_at(object.look.model, object.look.own_texture, !object.look.texture.empty());
    for (const WorldScenery& scenery : world.scenery)
        look_at(scenery.look.model, scenery.look.own_texture, !scenery.look.texture.empty());
    for (const WorldSoftObject& soft : world.soft)
        look_at(soft.model, soft.own_texture, !soft.texture.empty());
    for (const auto& [model, own] : undrawn) {
        lines.push_back(
            fmt::format("texture_not_drawn model={} names=\"{}\" advice=\"textures of model files "
                        "are not drawn: name the picture with the key texture in the world file\"",
                        model,
                        own.starts_with('*') ? "a picture inside the file" : own));
    }
}

void doubt_materials(const WorldDescription& world, std::vector<std::string>& lines) {
    std::map<std::string, std::string> missing;  // by model
    const auto look_at = [&](const Look& look) {
        if (!look.missing_materials.empty() && look.texture.empty())
            missing[look.model] = look.missing_materials;
    };
    for (const WorldObject& object : world.objects) look_at(object.look);
    for (const WorldScenery& scenery : world.scenery) look_at(scenery.look);
    for (const auto& [model, file] : missing) {
        lines.push_back(fmt::format(
            "colour_not_drawn model={} names=\"{}\" reason=\"the file of its colours is "
            "not there\" advice=\"copy it beside the model, on the viewers' hosts too\"",
            model,
            file));
    }
}

void doubt_glass(const WorldDescription& world, std::vector<std::string>& lines) {
    std::set<std::string> models;
    for (const WorldObject& object : world.objects)
        if (object.look.is_see_through) models.insert(object.look.model);
    for (const WorldScenery& scenery : world.scenery)
        if (scenery.look.is_see_through) models.insert(scenery.look.model);
    for (const std::string& model : models) {
        lines.push_back(
            fmt::format("transparency_not_drawn model={} reason=\"its file has transparent parts, "
                        "but all is drawn opaque\" advice=\"take glass out of the model, or make "
                        "it a frame\"",
                        model));
    }
}

std::string rgb(const Eigen::Vector3d& colour) {
    return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", colour.x(), colour.y(), colour.z());
}

void doubt_colours(const WorldDescription& world, std::vector<std::string>& lines) {
    constexpr double kVisible = 0.02;
    std::set<std::string> known;  // models
    const auto look_at = [&](const std::string& name,
                             const std::string& model,
                             const std::string& own_texture,
                             const std::vector<Eigen::Vector3d>& own,
                             const Eigen::Vector3d& drawn) {
        if (own.empty() || !own_texture.empty()) return;  // a texture replaces the colours
        const bool is_drawn =
            own.size() == 1 && (own.front() - drawn).cwiseAbs().maxCoeff() < kVisible;
        if (is_drawn || !known.insert(model).second) return;
        if (own.size() == 1) {
            lines.push_back(
                fmt::format("colour_not_drawn model={} name={} reason=\"its colour is "
                            "{}, but that of its material is drawn, {}\" "
                            "advice=\"write colour = {}\"",
                            model,
                            name,
                            rgb(own.front()),
                            rgb(drawn),
                            rgb(own.front())));
            return;
        }
        lines.push_back(
            fmt::format("colour_not_drawn model={} name={} reason=\"its file has {} "
                        "colours, but all of it is drawn in {}\" advice=\"a model has "
                        "one colour: split it into objects, or give it a texture\"",
                        model,
                        name,
                        own.size(),
                        rgb(drawn)));
    };
    for (const WorldObject& object : world.objects) {
        const Look& look = object.look;
        look_at(object.name, look.model, look.own_texture, look.own_colours, look.colour);
    }
    for (const WorldSoftObject& soft : world.soft)
        look_at(soft.name, soft.model, soft.own_texture, soft.own_colours, soft.colour);
    for (const WorldScenery& scenery : world.scenery) {
        if (!scenery.is_colour_unused || !scenery.look.texture.empty()) continue;
        lines.push_back(
            fmt::format("colour_not_drawn model={} name={} reason=\"each part of its file has a "
                        "colour of its own\" advice=\"remove colour, which scenery takes where its "
                        "file has none, or change the file\"",
                        scenery.look.model,
                        scenery.name));
    }
}

void doubt_gravity(const WorldDescription& world, std::vector<std::string>& lines) {
    const Eigen::Vector3d& gravity = world.world.gravity;
    const double sideways = gravity.head<2>().norm();
    if (gravity.norm() == 0.0 || -gravity.z() >= sideways) return;
    lines.push_back(
        fmt::format("world_looks_wrong reason=\"gravity [{}] does not point down; +Z is "
                    "up: [0, 0, -{:.4g}]\"",
                    fmt::join(gravity, ", "),
                    gravity.norm()));
}

// A usual angle in radians: a multiple of pi/4 or pi/6, correct in each of its decimals, at least
// two. As degrees hardly anybody writes one: those have one decimal, or end in 25 or 75.
bool may_be_radians(double written) {
    constexpr double kWritten = 1e-7;
    const auto is_multiple = [](double value, double of, double tolerance) {
        return std::abs(value - std::round(value / of) * of) < tolerance;
    };
    const double angle = std::abs(written);
    if (is_multiple(angle, 0.1, kWritten) || is_multiple(angle, 0.25, kWritten)) return false;
    double rounding = 0.01;
    while (rounding > 1e-6 && !is_multiple(angle, rounding, kWritten)) rounding *= 0.1;
    return angle > rounding && angle < 2.0 * std::numbers::pi + rounding &&
           (is_multiple(angle, std::numbers::pi / 4.0, rounding) ||
            is_multiple(angle, std::numbers::pi / 6.0, rounding));
}

void doubt_rotations(const WorldDescription& world, std::vector<std::string>& lines) {
    const auto look_at = [&](const char* event,
                             const std::string& name,
                             const char* key,
                             const std::string& written,
                             const Eigen::Vector3d& angles_deg) {
        int num_turns = 0;
        for (const double angle : angles_deg) {
            if (std::abs(angle) < 1e-6) continue;
            if (!may_be_radians(angle)) return;
            ++num_turns;
        }
        if (num_turns == 0) return;
        constexpr double kDegPerRad = 180.0 / std::numbers::pi;
        const Eigen::Array3d in_degrees = (angles_deg * kDegPerRad).array().round() + 0.0;
        lines.push_back(fmt::format(
            "{} name={} reason=\"{} = {} turns it by hardly anything; if these are "
            "radians, the degrees are {}\"",
            event,
            name,
            key,
            written,
            std::string_view(key) == "yaw_deg" ? fmt::format("{}", in_degrees.z())
                                               : fmt::format("[{}]", fmt::join(in_degrees, ", "))));
    };
    const auto turned =
        [&](const char* event, const std::string& name, const Eigen::Quaterniond& rotation) {
            const Eigen::Vector3d angles_deg = geometry::roll_pitch_yaw_deg(rotation);
            const std::string written = fmt::format(
                "[{:.4g}, {:.4g}, {:.4g}]", angles_deg.x(), angles_deg.y(), angles_deg.z());
            look_at(event, name, "roll_pitch_yaw_deg", written, angles_deg);
        };
    std::string puppet;
    for (const WorldObject& object : world.objects) {
        if (!object.puppet.empty() && object.puppet == puppet) continue;
        puppet = object.puppet;  // its first part, the pelvis, is turned as the puppet is
        turned("object_looks_wrong",
               puppet.empty() ? object.name : puppet,
               object.rigid.world_from_object.rotation);
    }
    for (const WorldSoftObject& soft : world.soft)
        turned("soft_looks_wrong", soft.name, soft.object.world_from_object.rotation);
    for (const WorldScenery& scenery : world.scenery)
        turned("scenery_looks_wrong", scenery.name, scenery.world_from_model.rotation);
    for (const NamedPlacement& site : world.placements) {
        const Eigen::Vector3d angles_deg =
            geometry::roll_pitch_yaw_deg(site.world_from_site.rotation);
        const std::string written = fmt::format("{:.4g}", angles_deg.z());
        look_at("site_looks_wrong", site.site, "yaw_deg", written, angles_deg);
    }
}

std::string name_of(const WorldDescription& world, std::uint32_t id) {
    const WorldObject* object = object_of(world, id);
    return object == nullptr ? "world" : object->name;
}

Eigen::Vector3d start_of(const WorldDescription& world, std::uint32_t id) {
    const WorldObject* object = object_of(world, id);
    if (object == nullptr) return Eigen::Vector3d::Zero();
    return object->rigid.world_from_object.translation;
}

void doubt_joints(const WorldDescription& world, std::vector<std::string>& lines) {
    const geometry::Aabb box = box_of(world.world);
    const auto look_at =
        [&](const physics::Joint& joint, const char* key, const Eigen::Vector3d& place_m) {
            if (box.contains(place_m)) return;
            lines.push_back(fmt::format(
                "joint_looks_wrong a={} b={} reason=\"{} [{}] is outside the world's bounds; "
                "places are metres in the world\"",
                name_of(world, joint.a),
                name_of(world, joint.b),
                key,
                fmt::join(place_m, ", ")));
        };
    for (const physics::Joint& joint : world.joints) {
        look_at(joint, "anchor_m", joint.anchor_m);
        if (joint.kind == physics::JointKind::kSpring)
            look_at(joint, "anchor_b_m", joint.anchor_b_m);
        if (joint.kind != physics::JointKind::kSlider || !joint.limits) continue;
        const auto leads_out = [&](double limit_m) {
            return !box.contains(start_of(world, joint.a) + limit_m * joint.axis.normalized());
        };
        const auto out = std::ranges::find_if(*joint.limits, leads_out);
        if (out == joint.limits->end() || leads_out(0.0)) continue;
        lines.push_back(fmt::format(
            "joint_looks_wrong a={} b={} reason=\"limits_m [{}]: {:.4g} m from its start, {} is "
            "outside the world's bounds; they are metres\"",
            name_of(world, joint.a),
            name_of(world, joint.b),
            fmt::join(*joint.limits, ", "),
            *out,
            name_of(world, joint.a)));
    }
}

// Other springs between two objects add up; those with the same ends are likely copies, too.
bool do_the_same(const physics::Joint& one, const physics::Joint& other) {
    constexpr double kSame_m = 1e-3;
    constexpr double kSameAxis = 1e-3;
    const bool is_turned = one.a == other.b && one.b == other.a;
    if (one.kind != other.kind || !(is_turned || (one.a == other.a && one.b == other.b)))
        return false;
    if (one.kind == physics::JointKind::kSpring) {
        return one.pulls_only == other.pulls_only &&
               (one.anchor_m - (is_turned ? other.anchor_b_m : other.anchor_m)).norm() < kSame_m &&
               (one.anchor_b_m - (is_turned ? other.anchor_m : other.anchor_b_m)).norm() < kSame_m;
    }
    if ((one.anchor_m - other.anchor_m).norm() > kSame_m) return false;
    return one.kind == physics::JointKind::kBall ||
           one.axis.normalized().cross(other.axis.normalized()).norm() < kSameAxis;
}

void doubt_copied_joints(const WorldDescription& world, std::vector<std::string>& lines) {
    for (auto joint = world.joints.begin(); joint != world.joints.end(); ++joint) {
        const auto same = [&](const physics::Joint& other) { return do_the_same(*joint, other); };
        if (std::none_of(world.joints.begin(), joint, same)) continue;
        lines.push_back(
            fmt::format("joint_looks_wrong a={} b={} reason=\"it is there twice, of one kind at "
                        "one place [{}]: remove one [[joint]]\"",
                        name_of(world, joint->a),
                        name_of(world, joint->b),
                        fmt::join(joint->anchor_m, ", ")));
    }
}

// Such limits are hardly any motion in degrees, but a usual one in radians: up to half a turn.
void doubt_limits(const WorldDescription& world, std::vector<std::string>& lines) {
    constexpr double kLargest_deg = 3.2;
    constexpr double kRounding_deg = 1e-6;
    const auto in_degrees = [](double angle_rad) { return angle_rad * 180.0 / std::numbers::pi; };
    for (const physics::Joint& joint : world.joints) {
        for (const auto& [key, angle_rad] :
             {std::pair{"swing_deg", joint.swing_rad}, std::pair{"twist_deg", joint.twist_rad}}) {
            const double angle_deg = in_degrees(angle_rad.value_or(0.0));
            if (angle_deg < kRounding_deg || angle_deg > kLargest_deg + kRounding_deg) continue;
            lines.push_back(
                fmt::format("joint_looks_wrong a={} b={} reason=\"{} {:.4g} is hardly any motion "
                            "in degrees; as "
                            "radians it would be {:.0f} degrees\"",
                            name_of(world, joint.a),
                            name_of(world, joint.b),
                            key,
                            angle_deg,
                            in_degrees(angle_deg)));
        }
        if (joint.kind != physics::JointKind::kHinge || !joint.limits) continue;
        const double from_deg = in_degrees(joint.limits->at(0));
        const double to_deg = in_degrees(joint.limits->at(1));
        const double largest_deg = std::max(std::abs(from_deg), std::abs(to_deg));
        if (largest_deg < kRounding_deg || largest_deg > kLargest_deg + kRounding_deg) continue;
        lines.push_back(fmt::format(
            "joint_looks_wrong a={} b={} reason=\"limits_deg [{:.4g}, {:.4g}] is hardly any motion "
            "in degrees; as radians it would be {:.0f} to {:.0f} degrees\"",
            name_of(world, joint.a),
            name_of(world, joint.b),
            from_deg,
            to_deg,
            in_degrees(from_deg),
            in_degrees(to_deg)));
    }
}

void doubt_soft_models(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldSoftObject& soft : world.soft) {
        const geometry::TriangleMesh& mesh = soft.object.model;
        double sum_m = 0.0;
        for (const auto& t : mesh.triangles) {
            for (std::size_t i = 0; i < 3; ++i)
                sum_m += (mesh.vertices[t[i]] - mesh.vertices[t[(i + 1) % 3]]).norm();
        }
        const double mean_m =
            sum_m / std::max(1.0, 3.0 * static_cast<double>(mesh.triangles.size()));
        if (mean_m <= kLargeSoftEdge_m) continue;
        lines.push_back(fmt::format(
            "soft_looks_wrong name={} model={} reason=\"the edges of its triangles are {:.2g} m "
            "long, so it can hardly bend; divide them to about 0.05 m\"",
            soft.name,
            soft.model,
            mean_m));
    }
}

// The people of a site need no right to push things, and a site sends no commands.
void doubt_rights(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const auto& [key, right] : kRights) {
        for (const std::string& name : (world.rights.*right).names) {
            if (std::ranges::find(world.placements, name, &NamedPlacement::site) ==
                world.placements.end())
                continue;
            lines.push_back(
                fmt::format("rights_looks_wrong right={} name={} reason=\"this is a site, and "
                            "rights are those of viewers: write the name of a viewer "
                            "(view.name)\"",
                            key,
                            name));
        }
    }
}

}  // namespace

std::vector<std::string> doubts_about(const WorldDescription& world, double tick_hz) {
    std::vector<std::string> lines;
    doubt_textures(world, lines);
    doubt_materials(world, lines);
    doubt_glass(world, lines);
    doubt_colours(world, lines);
    doubt_gravity(world, lines);
    doubt_layout(world, lines);
    doubt_rotations(world, lines);
    doubt_joints(world, lines);
    doubt_anchors(world, lines);
    doubt_reversed(world, lines);
    doubt_blocked(world, lines);
    doubt_copied_joints(world, lines);
    doubt_limits(world, lines);
    doubt_soft_models(world, lines);
    doubt_scenery(world, lines);
    doubt_starts(world, lines);
    doubt_starts_in_scenery(world, lines);
    doubt_starts_on_scenery(world, lines);
    doubt_soft(world, lines);
    doubt_hollows(world, lines);
    doubt_loads(world, tick_hz, lines);
    doubt_amounts(world, lines);
    doubt_rights(world, lines);
    return lines;
}

}  // namespace atrium::world_server
