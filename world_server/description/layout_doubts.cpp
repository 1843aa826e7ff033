#include "world_server/description/layout_doubts.hpp"

#include "core/geometry/aabb.hpp"
#include "world_server/description/start_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>

namespace atrium::world_server {
namespace {

constexpr double kSamePlace_m = 0.5;  // people are about as wide
constexpr double kNarrowestFloor_m = 2.0;

void doubt_empty(const WorldDescription& world, std::vector<std::string>& lines) {
    if (!world.objects.empty() || !world.soft.empty() || !world.scenery.empty()) return;
    lines.push_back(fmt::format(
        "world_looks_wrong reason=\"{} has no objects: {}\"",
        world.objects_at.empty() ? "the world" : world.objects_at,
        world.objects_at.empty() ? "give a world file with --config" : "add [[object]] tables"));
}

// The objects that joints hold, directly or by others, in the world or at fixed objects; and those.
std::set<std::uint32_t> hanging_in(const WorldDescription& world) {
    std::set<std::uint32_t> hanging{0};  // the world
    for (const WorldObject& object : world.objects)
        if (object.rigid.mass_kg == 0.0) hanging.insert(object.rigid.id);
    for (std::size_t before = 0; before != hanging.size();) {
        before = hanging.size();
        for (const physics::Joint& joint : world.joints) {
            if (!hanging.contains(joint.a) && !hanging.contains(joint.b)) continue;
            hanging.insert(joint.a);
            hanging.insert(joint.b);
        }
    }
    return hanging;
}

void doubt_floor(const WorldDescription& world, std::vector<std::string>& lines) {
    if (world.world.gravity.norm() == 0.0) return;
    const auto is_fixed = [](const WorldObject& object) { return object.rigid.mass_kg == 0.0; };
    if (std::ranges::any_of(world.objects, is_fixed) ||
        std::ranges::any_of(world.scenery, &WorldScenery::is_solid))
        return;
    const std::set<std::uint32_t> hanging = hanging_in(world);
    const auto falls = [&](const WorldObject& object) {
        return !hanging.contains(object.rigid.id);
    };
    const auto is_loose = [](const WorldSoftObject& soft) { return soft.object.pins.empty(); };
    if (std::ranges::none_of(world.objects, falls) && std::ranges::none_of(world.soft, is_loose))
        return;
    lines.push_back(
        fmt::format("world_looks_wrong reason=\"nothing carries what falls: add a floor, an "
                    "[[object]] with shape = plane{}\"",
                    world.scenery.empty() ? "" : ", or make scenery solid"));
}

bool is_floor_like(const geometry::Aabb& box) {
    const double width_m = std::min(box.size().x(), box.size().y());
    return width_m >= kNarrowestFloor_m && box.size().z() <= 0.25 * width_m;
}

// A floor that somebody forgot to fix falls, and all that stands on it. Names the lowest one.
void doubt_falling(const WorldDescription& world, std::vector<std::string>& lines) {
    if (world.world.gravity.z() >= 0.0) return;
    std::vector<geometry::Aabb> carriers;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg == 0.0) {
            if (object.rigid.shape == physics::ObjectShape::kPlane) return;
            carriers.push_back(start_box_of(to_rigid(object)));
        }
    }
    for (const WorldScenery& scenery : world.scenery)
        if (scenery.is_solid) carriers.push_back(scenery.box);
    if (carriers.empty()) return;  // see doubt_floor
    const auto may_carry = [](const geometry::Aabb& carrier, const geometry::Aabb& box) {
        return carrier.min.x() < box.max.x() && carrier.max.x() > box.min.x() &&
               carrier.min.y() < box.max.y() && carrier.max.y() > box.min.y() &&
               carrier.min.z() < box.max.z();
    };
    const std::set<std::uint32_t> hanging = hanging_in(world);
    const WorldObject* lowest = nullptr;
    double lowest_z = 0.0;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg == 0.0 || hanging.contains(object.rigid.id)) continue;
        const geometry::Aabb box = start_box_of(to_rigid(object));
        if (!is_floor_like(box) ||
            std::ranges::any_of(carriers, [&](const auto& c) { return may_carry(c, box); }))
            continue;
        if (lowest != nullptr && box.min.z() >= lowest_z) continue;
        lowest = &object;
        lowest_z = box.min.z();
    }
    if (lowest == nullptr) return;
    lines.push_back(
        fmt::format("object_looks_wrong name={} reason=\"nothing fixed is below it, so it falls "
                    "out of the world: mass_kg = 0 makes a floor or a table fixed\"",
                    lowest->name));
}

void doubt_sites(const WorldDescription& world, std::vector<std::string>& lines) {
    for (std::size_t i = 0; i < world.placements.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const NamedPlacement& site = world.placements[i];
            const NamedPlacement& other = world.placements[k];
            const double apart_m =
                (site.world_from_site.translation - other.world_from_site.translation).norm();
            if (apart_m >= kSamePlace_m) continue;
            lines.push_back(
                fmt::format("site_looks_wrong name={} reason=\"it is {:.2g} m from the site {}, so "
                            "their people stand inside each other: move it with position_m\"",
                            site.site,
                            apart_m,
                            other.site));
            break;
        }
    }
}

}  // namespace

void doubt_layout(const WorldDescription& world, std::vector<std::string>& lines) {
    doubt_empty(world, lines);
    doubt_floor(world, lines);
    doubt_falling(world, lines);
    doubt_sites(world, lines);
}

}  // namespace atrium::world_server
