#pragma once

#include "core/base/expected.hpp"
#include "simulation/person.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace atrium::simulation {

/// Texture of a model: packed RGB, top row first.
struct ModelTexture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;
};

/// Triangles of one material.
struct ModelPart {
    std::size_t first_triangle = 0;
    std::size_t num_triangles = 0;
    int texture = -1;  // -1: none
};

/// The pose-independent surface of a model.
struct ModelSurface {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Eigen::Vector2f> texture_places;  // per vertex; (0, 0) is the top left
    std::vector<Eigen::Vector3f> colours;         // per vertex, 0 to 1; multiplies the texture
    std::vector<ModelPart> parts;
    std::vector<ModelTexture> textures;
};

/// A rigged, animated model from a file, standing on the floor of a simulated room. Const methods
/// are thread-safe.
class Model {
public:
    /// Loads `options.model`, in any format that Assimp reads, and its first animation; without one
    /// the model stands still. A loop of the room repeats the animation as often as fits best. Up
    /// and forwards are +Y and +Z of the file, or +Z and -Y if the file declares +Z as up. The
    /// model stands at `options.position_m` with its lowest point on the floor. Its height at the
    /// start of the animation is that of the options; without one that of the file if plausible for
    /// a person (0.5 to 2.5 m), else 1.75 m.
    ///
    /// Errors: kNotFound; kInvalidData if the file cannot be read or has no triangles.
    static Expected<Model> load(const RoomOptions& options);

    Model(Model&&) noexcept;
    Model& operator=(Model&&) noexcept;
    ~Model();

    /// Computes the vertices at `time_s` [s], in any loop, in the site frame.
    void pose(double time_s, PosedSkin& out) const;

    const ModelSurface& surface() const;

private:
    struct Impl;
    explicit Model(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulation
