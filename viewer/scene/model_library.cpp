#include "viewer/scene/model_library.hpp"

#include "core/app/log.hpp"
#include "core/bus/names.hpp"
#include "core/model/model_file.hpp"
#include "viewer/scene/file_advice.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::viewer {
namespace {

constexpr float kSmoothCos = 0.77F;       // smooth normals where faces meet at less than 40 degrees
constexpr std::size_t kMaxModels = 1024;  // requested; the names come from the network

// Appends separate corners for each triangle, with a smooth normal unless there is an edge, and
// with the file's texture coordinates if it has any. Of a painted mesh, all parts have colours.
void append(const model::ModelPart& part, bool is_painted, renderer::ShapeMesh& out) {
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
            if (is_painted) {
                out.colours.push_back(part.vertex_colours.empty() ? part.colour.cast<float>()
                                                                  : part.vertex_colours[vertex]);
            }
        }
    }
}

bool is_painted(const model::ModelPart& part) { return !part.vertex_colours.empty(); }

}  // namespace

ModelLibrary::ModelLibrary(const std::filesystem::path& folder)
    : folder_(folder),
      versions_(kMaxModels),
      reader_([folder, files = std::map<Key, FilesRead>()](const Request& request) mutable {
          return read(folder, request, files[request.key]);
      }) {}

// `files`: of the last time that this model was read.
Expected<ModelLibrary::Read> ModelLibrary::read(const std::filesystem::path& folder,
                                                const Request& request,
                                                FilesRead& files) {
    if (request.is_check && !files.have_changed()) return Read{};
    const auto& [file, scale] = request.key;
    const auto parts = model::load_model(folder / file, scale, {}, &files);
    if (!parts) return tl::unexpected(parts.error());
    return Read{make(*parts), files.fingerprint};
}

ModelLibrary::Model ModelLibrary::make(const std::vector<model::ModelPart>& parts) {
    Model model;
    renderer::ShapeMesh whole;
    const bool is_any_painted = std::ranges::any_of(parts, is_painted);
    for (const model::ModelPart& part : parts) {
        renderer::ShapeMesh mesh;
        append(part, is_painted(part), mesh);
        append(part, is_any_painted, whole);
        model.parts.push_back({std::make_shared<const renderer::ShapeMesh>(std::move(mesh)),
                               part.has_colour ? std::optional(part.colour) : std::nullopt});
    }
    model.whole = std::make_shared<const renderer::ShapeMesh>(std::move(whole));
    return model;
}

void ModelLibrary::expect(const std::string& file, const Fingerprint& of_server) {
    versions_.expect(file, of_server);
}

const ModelLibrary::Model& ModelLibrary::model(const std::string& file, double scale) {
    static const Model kNone;
    const Key key(file, scale);
    const auto known = models_.find(key);
    if (known != models_.end()) return known->second;
    // the bus has checked the name; it cannot leave the folder
    if (bus::is_valid_model_file(file) && versions_.num_read() < kMaxModels &&
        !reader_.is_wanted({key, false})) {
        versions_.begin(key, FileVersions::Clock::now());
        reader_.want({key, false});
    }
    return kNone;
}

std::shared_ptr<const renderer::ShapeMesh> ModelLibrary::loaded(const std::string& file,
                                                                double scale) const {
    const auto known = models_.find({file, scale});
    return known == models_.end() ? nullptr : known->second.whole;
}

std::set<std::string> ModelLibrary::take(FileVersions::Clock::time_point now) {
    std::set<std::string> changed;
    for (auto& [request, read] : reader_.take()) take(request, std::move(read), changed);
    for (const Key& key : versions_.take_due(now)) reader_.want_again({key, true});
    return changed;
}

void ModelLibrary::take(const Request& request,
                        Expected<Read> read,
                        std::set<std::string>& changed) {
    const auto& [key, is_check] = request;
    const auto known = models_.find(key);
    // a file that is being copied here cannot be read yet: the model before stays
    const bool has_model = known != models_.end() && known->second.whole != nullptr;
    const bool keeps = is_check && (read ? !read->model : has_model);
    std::optional<Fingerprint> own;
    if (!keeps) own = read ? read->fingerprint : Fingerprint{};
    const bool is_news = versions_.end(key, own);
    if (is_news) app::log::warn("{}", differs_line("model", key.first, folder_));
    if (!read && !keeps && complained_.size() < kMaxModels &&
        complained_.insert(key.first).second) {
        app::log::warn(
            "model_missing {}; a box replaces it; {}",
            read.error().message,
            advice_about(read.error(), folder_, key.first, "export it again, for example as .glb"));
    }
    if (keeps) return;
    models_[key] = read ? std::move(*read->model) : Model{};
    changed.insert(key.first);
}

void ModelLibrary::forget() {
    reader_.forget();
    versions_.forget();
    models_.clear();
}

renderer::ObjectLook ModelLibrary::look_of(const bus::SceneObject& object,
                                           renderer::ShapeKind shape) {
    renderer::ObjectLook look{.shape = shape,
                              .size_m = object.size_m,
                              .colour = object.colour,
                              .texture = object.texture,
                              .world_from_object = object.world_from_object};
    if (!object.model.empty()) look.model = model(object.model, object.model_scale).whole;
    return look;
}

std::vector<renderer::ObjectLook> ModelLibrary::look_of(const bus::Scenery& scenery) {
    std::vector<renderer::ObjectLook> looks;
    for (const Part& part : model(scenery.model, scenery.model_scale).parts) {
        looks.push_back({.model = part.mesh,
                         .colour = part.colour.value_or(scenery.colour),
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
