#include "world_server/description/model_parts.hpp"

#include "core/model/model_file.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <fmt/format.h>

namespace atrium::world_server {

Expected<LoadedModel> load_model_parts(const std::filesystem::path& file,
                                       double scale,
                                       physics::ObjectShape shape) {
    const auto model = model::load_model(file, scale);
    if (!model) return tl::unexpected(model.error());
    std::vector<geometry::TriangleMesh> parts;
    std::vector<Eigen::Vector3d> points;
    for (const model::ModelPart& part : *model) {
        if (shape == physics::ObjectShape::kCompound) points.clear();
        points.insert(points.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        if (shape == physics::ObjectShape::kConvex && &part != &model->back()) continue;
        parts.push_back(physics::convex_hull(points, physics::kMaxHullVertices));
        if (parts.back().empty()) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("part '{}' has no volume", part.name));
        }
    }
    return LoadedModel{
        std::make_shared<const std::vector<geometry::TriangleMesh>>(std::move(parts)),
        model::own_texture_of(*model),
        model::colours_of(*model)};
}

}  // namespace atrium::world_server
