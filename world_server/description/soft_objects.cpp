#include "world_server/description/soft_objects.hpp"

#include "core/geometry/weld.hpp"
#include "core/model/model_file.hpp"
#include "world_server/description/shared_entries.hpp"
#include "world_server/physics/soft/soft_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

namespace atrium::world_server {
namespace {

using physics::PinPlace;
using physics::SoftObject;
using physics::SoftShape;

geometry::TriangleMesh join(const std::vector<model::ModelPart>& parts) {
    geometry::TriangleMesh joined;
    for (const model::ModelPart& part : parts) {
        const auto first = static_cast<std::uint32_t>(joined.vertices.size());
        joined.vertices.insert(
            joined.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (const auto& t : part.mesh.triangles)
            joined.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    return joined;
}

void read_model(config::TableReader& table, WorldSoftObject& soft) {
    const std::string& file = soft.model;
    if (!read_model_name(table, soft.model, soft.model_scale)) return;
    const auto parts = model::load_model(file_of(table, file), soft.model_scale);
    if (!parts) return reject_model(table, parts.error());
    soft.own_texture = model::own_texture_of(*parts);
    soft.own_colours = model::colours_of(*parts);
    geometry::TriangleMesh mesh = geometry::weld(join(*parts));
    if (mesh.vertices.size() > physics::kMaxSoftNodes) {
        return table.reject("model",
                            fmt::format("must have at most {} distinct vertices, {} has {}",
                                        physics::kMaxSoftNodes,
                                        file,
                                        mesh.vertices.size()));
    }
    soft.object.model = std::move(mesh);
}

void read_length(config::TableReader& table, const std::string& key, double& value) {
    table.require(key);
    table.read(key, value, kSizeRange);
}

void read_size(config::TableReader& table, WorldSoftObject& soft, const std::string& shape) {
    SoftObject& object = soft.object;
    Eigen::Vector3d& size = object.size_m;
    if (shape == "cloth") {
        object.shape = SoftShape::kCloth;
        object.damping_hz = 1.5;  // air drag of a large surface
        table.require("size_m");
        table.read("size_m", size.data(), 2, kSizeRange);
        table.read("thickness_m", size.z(), kSizeRange);
        if (table.has("span_m")) table.read("span_m", object.span_m.emplace(), kSizeRange);
    } else if (shape == "rope") {
        object.shape = SoftShape::kRope;
        read_length(table, "length_m", size.x());
        read_length(table, "diameter_m", size.y());
        size.z() = size.x();
        table.read("span_m", size.z(), kSizeRange);
    } else if (shape == "ball") {
        object.shape = SoftShape::kBall;
        double diameter_m = 0.0;
        read_length(table, "diameter_m", diameter_m);
        size.setConstant(diameter_m);
    } else if (shape == "model") {
        object.shape = SoftShape::kModel;
        read_model(table, soft);
    } else {
        object.shape = SoftShape::kBox;
        table.require("size_m");
        table.read("size_m", size.data(), 3, kSizeRange);
    }
}

// Reads the places of `pins` or `tied`.
std::vector<PinPlace> read_places(config::TableReader& table,
                                  const std::string& key,
                                  SoftShape shape) {
    std::vector<std::string> names;
    table.read(key, names);
    if (names.empty()) return {};
    const bool is_cloth = shape == SoftShape::kCloth;
    if (!is_cloth && shape != SoftShape::kRope) {
        table.reject(key, "must be left out: only a cloth and a rope can be attached");
        return {};
    }
    constexpr std::array kAll{PinPlace::kLeft,
                              PinPlace::kRight,
                              PinPlace::kTop,
                              PinPlace::kBottom,
                              PinPlace::kTopCorners,
                              PinPlace::kCorners};
    const std::span allowed = std::span(kAll).first(is_cloth ? kAll.size() : 2);
    std::vector<PinPlace> places;
    for (const std::string& name : names) {
        const auto place =
            std::ranges::find(allowed, name, [&](PinPlace one) { return pin_name(one, shape); });
        if (place == allowed.end()) {
            table.reject(key,
                         is_cloth
                             ? "must be of top, bottom, left, right, top corners, corners for a "
                               "cloth"
                             : "must be of start, end for a rope");
            return {};
        }
        places.push_back(*place);
    }
    return places;
}

// What is wrong with the number of names in `tied_to`; empty: nothing.
std::string problem_of_holders(const std::vector<std::string>& names,
                               const std::vector<PinPlace>& places,
                               SoftShape shape) {
    if (names.size() == 1) return {};
    if (names.empty()) return "must be the name of an [[object]]";
    if (shape != SoftShape::kRope)
        return "must be one name: only a rope can be tied to two objects, one per end";
    if (names.size() > 2)
        return "must be one name, or two: those of the objects at the two ends of the rope";
    if (names[0] == names[1])
        return "must be two different objects; if both ends are tied to one, write its name alone";
    if (places.size() != 2 || places[0] == places[1]) {
        return "must be one name, unless tied has both ends: two names belong to "
               "tied = [\"start\", \"end\"], in this order";
    }
    return {};
}

// Reads `tied` and `tied_to`: one of `rigid` for all places, or one for each end of a rope.
void read_ties(config::TableReader& table,
               const std::vector<WorldObject>& rigid,
               SoftObject& object) {
    if (table.has("tied") && !table.has("tied_to")) table.reject("tied", "needs tied_to");
    if (!table.has("tied_to")) return;
    std::vector<std::string> names(1);
    if (table.has_array("tied_to"))
        table.read("tied_to", names);
    else
        table.read("tied_to", names.front());
    std::vector<std::uint32_t> holders;
    for (const std::string& name : names) {
        const WorldObject* holder = find_object(rigid, name);
        holders.push_back(holder == nullptr ? 0 : holder->rigid.id);
        if (holder != nullptr) continue;
        const std::string meant = object_meant_by(name, rigid);
        table.reject("tied_to",
                     "must be the name of an [[object]]" +
                         (meant.empty() ? "; what hangs from scenery or the world has pins "
                                          "instead of tied and tied_to"
                                        : meant));
    }
    table.require("tied");
    const std::vector<PinPlace> places = read_places(table, "tied", object.shape);
    const std::string problem = problem_of_holders(names, places, object.shape);
    if (!problem.empty()) return table.reject("tied_to", problem);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::uint32_t holder = holders.size() == 1 ? holders.front() : holders[i];
        object.pins.push_back({.place = places[i], .object_id = holder});
    }
}

void read_nodes(config::TableReader& table, SoftObject& object) {
    const std::size_t num_nodes = physics::make_soft_mesh(object).nodes.size();
    std::vector<double> places(3 * num_nodes);
    table.read("nodes_m", places.data(), places.size(), {-1000.0, 1000.0});
    for (std::size_t i = 0; i < num_nodes; ++i)
        object.start_nodes.push_back(
            Eigen::Map<const Eigen::Vector3d>(&places[3 * i]).cast<float>());
}

void reject_soft(config::TableReader& table,
                 const SoftObject& object,
                 const physics::ObjectProblem& problem) {
    std::string key(problem.field);
    std::string allowed(problem.allowed);
    const bool has_model = object.shape == SoftShape::kModel;
    if (key == "size_m") {
        allowed += ask_unit(object.size_m, [&](const Eigen::Vector3d& size_m) {
            SoftObject smaller = object;
            smaller.size_m = size_m;
            if (object.shape == SoftShape::kCloth && !table.has("thickness_m"))
                smaller.size_m.z() = object.size_m.z();  // not written
            const auto left = physics::find_problem(smaller);
            return !left || left->field != problem.field;
        });
    }
    if (key == "mass_kg" && !table.has(key)) {
        key = table.has("density_kg_per_m3") ? "density_kg_per_m3" : "material";
        allowed += mass_advice(physics::volume_m3(object), object.mass_kg);
        if (has_model) allowed += ", or see its size: " + size_advice(bounds(object.model).size());
    }
    for (const char* instead : {"diameter_m", "length_m"}) {
        if (key == "size_m" && !table.has(key) && table.has(instead)) key = instead;
    }
    if (key == "spacing_m" && !table.has(key))
        allowed += fmt::format("; the default is {:.2f} m", object.spacing_m);
    if (key == "scale") allowed += "; " + size_advice(bounds(object.model).size());
    table.reject(key, allowed);
}

WorldSoftObject read_soft_object(config::TableReader& table,
                                 const Materials& materials,
                                 const std::vector<WorldObject>& rigid) {
    WorldSoftObject soft;
    SoftObject& object = soft.object;
    read_name(table, soft.name);
    std::string shape;
    table.require("shape");
    table.read("shape", shape, {"cloth", "rope", "ball", "box", "model"});
    read_size(table, soft, shape);
    if (object.shape != SoftShape::kModel) table.read("spacing_m", object.spacing_m, kSizeRange);
    const bool has_model = object.shape == SoftShape::kModel;
    if (has_model && object.model.empty()) return soft;  // already rejected
    const Material material = read_material(table, materials);
    object.friction = material.friction;
    soft.colour = material.colour;
    read_mass(table, material, physics::volume_m3(object), "", object.mass_kg);
    table.read("stiffness", object.stiffness, {0.0, 1.0});
    table.read("damping_hz", object.damping_hz, {0.0, 100.0});
    table.read("friction", object.friction, {0.0, 10.0});
    read_texture(table, soft.texture);
    read_colour(table, soft.texture, soft.own_colours, soft.colour);
    read_pose(table, object.world_from_object);
    soft.where = table.where("position_m");
    for (const PinPlace place : read_places(table, "pins", object.shape))
        object.pins.push_back({.place = place});
    read_ties(table, rigid, object);

    if (const auto problem = physics::find_problem(object)) {
        reject_soft(table, object, *problem);
    } else if (table.has("nodes_m")) {
        read_nodes(table, object);
    }
    return soft;
}

}  // namespace

std::string pin_name(PinPlace place, SoftShape shape) {
    switch (place) {
        case PinPlace::kTop:
            return "top";
        case PinPlace::kBottom:
            return "bottom";
        case PinPlace::kLeft:
            return shape == SoftShape::kRope ? "start" : "left";
        case PinPlace::kRight:
            return shape == SoftShape::kRope ? "end" : "right";
        case PinPlace::kTopCorners:
            return "top corners";
        case PinPlace::kCorners:
        case PinPlace::kPoint:
            break;
    }
    return "corners";
}

std::vector<WorldSoftObject> read_soft_objects(config::TableReader& reader,
                                               const Materials& materials,
                                               const std::vector<WorldObject>& rigid) {
    std::vector<WorldSoftObject> objects;
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("soft")) {
        objects.push_back(read_soft_object(table, materials, rigid));
        WorldSoftObject& soft = objects.back();
        soft.object.id = static_cast<std::uint32_t>(rigid.size() + objects.size());
        if (!names.insert(soft.name).second || find_object(rigid, soft.name) != nullptr) {
            table.reject("name", "must be unique among the objects");
        }
    }
    return objects;
}

}  // namespace atrium::world_server
