#include "world_server/description/scenery_starts.hpp"

#include "core/geometry/solid_parts.hpp"
#include "core/geometry/surface_tree.hpp"
#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace

void doubt_starts_in_scenery(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldScenery& scenery : world.scenery) {
        if (!scenery.is_solid) continue;
        const Near near = find_near(world, scenery);
        if (!near.objects.empty() || !near.soft.empty()) doubt_starts_in(scenery, near, lines);
    }
}

}  // namespace atrium::world_server
