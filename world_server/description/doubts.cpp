#include "world_server/description/doubts.hpp"

#include "world_server/description/start_doubts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

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

std::string rgb(const Eigen::Vector3d& colour) {
    return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", colour.x(), colour.y(), colour.z());
}

// Scenery is drawn in the colours of its file.
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
}

std::string name_of(const WorldDescription& world, std::uint32_t id) {
    const auto found = std::ranges::find(
        world.objects, id, [](const WorldObject& object) { return object.rigid.id; });
    return found == world.objects.end() ? "world" : found->name;
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
        const bool is_slider = joint.kind == physics::JointKind::kSlider && joint.limits;
        if (!is_slider || joint.limits->at(1) - joint.limits->at(0) <= box.size().norm()) continue;
        lines.push_back(fmt::format(
            "joint_looks_wrong a={} b={} reason=\"limits_m [{}] are further apart than the ends of "
            "the world; they are metres\"",
            name_of(world, joint.a),
            name_of(world, joint.b),
            fmt::join(*joint.limits, ", ")));
    }
}

// Such limits are hardly any motion in degrees, but a usual one in radians: up to half a turn.
void doubt_limits(const WorldDescription& world, std::vector<std::string>& lines) {
    constexpr double kLargest_deg = 3.2;
    constexpr double kRounding_deg = 1e-6;
    for (const physics::Joint& joint : world.joints) {
        if (joint.kind != physics::JointKind::kHinge || !joint.limits) continue;
        const auto in_degrees = [](double angle_rad) {
            return angle_rad * 180.0 / std::numbers::pi;
        };
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

}  // namespace

std::vector<std::string> doubts_about(const WorldDescription& world) {
    std::vector<std::string> lines;
    doubt_textures(world, lines);
    doubt_colours(world, lines);
    doubt_joints(world, lines);
    doubt_anchors(world, lines);
    doubt_limits(world, lines);
    doubt_soft_models(world, lines);
    doubt_starts(world, lines);
    return lines;
}

}  // namespace atrium::world_server
