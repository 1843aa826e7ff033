#include "viewer/model_library.hpp"

#include "core/app/log.hpp"
#include "core/bus/checks.hpp"
#include "core/model/model_file.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr float kSmoothCos = 0.77F;       // faces that meet at less than 40 degrees look round
constexpr std::size_t kMaxModels = 1024;  // that are kept; names come from the network

// Corners of their own for each triangle, with a normal that is smooth unless there is an edge, and
// with the file's places in a picture where it has them.
void append(const model::ModelPart& part, renderer::ShapeMesh& out) {
    const geometry::TriangleMesh& mesh = part.mesh;
    const bool has_places = part.texture_places.size() == mesh.vertices.size();
    std::vector<Eigen::Vector3f> smooth(mesh.vertices.size(), Eigen::Vector3f::Zero());
    const auto normal_of = [&](const auto& triangle) -> Eigen::Vector3f {
        const Eigen::Vector3f a = mesh.vertices[triangle[0]].template cast<float>();
        const Eigen::Vector3f b = mesh.vertices[triangle[1]].template cast<float>();
        const Eigen::Vector3f c = mesh.vertices[triangle[2]].template cast<float>();
        return (b - a).cross(c - a);
    };
    for (const auto& triangle : mesh.triangles) {
        for (const auto vertex : triangle) smooth[vertex] += normal_of(triangle);
    }
    for (const auto& triangle : mesh.triangles) {
        const Eigen::Vector3f normal = normal_of(triangle).normalized();
        for (const auto vertex : triangle) {
            const Eigen::Vector3f round = smooth[vertex].normalized();
            const Eigen::Vector3f position = mesh.vertices[vertex].template cast<float>();
            out.indices.push_back(static_cast<std::uint32_t>(out.corners.size()));
            out.corners.push_back({position,
                                   round.dot(normal) > kSmoothCos ? round : normal,
                                   has_places ? part.texture_places[vertex]
                                              : renderer::projected_place(position, normal)});
        }
    }
}

}  // namespace

const std::vector<ModelLibrary::Part>& ModelLibrary::parts_of(const std::string& file,
                                                              double scale) {
    const auto key = std::pair(file, scale);
    const auto known = models_.find(key);
    if (known != models_.end()) return known->second;
    if (models_.size() >= kMaxModels) models_.clear();
    std::vector<Part>& parts = models_[key];
    // the bus has checked it; a folder is left by nobody
    if (!bus::is_valid_model_file(file)) return parts;
    const auto loaded = model::load_model(folder_ / file, scale);
    if (!loaded) {
        if (complained_.size() < kMaxModels && complained_.insert(file).second)
            app::log::warn("model_missing {}; a box stands for it", loaded.error().message);
        return parts;
    }
    for (const model::ModelPart& part : *loaded) {
        renderer::ShapeMesh mesh;
        append(part, mesh);
        parts.push_back(
            {std::make_shared<const renderer::ShapeMesh>(std::move(mesh)), part.colour});
    }
    return parts;
}

renderer::ObjectLook ModelLibrary::look_of(const bus::SceneObject& object,
                                           renderer::ShapeKind shape) {
    renderer::ObjectLook look{.shape = shape,
                              .size_m = object.size_m,
                              .colour = object.colour,
                              .texture = object.texture,
                              .world_from_object = object.world_from_object};
    if (object.model.empty()) return look;
    const std::vector<Part>& parts = parts_of(object.model, object.model_scale);
    if (parts.size() == 1) look.model = parts.front().mesh;
    if (parts.size() > 1) {
        renderer::ShapeMesh whole;
        for (const Part& part : parts) {
            const auto first = static_cast<std::uint32_t>(whole.corners.size());
            whole.corners.insert(
                whole.corners.end(), part.mesh->corners.begin(), part.mesh->corners.end());
            for (const std::uint32_t index : part.mesh->indices)
                whole.indices.push_back(first + index);
        }
        look.model = std::make_shared<const renderer::ShapeMesh>(std::move(whole));
    }
    return look;
}

std::vector<renderer::ObjectLook> ModelLibrary::look_of(const bus::Scenery& scenery) {
    std::vector<renderer::ObjectLook> looks;
    for (const Part& part : parts_of(scenery.model, scenery.model_scale)) {
        looks.push_back({.model = part.mesh,
                         .colour = part.colour,
                         .texture = scenery.texture,
                         .world_from_object = scenery.world_from_model});
    }
    if (looks.empty()) {
        looks.push_back({.colour = scenery.colour,
                         .texture = scenery.texture,
                         .world_from_object = scenery.world_from_model});
    }
    return looks;
}

}  // namespace atrium::viewer
