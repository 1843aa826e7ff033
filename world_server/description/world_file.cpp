#include "world_server/config.hpp"
#include "world_server/description/joints.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/objects.hpp"
#include "world_server/description/puppets.hpp"
#include "world_server/description/shared_entries.hpp"
#include "world_server/description/surroundings.hpp"

#include <optional>
#include <set>

namespace atrium::world_server {
namespace {

NamedPlacement read_placement(config::TableReader& reader) {
    NamedPlacement placement;
    read_name(reader, placement.site);
    reader.require("position_m");
    reader.read("position_m", placement.world_from_site.translation.data(), 3, kPositionRange);
    double yaw_deg = 0.0;
    reader.read("yaw_deg", yaw_deg, {-360.0, 360.0});
    placement.world_from_site.rotation =
        Eigen::AngleAxisd(kRadPerDeg * yaw_deg, Eigen::Vector3d::UnitZ());
    return placement;
}

void read_placements(config::TableReader& reader, std::vector<NamedPlacement>& placements) {
    std::set<std::string> sites;
    for (config::TableReader& table : reader.tables("site")) {
        placements.push_back(read_placement(table));
        if (!sites.insert(placements.back().site).second)
            table.reject("name", "must be unique among the sites");
    }
}

}  // namespace

void read_world(config::TableReader& reader, WorldServerConfig& config) {
    reader.read("world.gravity", config.world.gravity.data(), 3, {-100.0, 100.0});
    read_bounds(reader, config.world);
    const Materials materials = read_materials(reader);
    read_objects(reader, materials, config.objects);
    read_puppets(reader, materials, config.objects, config.joints);
    config.soft = read_soft_objects(reader,
                                    materials,
                                    static_cast<std::uint32_t>(config.objects.size() + 1),
                                    [&](const std::string& name) -> std::optional<std::uint32_t> {
                                        for (const WorldObject& object : config.objects) {
                                            if (object.scene.name == name)
                                                return object.scene.object;
                                        }
                                        return std::nullopt;
                                    });
    read_joints(reader, config.objects, config.joints);
    read_scenery(reader, materials, config.scenery);
    read_placements(reader, config.placements);
    read_rights(reader, config.rights);
}

}  // namespace atrium::world_server
