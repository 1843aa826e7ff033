#include "world_server/description/objects.hpp"

#include "core/model/model_file.hpp"
#include "world_server/description/shared_entries.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <fmt/format.h>

#include <map>
#include <set>
#include <string>
#include <tuple>

namespace atrium::world_server {
namespace {

using Parts = std::vector<geometry::TriangleMesh>;

// Hulls of the models in a world file: ten equal chairs share one set.
using KnownParts =
    std::map<std::tuple<std::string, double, bus::Shape>, std::shared_ptr<const Parts>>;

void append(std::vector<Eigen::Vector3d>& points, const geometry::TriangleMesh& mesh) {
    points.insert(points.end(), mesh.vertices.begin(), mesh.vertices.end());
}

// Creates the hulls. Convex: one hull around everything; compound: one hull per part of the file.
Expected<Parts> make_parts(const std::vector<model::ModelPart>& model, bus::Shape shape) {
    Parts parts;
    std::vector<Eigen::Vector3d> points;
    for (const model::ModelPart& part : model) {
        if (shape == bus::Shape::kCompound) points.clear();
        append(points, part.mesh);
        if (shape == bus::Shape::kConvex && &part != &model.back()) continue;
        parts.push_back(physics::convex_hull(points, physics::kMaxHullVertices));
        if (parts.back().empty()) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("part '{}' has no volume", part.name));
        }
    }
    return parts;
}

void read_model(config::TableReader& reader, WorldObject& object, KnownParts& known) {
    bus::SceneObject& scene = object.scene;
    if (!read_model_name(reader, scene.model, scene.model_scale)) return;
    std::shared_ptr<const Parts>& parts = known[{scene.model, scene.model_scale, scene.shape}];
    if (!parts) {
        const auto model = model::load_model(reader.folder() / scene.model, scene.model_scale);
        if (!model) return reader.reject("model", model.error().message);
        auto made = make_parts(*model, scene.shape);
        if (!made) return reader.reject("model", made.error().message);
        parts = std::make_shared<const Parts>(std::move(*made));
    }
    object.parts = parts;
    scene.size_m = physics::extents_of(*parts);
}

void read_size(config::TableReader& reader, bus::SceneObject& object) {
    if (object.shape == bus::Shape::kBox) {
        reader.require("size_m");
        return reader.read("size_m", object.size_m.data(), 3, kSizeRange);
    }
    if (object.shape == bus::Shape::kPlane) {
        object.size_m = {10.0, 10.0, 0.0};
        return reader.read("size_m", object.size_m.data(), 2, kSizeRange);
    }
    double diameter_m = 0.0;
    reader.require("diameter_m");
    reader.read("diameter_m", diameter_m, kSizeRange);
    object.size_m.setConstant(diameter_m);
    if (object.shape == bus::Shape::kSphere) return;
    reader.require("height_m");
    reader.read("height_m", object.size_m.z(), kSizeRange);
}

bus::Shape read_shape(config::TableReader& reader) {
    static const std::map<std::string, bus::Shape> kShapes{
        {"box", bus::Shape::kBox},
        {"sphere", bus::Shape::kSphere},
        {"cylinder", bus::Shape::kCylinder},
        {"capsule", bus::Shape::kCapsule},
        {"plane", bus::Shape::kPlane},
        {"convex", bus::Shape::kConvex},
        {"compound", bus::Shape::kCompound},
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
                        KnownParts& known) {
    WorldObject object;
    bus::SceneObject& scene = object.scene;
    scene.object = id;
    read_name(reader, scene.name);
    scene.shape = read_shape(reader);
    const bool has_model =
        scene.shape == bus::Shape::kConvex || scene.shape == bus::Shape::kCompound;
    if (has_model)
        read_model(reader, object, known);
    else
        read_size(reader, scene);
    const Material material = read_material(reader, materials);
    scene.friction = material.friction;
    scene.restitution = material.restitution;
    object.rolling_friction_m = material.rolling_friction_m;
    scene.colour = material.colour;
    scene.texture = material.texture;
    if (scene.shape == bus::Shape::kPlane)
        reader.read("mass_kg", scene.mass_kg, {0.0, 1e4});
    else
        read_mass(reader, material, physics::volume_m3(to_rigid(object)), scene.mass_kg);
    reader.read("colour", scene.colour.data(), 3, {0.0, 1.0});
    read_texture(reader, scene.texture);
    read_pose(reader, scene.world_from_object);
    reader.read("friction", scene.friction, {0.0, 10.0});
    reader.read("restitution", scene.restitution, {0.0, 1.0});
    reader.read("rolling_friction_m", object.rolling_friction_m, {0.0, 1.0});

    if (has_model && !object.parts) return object;  // already rejected
    if (const auto problem = physics::find_problem(to_rigid(object))) {
        std::string key(problem->field);
        if (key == "size_m" && !reader.has(key)) {
            key = has_model ? "scale" : reader.has("height_m") ? "height_m" : "diameter_m";
        }
        if (key == "mass_kg" && !reader.has(key))
            key = reader.has("density_kg_per_m3") ? "density_kg_per_m3" : "material";
        reader.reject(key, std::string(problem->allowed));
    }
    return object;
}

}  // namespace

void read_objects(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects) {
    KnownParts known;
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("object")) {
        const auto id = static_cast<std::uint32_t>(objects.size() + 1);
        objects.push_back(read_object(table, id, materials, known));
        const std::string& name = objects.back().scene.name;
        if (name == "world") table.reject("name", "must not be 'world', which joints use");
        if (!names.insert(name).second) table.reject("name", "must be unique among the objects");
    }
}

}  // namespace atrium::world_server
