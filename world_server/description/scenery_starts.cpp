#include "world_server/description/scenery_starts.hpp"

#include "core/geometry/solid_parts.hpp"
#include "core/geometry/surface_tree.hpp"
#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>

namespace atrium::world_server {
namespace {

// A closed surface as large as a person along each axis may be a room that was modelled with its
// faces outwards: people and things stand in it.
constexpr double kRoom_m = 1.8;

std::string describe(const WorldScenery& scenery) {
    const Eigen::Vector3d size_m = scenery.box.size();
    return fmt::format(
        "{}, which is solid scenery of {:.2g} x {:.2g} x {:.2g} m: check its scale, or, if that is "
        "right",
        scenery.name,
        size_m.x(),
        size_m.y(),
        size_m.z());
}

constexpr double kStands_m = 0.02;  // of its lowest place above or below a surface

// The things that may be in a piece of scenery.
struct Near {
    std::vector<const WorldObject*> objects;
    std::vector<const WorldSoftObject*> soft;
};

Near find_near(const WorldDescription& world, const WorldScenery& scenery) {
    Near near;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg == 0.0 || object.rigid.shape == physics::ObjectShape::kPlane)
            continue;
        if (touch(start_box_of(to_rigid(object)), scenery.box)) near.objects.push_back(&object);
    }
    for (const WorldSoftObject& soft : world.soft)
        if (touch(start_box_of(soft.object), scenery.box)) near.soft.push_back(&soft);
    return near;
}

void doubt_starts_in(const WorldScenery& scenery,
                     const Near& near,
                     std::vector<std::string>& lines) {
    const geometry::SurfaceTree bodies(geometry::solid_parts(scenery.mesh, kRoom_m));
    std::vector<DeepStart> deep;
    for (const WorldObject* object : near.objects) {
        const auto depth_of = [&](const physics::RigidObject& pose) {
            return std::max(physics::overlap_m(pose, scenery.mesh), physics::depth_m(pose, bodies));
        };
        const double depth_m = depth_of(to_rigid(*object));
        if (depth_m <= kDeepRigid_m) continue;
        deep.push_back({object, depth_m, describe(scenery), cure_of(*object, depth_of)});
    }
    add_lines(deep, lines);
    for (const WorldSoftObject* soft : near.soft) {
        const double depth_m = physics::depth_m(soft->object, bodies);
        if (depth_m <= kDeepSoft_m) continue;
        lines.push_back(
            fmt::format("soft_looks_wrong name={} reason=\"starts {:.2f} m inside {}: move it with "
                        "position_m\"",
                        soft->name,
                        depth_m,
                        describe(scenery)));
    }
}

// The height of a triangle above a place; empty if it is elsewhere, or too steep to stand on.
std::optional<double> height_at(const Eigen::Vector2d& place,
                                const std::array<Eigen::Vector3d, 3>& corners) {
    constexpr double kLeastUp = 0.7;
    const auto& [a, b, c] = corners;
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double length = normal.norm();
    if (!(std::abs(normal.z()) > kLeastUp * length)) return std::nullopt;
    const auto side = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        const Eigen::Vector2d along = (to - from).head<2>(), at = place - from.head<2>();
        return along.x() * at.y() - along.y() * at.x();
    };
    const std::array sides{side(a, b), side(b, c), side(c, a)};
    const auto [low, high] = std::ranges::minmax(sides);
    if (low < 0.0 && high > 0.0) return std::nullopt;
    return a.z() - (normal.head<2>().dot(place - a.head<2>())) / normal.z();
}

bool stands_on(const geometry::Aabb& box, const WorldScenery& scenery) {
    const Eigen::Vector2d middle = box.centre().head<2>();
    const auto& [vertices, triangles] = std::tie(scenery.mesh.vertices, scenery.mesh.triangles);
    return std::ranges::any_of(triangles, [&](const auto& t) {
        const auto height_m = height_at(middle, {vertices[t[0]], vertices[t[1]], vertices[t[2]]});
        return height_m && std::abs(*height_m - box.min.z()) < kStands_m;
    });
}

// By any object, also a movable one, or solid scenery.
bool is_carried(const WorldObject& object, const WorldDescription& world) {
    physics::RigidObject lower = to_rigid(object);
    lower.world_from_object.translation.z() -= 2.0 * kStands_m;
    const geometry::Aabb box = start_box_of(lower);
    for (const WorldObject& other : world.objects) {
        if (other.rigid.id == object.rigid.id) continue;
        const bool is_plane = other.rigid.shape == physics::ObjectShape::kPlane;
        if (!is_plane && !touch(box, start_box_of(to_rigid(other)))) continue;
        if (physics::overlap_m(lower, to_rigid(other)) > 0.0) return true;
    }
    return std::ranges::any_of(world.scenery, [&](const WorldScenery& scenery) {
        return scenery.is_solid && touch(box, scenery.box) &&
               physics::overlap_m(lower, scenery.mesh) > 0.0;
    });
}

bool is_joined(const WorldObject& object, const WorldDescription& world) {
    return std::ranges::any_of(world.joints, [&](const physics::Joint& joint) {
        return joint.a == object.rigid.id || joint.b == object.rigid.id;
    });
}

}  // namespace

void doubt_starts_on_scenery(const WorldDescription& world, std::vector<std::string>& lines) {
    if (world.world.gravity.z() >= 0.0) return;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg == 0.0 || is_joined(object, world)) continue;
        const geometry::Aabb box = start_box_of(to_rigid(object));
        const auto scenery = std::ranges::find_if(world.scenery, [&](const WorldScenery& piece) {
            geometry::Aabb around = piece.box;
            around.max.z() += kStands_m;
            return !piece.is_solid && touch(box, around) && stands_on(box, piece);
        });
        if (scenery == world.scenery.end() || is_carried(object, world)) continue;
        lines.push_back(
            fmt::format("object_looks_wrong name={} reason=\"starts on {}, scenery that "
                        "is not solid, and falls through it: write solid = true for {}\"",
                        object.name,
                        scenery->name,
                        scenery->name));
    }
}

void doubt_starts_in_scenery(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldScenery& scenery : world.scenery) {
        if (!scenery.is_solid) continue;
        const Near near = find_near(world, scenery);
        if (!near.objects.empty() || !near.soft.empty()) doubt_starts_in(scenery, near, lines);
    }
}

}  // namespace atrium::world_server
