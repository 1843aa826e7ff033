#include "viewer/ui/wall.hpp"

#include "core/config/table_reader.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::viewer {
namespace {

constexpr config::Range kPlaceM{-1000.0, 1000.0};
constexpr double kLeastSideM = 0.01;
constexpr double kLeastDistanceM = 0.05;
constexpr double kRightAngle = 0.01;  // largest cosine of a rectangle's corner

Tile read_tile(config::TableReader& reader, const Eigen::Vector3d& eye_wall_m) {
    Tile tile;
    renderer::Screen& screen = tile.screen_wall;
    reader.require("name");
    reader.read("name", tile.name);
    const auto corner = [&](const char* key, Eigen::Vector3d& place) {
        reader.require(key);
        reader.read(key, place.data(), 3, kPlaceM);
    };
    corner("lower_left_m", screen.lower_left_m);
    corner("lower_right_m", screen.lower_right_m);
    corner("upper_left_m", screen.upper_left_m);
    const Eigen::Vector3d along = screen.lower_right_m - screen.lower_left_m;
    const Eigen::Vector3d up = screen.upper_left_m - screen.lower_left_m;
    if (!(along.norm() >= kLeastSideM) || !(up.norm() >= kLeastSideM)) {
        reader.reject("lower_left_m", "must be at least 1 cm from the other corners");
    } else if (!(std::abs(screen.right().dot(screen.up())) <= kRightAngle)) {
        reader.reject("upper_left_m", "must be at a right angle to lower_right_m");
    } else if (!(screen.normal().dot(eye_wall_m - screen.lower_left_m) >= kLeastDistanceM)) {
        reader.reject("lower_right_m",
                      "must be to the right of lower_left_m for the eye, which must be at least "
                      "5 cm before the tile");
    }
    return tile;
}

}  // namespace

const Tile* Wall::find(const std::string& tile) const {
    const auto found =
        std::find_if(tiles.begin(), tiles.end(), [&](const Tile& t) { return t.name == tile; });
    return found == tiles.end() ? nullptr : &*found;
}

std::string Wall::tile_names() const {
    std::string names;
    for (const Tile& tile : tiles) names += (names.empty() ? "" : ", ") + tile.name;
    return names;
}

Expected<Wall> load_wall(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    Wall wall;
    config::TableReader place = reader->table("wall");
    place.read("position_m", wall.world_from_wall.translation.data(), 3, kPlaceM);
    double yaw_deg = 0.0;
    place.read("yaw_deg", yaw_deg, {-360.0, 360.0});
    wall.world_from_wall.rotation =
        Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ());
    place.read("eye_m", wall.eye_wall_m.data(), 3, kPlaceM);
    reader->require("tile");
    for (config::TableReader& table : reader->tables("tile")) {
        Tile tile = read_tile(table, wall.eye_wall_m);
        if (wall.find(tile.name) != nullptr)
            table.reject("name", "must differ from the other tiles");
        wall.tiles.push_back(std::move(tile));
    }
    if (auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return wall;
}

}  // namespace atrium::viewer
