#pragma once

#include "core/bus/messages.hpp"
#include "core/model/model_file.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/scene/background_reader.hpp"
#include "viewer/scene/file_versions.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Loads the models of one folder in the background: each once, and again when its files change
/// while they differ from those of the world's server. A box replaces a model that is not loaded
/// yet or cannot be loaded. The log names each failure and difference once. Not thread-safe.
class ModelLibrary {
public:
    explicit ModelLibrary(const std::filesystem::path& folder);

    /// The version of a model that the world's server has (FileVersions::expect).
    void expect(const std::string& file, const Fingerprint& of_server);
    /// Look of an object: the whole model in the object's colour or those of its vertices, or a box
    /// of the object's size.
    renderer::ObjectLook look_of(const bus::SceneObject& object, renderer::ShapeKind shape);
    /// Looks of scenery: one per part of the model, in the part's colour or, if its file states
    /// none, the scenery's; or a box of 1 m.
    std::vector<renderer::ObjectLook> look_of(const bus::Scenery& scenery);
    /// The whole model, if it is loaded; else null.
    std::shared_ptr<const renderer::ShapeMesh> loaded(const std::string& file, double scale) const;
    /// Whether the file cannot be loaded.
    bool is_missing(const std::string& file, double scale) const {
        const auto known = models_.find({file, scale});
        return known != models_.end() && known->second.whole == nullptr;
    }
    /// Whether the loaded model is another version than that of the world's server.
    bool is_different(const std::string& file, double scale) const {
        return versions_.is_different({file, scale});
    }
    /// Returns the files loaded since the last call; looks that use them have changed. Looks for
    /// changed files in the background. Never blocks.
    std::set<std::string> take(FileVersions::Clock::time_point now = FileVersions::Clock::now());
    /// Whether everything that was requested has been read and taken.
    bool is_idle() const { return reader_.is_idle(); }
    /// Drops all requests and models. Files may be requested again.
    void forget();

private:
    using Key = FileVersions::Key;
    struct Request {
        Key key;
        bool is_check = false;  // read it only if its files have changed

        auto operator<=>(const Request&) const = default;
    };
    struct Part {
        std::shared_ptr<const renderer::ShapeMesh> mesh;  // in the model's frame [m]
        std::optional<Eigen::Vector3d> colour;            // linear RGB, if the file states one
    };
    struct Model {
        std::vector<Part> parts;
        std::shared_ptr<const renderer::ShapeMesh> whole;
    };
    struct Read {
        std::optional<Model> model;  // none: its files have not changed
        Fingerprint fingerprint;
    };
    static Model make(const std::vector<model::ModelPart>& parts);
    static Expected<Read> read(const std::filesystem::path& folder,
                               const Request& request,
                               FilesRead& files);
    void take(const Request& request, Expected<Read> read, std::set<std::string>& changed);
    const Model& model(const std::string& file, double scale);

    const std::filesystem::path folder_;
    std::map<Key, Model> models_;  // empty: cannot be loaded
    std::set<std::string> complained_;
    FileVersions versions_;
    BackgroundReader<Request, Read> reader_;
};

}  // namespace atrium::viewer
