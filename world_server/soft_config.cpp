#include "world_server/soft_config.hpp"

#include "core/bus/checks.hpp"

#include <array>
#include <map>
#include <numbers>
#include <set>

namespace atrium::world_server {
namespace {

using physics::PinPlace;
using physics::SoftObject;
using physics::SoftShape;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr config::Range kPosition{-1000.0, 1000.0};  // [m]
constexpr config::Range kSize{0.0, 1000.0};          // [m]; the physics narrows it

void read_length(config::TableReader& table, const std::string& key, double& value) {
    table.require(key);
    table.read(key, value, kSize);
}

void read_size(config::TableReader& table, SoftObject& object, const std::string& shape) {
    Eigen::Vector3d& size = object.size_m;
    if (shape == "cloth") {
        object.shape = SoftShape::kCloth;
        object.damping_hz = 1.5;  // it has much air to move
        table.require("size_m");
        table.read("size_m", size.data(), 2, kSize);
        table.read("thickness_m", size.z(), kSize);
    } else if (shape == "rope") {
        object.shape = SoftShape::kRope;
        read_length(table, "length_m", size.x());
        read_length(table, "diameter_m", size.y());
        size.z() = size.x();
        table.read("span_m", size.z(), kSize);
    } else if (shape == "ball") {
        object.shape = SoftShape::kBall;
        double diameter_m = 0.0;
        read_length(table, "diameter_m", diameter_m);
        size.setConstant(diameter_m);
    } else {
        object.shape = SoftShape::kBox;
        table.require("size_m");
        table.read("size_m", size.data(), 3, kSize);
    }
}

// `pins` hold still, `tied` hold on to the rigid object `tied_to`.
void read_pins(config::TableReader& table,
               const std::string& key,
               std::uint32_t object_id,
               SoftObject& object) {
    static const std::map<std::string, PinPlace> kPlaces{{"top", PinPlace::kTop},
                                                         {"bottom", PinPlace::kBottom},
                                                         {"left", PinPlace::kLeft},
                                                         {"right", PinPlace::kRight},
                                                         {"top corners", PinPlace::kTopCorners},
                                                         {"corners", PinPlace::kCorners},
                                                         {"start", PinPlace::kLeft},
                                                         {"end", PinPlace::kRight}};
    std::vector<std::string> names;
    table.read(key, names);
    for (const std::string& name : names) {
        const auto place = kPlaces.find(name);
        if (place == kPlaces.end()) {
            table.reject(key,
                         "must be of top, bottom, left, right, top corners, corners (a cloth), "
                         "start, end (a rope), got '" +
                             name + "'");
            return;
        }
        object.pins.push_back({.place = place->second, .object_id = object_id});
    }
}

WorldSoftObject read_soft_object(
    config::TableReader& table,
    const std::function<std::optional<std::uint32_t>(const std::string& name)>& id_of) {
    WorldSoftObject soft;
    SoftObject& object = soft.object;
    table.require("name");
    table.read("name", soft.name);
    if (!bus::is_valid_name(soft.name)) {
        table.reject("name", "must be 1 to 63 characters of A-Z a-z 0-9 _ . -");
    }
    std::string shape;
    table.require("shape");
    table.read("shape", shape, {"cloth", "rope", "ball", "box"});
    read_size(table, object, shape);
    table.read("spacing_m", object.spacing_m, kSize);
    table.require("mass_kg");
    table.read("mass_kg", object.mass_kg, {0.0, 1e4});
    table.read("stiffness", object.stiffness, {0.0, 1.0});
    table.read("damping_hz", object.damping_hz, {0.0, 100.0});
    table.read("friction", object.friction, {0.0, 10.0});
    table.read("colour", soft.colour.data(), 3, {0.0, 1.0});
    geometry::RigidTransform& pose = object.world_from_object;
    table.read("position_m", pose.translation.data(), 3, kPosition);
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();
    table.read("roll_pitch_yaw_deg", angles.data(), 3, {-360.0, 360.0});
    angles *= kRadPerDeg;
    pose.rotation = Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
    read_pins(table, "pins", 0, object);
    if (table.has("tied_to")) {
        std::string name;
        table.read("tied_to", name);
        const auto id = id_of(name);
        if (!id) table.reject("tied_to", "must be the name of an [[object]]");
        table.require("tied");
        read_pins(table, "tied", id.value_or(0), object);
    }

    if (const auto problem = physics::find_problem(object)) {
        std::string key(problem->field);
        for (const char* instead : {"diameter_m", "length_m"}) {
            if (key == "size_m" && !table.has(key) && table.has(instead)) key = instead;
        }
        table.reject(key, std::string(problem->allowed));
    }
    return soft;
}

}  // namespace

std::vector<WorldSoftObject> read_soft_objects(
    config::TableReader& reader,
    std::uint32_t first_id,
    const std::function<std::optional<std::uint32_t>(const std::string& name)>& id_of) {
    std::vector<WorldSoftObject> objects;
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("soft")) {
        objects.push_back(read_soft_object(table, id_of));
        WorldSoftObject& soft = objects.back();
        soft.object.id = first_id + static_cast<std::uint32_t>(objects.size()) - 1;
        if (!names.insert(soft.name).second || id_of(soft.name)) {
            table.reject("name", "must be unique among the objects");
        }
    }
    return objects;
}

}  // namespace atrium::world_server
