#include "world_server/description/model_parts.hpp"

#include "core/model/model_file.hpp"
#include "core/model/pieces.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <fmt/format.h>

namespace atrium::world_server {
namespace {

constexpr double kTiny_m = 0.02;  // a hull below 1 cm cannot be made

Eigen::Vector3d size_of(const std::vector<model::ModelPart>& parts) {
    geometry::Aabb bounds;
    for (const model::ModelPart& part : parts)
        for (const Eigen::Vector3d& vertex : part.mesh.vertices) bounds.add(vertex);
    return bounds.size();
}

std::vector<model::Piece> pieces_of(const std::vector<model::ModelPart>& parts,
                                    const std::filesystem::path& file,
                                    physics::ObjectShape shape) {
    if (shape == physics::ObjectShape::kCompound) return model::pieces_of(parts, file);
    model::Piece whole;
    for (const model::ModelPart& part : parts) {
        const auto& vertices = part.mesh.vertices;
        whole.points.insert(whole.points.end(), vertices.begin(), vertices.end());
    }
    return {whole};
}

}  // namespace

Expected<LoadedModel> load_model_parts(const std::filesystem::path& file,
                                       double scale,
                                       physics::ObjectShape shape) {
    const auto model = model::load_model(file, scale);
    if (!model) return tl::unexpected(model.error());
    const std::vector<model::Piece> pieces = pieces_of(*model, file, shape);
    if (pieces.size() > physics::kMaxHullParts) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("has {} parts, a compound at most {}; "
                                      "shape = \"convex\" is one hull around everything",
                                      pieces.size(),
                                      physics::kMaxHullParts));
    }
    std::vector<geometry::TriangleMesh> parts;
    for (const model::Piece& piece : pieces) {
        parts.push_back(physics::convex_hull(piece.points, physics::kMaxHullVertices));
        if (parts.back().empty()) {
            const Eigen::Vector3d size_m = size_of(*model);
            return make_error(
                ErrorKind::kInvalidData,
                size_m.maxCoeff() < kTiny_m
                    ? fmt::format("with scale = {:g}, the model is only {:.2g} x {:.2g} x {:.2g} m "
                                  "large; what scale makes it metres?",
                                  scale,
                                  size_m.x(),
                                  size_m.y(),
                                  size_m.z())
                    : fmt::format("part '{}' has no volume: it is flat", piece.name));
        }
    }
    return LoadedModel{
        std::make_shared<const std::vector<geometry::TriangleMesh>>(std::move(parts)),
        model::own_texture_of(*model),
        model::missing_materials_of(*model),
        model::colours_of(*model)};
}

}  // namespace atrium::world_server
