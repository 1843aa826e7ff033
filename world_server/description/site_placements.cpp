#include "world_server/description/site_placements.hpp"

#include "world_server/description/shared_entries.hpp"

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

}  // namespace

void read_placements(config::TableReader& reader, std::vector<NamedPlacement>& placements) {
    std::set<std::string> sites;
    for (config::TableReader& table : reader.tables("site")) {
        placements.push_back(read_placement(table));
        if (!sites.insert(placements.back().site).second)
            table.reject("name", "must be unique among the sites");
    }
}

}  // namespace atrium::world_server
