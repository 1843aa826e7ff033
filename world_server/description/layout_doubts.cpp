#include "world_server/description/layout_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>

namespace atrium::world_server {
namespace {

constexpr double kSamePlace_m = 0.5;  // people are about as wide

void doubt_empty(const WorldDescription& world, std::vector<std::string>& lines) {
    if (!world.objects.empty() || !world.soft.empty() || !world.scenery.empty()) return;
    lines.push_back(fmt::format(
        "world_looks_wrong reason=\"{} has no objects: {}\"",
        world.objects_at.empty() ? "the world" : world.objects_at,
        world.objects_at.empty() ? "give a world file with --config" : "add [[object]] tables"));
}

// The objects that joints hold, directly or by others, in the world.
std::set<std::uint32_t> hanging_in(const WorldDescription& world) {
    std::set<std::uint32_t> hanging{0};  // the world
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
    doubt_sites(world, lines);
}

}  // namespace atrium::world_server
