#include "world_server/config.hpp"

#include "core/bus/bus_options.hpp"
#include "core/bus/checks.hpp"
#include "world_server/scene.hpp"

#include <fmt/format.h>

#include <numbers>
#include <set>

namespace atrium::world_server {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr config::Range kPosition{-1000.0, 1000.0};  // [m]
constexpr config::Range kSize{0.0, 1000.0};          // [m]; the physics narrows it

Eigen::Quaterniond from_roll_pitch_yaw(const Eigen::Vector3d& angles_rad) {
    return Eigen::AngleAxisd(angles_rad.z(), Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(angles_rad.y(), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(angles_rad.x(), Eigen::Vector3d::UnitX());
}

void read_size(config::TableReader& reader, bus::SceneObject& object, const std::string& shape) {
    if (shape == "box") {
        object.shape = bus::Shape::kBox;
        reader.require("size_m");
        return reader.read("size_m", object.size_m.data(), 3, kSize);
    }
    if (shape == "plane") {
        object.shape = bus::Shape::kPlane;
        object.size_m = {10.0, 10.0, 0.0};
        return reader.read("size_m", object.size_m.data(), 2, kSize);
    }
    double diameter_m = 0.0;
    reader.require("diameter_m");
    reader.read("diameter_m", diameter_m, kSize);
    object.size_m.setConstant(diameter_m);
    if (shape == "sphere") {
        object.shape = bus::Shape::kSphere;
        return;
    }
    object.shape = shape == "cylinder" ? bus::Shape::kCylinder : bus::Shape::kCapsule;
    reader.require("height_m");
    reader.read("height_m", object.size_m.z(), kSize);
}

WorldObject read_object(config::TableReader& reader, std::uint32_t id) {
    WorldObject object;
    object.scene.object = id;
    reader.require("name");
    reader.read("name", object.scene.name);
    if (!bus::is_valid_name(object.scene.name)) {
        reader.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
    }
    std::string shape;
    reader.require("shape");
    reader.read("shape", shape, {"box", "sphere", "cylinder", "capsule", "plane"});
    read_size(reader, object.scene, shape);
    if (shape != "plane") reader.require("mass_kg");
    reader.read("mass_kg", object.scene.mass_kg, {0.0, 1e4});
    reader.read("colour", object.scene.colour.data(), 3, {0.0, 1.0});
    geometry::RigidTransform& pose = object.scene.world_from_object;
    reader.read("position_m", pose.translation.data(), 3, kPosition);
    Eigen::Vector3d angles_deg = Eigen::Vector3d::Zero();
    reader.read("roll_pitch_yaw_deg", angles_deg.data(), 3, {-360.0, 360.0});
    pose.rotation = from_roll_pitch_yaw(kRadPerDeg * angles_deg);
    reader.read("friction", object.friction, {0.0, 10.0});
    reader.read("restitution", object.restitution, {0.0, 1.0});

    if (const auto problem = physics::find_problem(to_rigid(object))) {
        std::string key(problem->field);
        if (key == "size_m" && !reader.has(key)) {
            key = reader.has("height_m") ? "height_m" : "diameter_m";
        }
        reader.reject(key, std::string(problem->allowed));
    }
    return object;
}

NamedPlacement read_placement(config::TableReader& reader) {
    NamedPlacement placement;
    reader.require("name");
    reader.read("name", placement.site);
    if (!bus::is_valid_name(placement.site)) {
        reader.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
    }
    reader.require("position_m");
    reader.read("position_m", placement.world_from_site.translation.data(), 3, kPosition);
    double yaw_deg = 0.0;
    reader.read("yaw_deg", yaw_deg, {-360.0, 360.0});
    placement.world_from_site.rotation =
        Eigen::AngleAxisd(kRadPerDeg * yaw_deg, Eigen::Vector3d::UnitZ());
    return placement;
}

}  // namespace

void declare(WorldServerConfig& config, config::OptionSet& set) {
    set.add("world.tick_hz", config.tick_hz, "steps of the simulation per second [Hz]", {30, 1000});
    set.add("world.send_hz", config.send_hz, "states published per second [Hz]", {1, 1000});
    set.add("world.seconds", config.seconds, "how long to run [s]; 0: until Ctrl-C", {0, 1e9});
    set.add(
        "world.max_objects", config.max_objects, "objects at most, added ones included", {1, 2048});
    set.add("world.max_sites", config.max_sites, "sites at most; later ones are refused", {1, 64});
    physics::WorldOptions& world = config.world;
    set.add("world.half_extent_m",
            world.half_extent_m,
            "an object further out than this along x, y or z is put back [m]",
            {1, 1000});
    set.add("world.lowest_z_m",
            world.lowest_z_m,
            "an object lower than this is put back [m]",
            {-1000, 0});
    set.add(
        "physics.max_speed_mps", world.max_speed_mps, "speed limit of objects [m/s]", {0.1, 100});
    set.add("physics.person_friction", world.person_friction, "friction of people", {0, 10});
    set.add("physics.person_restitution", world.person_restitution, "bounce of people", {0, 1});
    physics::PersonShapeOptions& person = config.person;
    set.add("physics.region_m",
            person.motion.region_m,
            "side of the parts of a person that move as one [m]",
            {0.05, 1});
    set.add("physics.person_max_speed_mps",
            person.max_speed_mps,
            "speed limit of people's surfaces [m/s]",
            {0.1, 50});
    set.add("physics.person_rest_speed_mps",
            person.rest_speed_mps,
            "slower surfaces count as flickering outlines at rest [m/s]",
            {0.001, 1});
    bus::declare(config.bus, set);
}

void read_world(config::TableReader& reader, WorldServerConfig& config) {
    reader.read("world.gravity", config.world.gravity.data(), 3, {-100.0, 100.0});
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("object")) {
        const auto id = static_cast<std::uint32_t>(config.objects.size() + 1);
        config.objects.push_back(read_object(table, id));
        if (!names.insert(config.objects.back().scene.name).second) {
            table.reject("name", "must be unique among the objects");
        }
    }
    std::set<std::string> sites;
    for (config::TableReader& table : reader.tables("site")) {
        config.placements.push_back(read_placement(table));
        if (!sites.insert(config.placements.back().site).second) {
            table.reject("name", "must be unique among the sites");
        }
    }
}

Expected<void> check(const WorldServerConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (config.send_hz > config.tick_hz) {
        return wrong(fmt::format("world.send_hz: must not exceed world.tick_hz ({}), got {}",
                                 config.tick_hz,
                                 config.send_hz));
    }
    if (config.objects.size() > static_cast<std::size_t>(config.max_objects)) {
        return wrong(
            fmt::format("world.max_objects: must be at least the {} objects described, got {}",
                        config.objects.size(),
                        config.max_objects));
    }
    if (config.placements.size() > static_cast<std::size_t>(config.max_sites)) {
        return wrong(fmt::format("world.max_sites: must be at least the {} sites described, got {}",
                                 config.placements.size(),
                                 config.max_sites));
    }
    return {};
}

}  // namespace atrium::world_server
