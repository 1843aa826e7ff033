#pragma once

#include "viewer/scene/background_reader.hpp"
#include "viewer/scene/model_preview.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

struct ModelEntry {
    std::string file;  // relative to the folder
    std::uintmax_t bytes = 0;
    std::string problem;  // why it cannot be added; empty: it can
};
struct ModelSize {
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // extents along x, y, z
    std::size_t num_triangles = 0;
    std::size_t num_parts = 0;
    std::vector<Eigen::Vector3d> colours;  // different ones that the file states, linear RGB
    ModelPreview preview;
    std::string error;  // why the file cannot be read; empty: it can
};

/// Lists the models of a folder and measures them, on a background thread. Drawing thread only.
class ModelFolder {
public:
    using List = std::shared_ptr<const std::vector<ModelEntry>>;

    explicit ModelFolder(const std::filesystem::path& folder);
    /// Whether the list is shown: reads it anew each time that this begins.
    void show(bool is_shown);
    /// Requests the size of a model of the list, once.
    void measure(const std::string& file);
    /// Takes what was read since the last call.
    void update();
    const List& list() const { return list_; }  // by name; null: not read yet
    /// Null: not measured yet.
    const ModelSize* size_of(const std::string& file) const;

private:
    struct Read {
        std::vector<ModelEntry> list;
        ModelSize size;
    };
    void scan();
    static std::vector<ModelEntry> list_of(const std::filesystem::path& folder);
    static ModelSize measure_file(const std::filesystem::path& file);

    List list_;
    bool is_shown_ = false;
    std::map<std::string, ModelSize> sizes_;
    BackgroundReader<std::string, Read> reader_;  // by file; empty: the list
};

}  // namespace atrium::viewer
