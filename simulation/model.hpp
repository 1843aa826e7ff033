#pragma once

#include "core/base/expected.hpp"
#include "simulation/person.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace atrium::simulation {

/// Texture of a model: packed RGBA, top row first.
struct ModelTexture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// Triangles of one material.
struct ModelPart {
    std::size_t first_triangle = 0;
    std::size_t num_triangles = 0;
    int texture = -1;         // -1: none
    bool is_cut_out = false;  // transparent places of the texture are holes
};

/// The pose-independent surface of a model.
struct ModelSurface {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Eigen::Vector2f> texture_places;  // per vertex; (0, 0) is the top left
    std::vector<Eigen::Vector3f> colours;         // per vertex, 0 to 1; multiplies the texture
    std::vector<ModelPart> parts;
    std::vector<ModelTexture> textures;
};

/// What a model file turned out to be.
struct ModelReport {
    double height_m = 0.0;  // standing, as it is drawn
    std::size_t num_vertices = 0;
    std::size_t num_bones = 0;
    std::size_t num_textures = 0;
    std::string animation;     // its name
    double animation_s = 0.0;  // 0: it stands still
    std::vector<std::string> warnings;
};

/// A rigged, animated model from a file, standing on the floor of a simulated room. Const methods
/// are thread-safe.
class Model {
public:
    /// Loads `options.model`, in any format that Assimp reads, and its first animation that moves
    /// something, or that of `options.motion_file`; without one the model stands still. A loop of
    /// the room repeats the animation as often as fits best.
    ///
    /// Up and forwards are +Y and +Z of the file, or +Z and -Y if the file declares +Z as up; where
    /// the bones of the resting skeleton contradict, they decide. The model stands at
    /// `options.position_m` with its lowest point on the floor, and an animation that walks away
    /// walks on the spot. The standing height is that of the options; without one that of the file
    /// if plausible for a person (0.5 to 2.5 m), else that of the file in another common unit, else
    /// 1.75 m.
    ///
    /// Errors: kNotFound; kInvalidData if a file cannot be read, has no triangles, or the motion
    /// does not fit the model.
    static Expected<Model> load(const RoomOptions& options);

    Model(Model&&) noexcept;
    Model& operator=(Model&&) noexcept;
    ~Model();

    /// Computes the vertices at `time_s` [s], in any loop, in the site frame.
    void pose(double time_s, PosedSkin& out) const;

    const ModelSurface& surface() const;
    const ModelReport& report() const;

private:
    struct Impl;
    explicit Model(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Loads the model to see what it is. Errors as those of `Model::load`.
Expected<ModelReport> examine_model(const RoomOptions& options);

/// One line: "height 1.80 m, 21 bones, 5000 vertices, no textures, animation 'walk' of 1.0 s".
std::string describe(const ModelReport& report);

}  // namespace atrium::simulation
