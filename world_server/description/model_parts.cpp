#include "world_server/description/model_parts.hpp"

#include "core/geometry/weld.hpp"
#include "core/model/model_file.hpp"
#include "core/model/pieces.hpp"
#include "world_server/physics/rigid/convex_hull.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr double kTiny_m = 0.02;  // a hull below 1 cm cannot be made
// Edges of holes in a surface that still counts as closed, as a share of the model's diagonal: a
// turned shape often has a small one where it meets its axis.
constexpr double kPinholes = 0.1;

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

// Length of the edges whose triangles do not join into a surface that goes on.
double open_length_m(const geometry::TriangleMesh& mesh) {
    struct Side {
        std::uint32_t low, high;
        int direction;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = t[i];
            const std::uint32_t to = t[(i + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
        }
    }
    std::ranges::sort(sides, {}, [](const Side& side) { return std::pair(side.low, side.high); });
    double length_m = 0.0;
    for (std::size_t first = 0, i = 0; first < sides.size(); first = i) {
        int excess = 0;
        for (; i < sides.size() && sides[i].low == sides[first].low &&
               sides[i].high == sides[first].high;
             ++i)
            excess += sides[i].direction;
        length_m += std::abs(excess) *
                    (mesh.vertices[sides[first].low] - mesh.vertices[sides[first].high]).norm();
    }
    return length_m;
}

ModelSurface surface_of(const std::vector<model::ModelPart>& parts) {
    geometry::TriangleMesh all;
    for (const model::ModelPart& part : parts) {
        const auto first = static_cast<std::uint32_t>(all.vertices.size());
        all.vertices.insert(
            all.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
        for (const auto& t : part.mesh.triangles)
            all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    all = geometry::weld(all);
    if (open_length_m(all) > kPinholes * size_of(parts).norm()) return nullptr;
    const double volume_m3 = geometry::volume_m3(all);
    if (volume_m3 == 0.0) return nullptr;
    if (volume_m3 < 0.0)
        for (auto& t : all.triangles) std::swap(t[1], t[2]);
    return std::make_shared<const geometry::TriangleMesh>(std::move(all));
}

}  // namespace

Expected<LoadedModel> load_model_parts(const std::filesystem::path& file,
                                       double scale,
                                       physics::ObjectShape shape) {
    FilesRead read;
    const auto model = model::load_model(file, scale, {}, &read);
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
        surface_of(*model),
        model::own_texture_of(*model),
        model::missing_materials_of(*model),
        model::has_see_through(*model),
        model::colours_of(*model),
        read.fingerprint};
}

}  // namespace atrium::world_server
