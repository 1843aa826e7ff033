#include "world_server/description/surroundings.hpp"

#include "core/model/model_file.hpp"
#include "world_server/description/shared_entries.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

namespace atrium::world_server {
namespace {

constexpr double kMinBoxM = 0.5;

void append(geometry::TriangleMesh& sum,
            const geometry::TriangleMesh& part,
            const geometry::RigidTransform& world_from_part) {
    const auto first = static_cast<std::uint32_t>(sum.vertices.size());
    for (const Eigen::Vector3d& v : part.vertices) sum.vertices.push_back(world_from_part * v);
    for (const auto& t : part.triangles)
        sum.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

// Loads the model even if it is not solid: the author of the file gets the error before the viewers
// do.
void read_scenery_model(config::TableReader& reader, WorldScenery& scenery) {
    Look& look = scenery.look;
    if (!read_model_name(reader, look.model, look.model_scale)) return;
    FilesRead read;
    const auto model = model::load_model(file_of(reader, look.model), look.model_scale, {}, &read);
    if (!model) return reject_model(reader, model.error());
    look.model_fingerprint = read.fingerprint;
    look.own_texture = model::own_texture_of(*model);
    look.missing_materials = model::missing_materials_of(*model);
    look.is_see_through = model::has_see_through(*model);
    const bool has_colours = std::ranges::all_of(*model, [](const model::ModelPart& part) {
        return part.has_colour || !part.vertex_colours.empty();
    });
    scenery.is_colour_unused = has_colours && reader.has("colour");
    if (has_colours && !scenery.is_colour_unused) look.colour = Look().colour;  // of a material
    for (const model::ModelPart& part : *model) {
        for (const Eigen::Vector3d& vertex : part.mesh.vertices)
            scenery.box.add(scenery.world_from_model * vertex);
    }
    std::size_t num_triangles = 0;
    for (const model::ModelPart& part : *model) num_triangles += part.mesh.triangles.size();
    if (num_triangles <= physics::kMaxStaticTriangles) {
        for (const model::ModelPart& part : *model)
            append(scenery.mesh, part.mesh, scenery.world_from_model);
    } else if (scenery.is_solid) {
        reader.reject("model",
                      fmt::format("must have at most {} triangles to be solid, has {}",
                                  physics::kMaxStaticTriangles,
                                  num_triangles));
    }
}

}  // namespace

void read_bounds(config::TableReader& reader, physics::WorldOptions& world) {
    if (!reader.has("bounds")) return;
    config::TableReader table = reader.table("bounds");
    geometry::Aabb box = box_of(world);
    table.require("min_m");
    table.require("max_m");
    table.read("min_m", box.min.data(), 3, kPositionRange);
    table.read("max_m", box.max.data(), 3, kPositionRange);
    if ((box.size().array() < kMinBoxM).any())
        table.reject("max_m", fmt::format("must be at least {} m above min_m", kMinBoxM));
    world.box = box;
    std::string leaving = "reset";
    table.read("leave", leaving, {"reset", "remove", "bounce"});
    world.leaving = leaving == "remove"   ? physics::LeavePolicy::kRemove
                    : leaving == "bounce" ? physics::LeavePolicy::kBounce
                                          : physics::LeavePolicy::kReset;
}

void read_scenery(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldScenery>& scenery) {
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("scenery")) {
        WorldScenery piece;
        read_name(table, piece.name);
        if (!names.insert(piece.name).second)
            table.reject("name", "must be unique among the scenery");
        read_pose(table, piece.world_from_model);
        const Material material = read_material(table, materials);
        piece.look.colour = material.colour;
        piece.look.texture = material.texture;
        piece.friction = material.friction;
        piece.restitution = material.restitution;
        table.read("solid", piece.is_solid);
        table.read("colour", piece.look.colour.data(), 3, {0.0, 1.0});
        table.read("friction", piece.friction, {0.0, 10.0});
        table.read("restitution", piece.restitution, {0.0, 1.0});
        read_texture(table, piece.look.texture);
        read_scenery_model(table, piece);
        scenery.push_back(std::move(piece));
    }
}

}  // namespace atrium::world_server
