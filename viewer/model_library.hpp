#pragma once

#include "core/bus/messages.hpp"
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

/// What models look like, from files of one folder; each is read once. Not thread-safe.
class ModelLibrary {
public:
    struct Part {
        std::shared_ptr<const renderer::ShapeMesh> mesh;  // in the model's frame [m]
        Eigen::Vector3d colour;                           // linear RGB
    };

    explicit ModelLibrary(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// Of an object: its model as one, in its own colour. A box of the object's size stands for a
    /// model that cannot be had, which is said once in the log.
    renderer::ObjectLook look_of(const bus::SceneObject& object, renderer::ShapeKind shape);
    /// Of scenery: a part for each of the model's, in the model's colours, or a box of 1 m.
    std::vector<renderer::ObjectLook> look_of(const bus::Scenery& scenery);

private:
    const std::vector<Part>& parts_of(const std::string& file, double scale);

    std::filesystem::path folder_;
    std::map<std::pair<std::string, double>, std::vector<Part>> models_;  // none: cannot be had
    std::set<std::string> complained_;
};

}  // namespace atrium::viewer
