#include "world_server/description/objects.hpp"

#include "world_server/description/model_parts.hpp"
#include "world_server/description/shared_entries.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <tuple>

namespace atrium::world_server {
namespace {

constexpr double kLargestPlane_m = 1000.0;

using physics::ObjectShape;
// Hulls of the models in a world file: ten equal chairs share one set.
using KnownModels = std::map<std::tuple<std::string, double, ObjectShape>, LoadedModel>;

void read_model(config::TableReader& reader, WorldObject& object, KnownModels& known) {
    Look& look = object.look;
    physics::RigidObject& rigid = object.rigid;
    if (!read_model_name(reader, look.model, look.model_scale)) return;
    LoadedModel& model = known[{look.model, look.model_scale, rigid.shape}];
    if (!model.parts) {
        auto loaded = load_model_parts(file_of(reader, look.model), look.model_scale, rigid.shape);
        if (!loaded) return reject_model(reader, loaded.error());
        model = std::move(*loaded);
    }
    look.own_texture = model.own_texture;
    look.missing_materials = model.missing_materials;
    look.is_see_through = model.is_see_through;
    look.own_colours = model.own_colours;
    look.model_fingerprint = model.fingerprint;
    object.surface = model.surface;
    rigid.parts = model.parts;
    rigid.size_m = physics::extents_of(*model.parts);
}

void read_size(config::TableReader& reader, physics::RigidObject& object) {
    if (object.shape == ObjectShape::kBox) {
        reader.require("size_m");
        return reader.read("size_m", object.size_m.data(), 3, kSizeRange);
    }
    if (object.shape == ObjectShape::kPlane) {
        object.size_m = {10.0, 10.0, 0.0};
        return reader.read("size_m", object.size_m.data(), 2, {0.0, kLargestPlane_m});
    }
    double diameter_m = 0.0;
    reader.forbid("radius_m", "write diameter_m, twice the radius");
    reader.forbid("size_m",
                  object.shape == ObjectShape::kSphere ? "write diameter_m"
                                                       : "write diameter_m and height_m");
    reader.require("diameter_m");
    reader.read("diameter_m", diameter_m, kSizeRange);
    object.size_m.setConstant(diameter_m);
    if (object.shape == ObjectShape::kSphere) return;
    reader.require("height_m");
    reader.read("height_m", object.size_m.z(), kSizeRange);
}

ObjectShape read_shape(config::TableReader& reader) {
    static const std::map<std::string, ObjectShape> kShapes{
        {"box", ObjectShape::kBox},
        {"sphere", ObjectShape::kSphere},
        {"cylinder", ObjectShape::kCylinder},
        {"capsule", ObjectShape::kCapsule},
        {"plane", ObjectShape::kPlane},
        {"convex", ObjectShape::kConvex},
        {"compound", ObjectShape::kCompound},
    };
    std::string name = "box";
    reader.require("shape");
    reader.read(
        "shape", name, {"box", "sphere", "cylinder", "capsule", "plane", "convex", "compound"});
    return kShapes.at(name);
}

WorldObject read_object(config::TableReader& reader,
                        std::uint32_t id,
                        const Materials& materials,
                        KnownModels& known) {
    WorldObject object;
    physics::RigidObject& rigid = object.rigid;
    rigid.id = id;
    for (const char* key : {"fixed", "static"}) reader.forbid(key, "mass_kg = 0 makes it fixed");
    read_name(reader, object.name);
    rigid.shape = read_shape(reader);
    const bool has_model =
        rigid.shape == ObjectShape::kConvex || rigid.shape == ObjectShape::kCompound;
    if (has_model)
        read_model(reader, object, known);
    else
        read_size(reader, rigid);
    const Material material = read_material(reader, materials);
    rigid.friction = material.friction;
    rigid.restitution = material.restitution;
    rigid.rolling_friction_m = material.rolling_friction_m;
    object.look.colour = material.colour;
    object.look.texture = material.texture;
    if (rigid.shape == ObjectShape::kPlane)
        reader.read("mass_kg", rigid.mass_kg, {0.0, 1e4});
    else
        read_mass(
            reader, material, physics::volume_m3(to_rigid(object)), " (0: fixed)", rigid.mass_kg);
    read_texture(reader, object.look.texture);
    read_colour(reader, object.look.texture, object.look.own_colours, object.look.colour);
    read_pose(reader, rigid.world_from_object);
    object.where = reader.where("position_m");
    reader.read("friction", rigid.friction, {0.0, 10.0});
    reader.read("restitution", rigid.restitution, {0.0, 1.0});
    reader.read("rolling_friction_m", rigid.rolling_friction_m, {0.0, 1.0});
    reader.read("drag_per_s", rigid.drag_per_s, {0.0, 100.0});

    if (has_model && !rigid.parts) return object;  // already rejected
    if (const auto problem = physics::find_problem(to_rigid(object))) {
        std::string key(problem->field);
        if (key == "size_m" && !reader.has(key)) {
            key = has_model ? "scale" : reader.has("height_m") ? "height_m" : "diameter_m";
        }
        std::string allowed(problem->allowed);
        if (problem->field == "size_m" && !has_model) {
            allowed += ask_unit(rigid.size_m, [&](const Eigen::Vector3d& size_m) {
                physics::RigidObject smaller = to_rigid(object);
                smaller.size_m = size_m;
                const auto left = physics::find_problem(smaller);
                return !left || left->field != problem->field;
            });
        }
        if (key == "mass_kg" && reader.has(key) && has_model)
            allowed += ", or see its size: " + size_advice(rigid.size_m);
        if (key == "mass_kg" && !reader.has(key)) {
            key = reader.has("density_kg_per_m3") ? "density_kg_per_m3" : "material";
            allowed += mass_advice(physics::volume_m3(to_rigid(object)), rigid.mass_kg) +
                       ", or see its size: " +
                       (has_model ? size_advice(rigid.size_m)
                                  : fmt::format("it is {:.3g} x {:.3g} x {:.3g} m",
                                                rigid.size_m.x(),
                                                rigid.size_m.y(),
                                                rigid.size_m.z()));
        }
        if (key == "scale") allowed += "; " + size_advice(rigid.size_m);
        reader.reject(key, allowed);
    }
    return object;
}

}  // namespace

void read_objects(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects) {
    KnownModels known;
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("object")) {
        const auto id = static_cast<std::uint32_t>(objects.size() + 1);
        objects.push_back(read_object(table, id, materials, known));
        const std::string& name = objects.back().name;
        if (name == "world") table.reject("name", "must not be 'world', which joints use");
        if (!names.insert(name).second) table.reject("name", "must be unique among the objects");
    }
}

}  // namespace atrium::world_server
