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

/// A picture that lies on a model: packed RGB, top row first.
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

/// What a model looks like, whatever its pose.
struct ModelSurface {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Eigen::Vector2f> texture_places;  // per vertex; (0, 0) is the picture's top left
    std::vector<Eigen::Vector3f> colours;         // per vertex, 0 to 1; multiplies the texture
    std::vector<ModelPart> parts;
    std::vector<ModelTexture> textures;
};

/// A rigged, animated model from a file, standing on the floor of a simulated room. Const use is
/// thread-safe.
class Model {
public:
    /// Reads `options.model`, in any format that Assimp reads, and its first animation; without one
    /// it stands still. The animation is repeated as often in a loop of the room as fits best. Up
    /// and forwards are +Y and +Z of the file, or +Z and -Y where the file says that +Z is up. It
    /// stands at `options.position_m`, its lowest point on the floor, and has the height that the
    /// options say at the animation's start; where they say none, that of the file if it can be a
    /// person's (0.5 to 2.5 m), else 1.75 m.
    ///
    /// Errors: kNotFound, kInvalidData where the file cannot be read or holds no triangles.
    static Expected<Model> load(const RoomOptions& options);

    Model(Model&&) noexcept;
    Model& operator=(Model&&) noexcept;
    ~Model();

    /// The vertices at `time_s` [s], of any loop, in the site frame.
    void pose(double time_s, PosedSkin& out) const;

    const ModelSurface& surface() const;

    /// Length of the animation as the file has it [s]; 0 without one.
    double duration_s() const;

private:
    struct Impl;
    explicit Model(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulation
