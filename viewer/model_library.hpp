#pragma once

#include "core/bus/messages.hpp"
#include "core/model/model_file.hpp"
#include "viewer/background_reader.hpp"
#include "viewer/renderer/object_look.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// What models look like, from files of one folder, each read once and in the background. A box
/// stands for a model that has not been read yet, or cannot be, which is said once in the log. Not
/// thread-safe.
class ModelLibrary {
public:
    explicit ModelLibrary(const std::filesystem::path& folder);

    /// Of an object: its model as one, in its own colour, or a box of its size.
    renderer::ObjectLook look_of(const bus::SceneObject& object, renderer::ShapeKind shape);
    /// Of scenery: a part for each of the model's, in the model's colours, or a box of 1 m.
    std::vector<renderer::ObjectLook> look_of(const bus::Scenery& scenery);
    /// The files that have been read since the last call: what has these models looks otherwise
    /// now. Never waits.
    std::set<std::string> take();
    /// All that was asked for: it may be asked for again.
    void forget();

private:
    using Key = std::pair<std::string, double>;  // file, scale
    struct Part {
        std::shared_ptr<const renderer::ShapeMesh> mesh;  // in the model's frame [m]
        Eigen::Vector3d colour;                           // linear RGB
    };
    struct Model {
        std::vector<Part> parts;
        std::shared_ptr<const renderer::ShapeMesh> whole;
    };
    static Model make(const std::vector<model::ModelPart>& parts);
    const Model& model(const std::string& file, double scale);

    std::map<Key, Model> models_;  // nothing in it: cannot be had
    std::set<std::string> complained_;
    BackgroundReader<Key, Model> reader_;
};

}  // namespace atrium::viewer
