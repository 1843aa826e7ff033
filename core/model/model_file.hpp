#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Things from model files: what the world server gives weight and what viewers draw is one reading
/// of one file.
namespace atrium::model {

struct ModelLimits {
    std::uintmax_t max_file_bytes = std::uintmax_t{64} << 20U;
    std::size_t max_parts = 256;
    std::size_t max_vertices = 200'000;   // of all parts
    std::size_t max_triangles = 200'000;  // of all parts
    double max_coordinate_m = 1000.0;
};

/// One mesh of a model file; its frame is the model's.
struct ModelPart {
    std::string name;                             // as the file has it; may be empty
    geometry::TriangleMesh mesh;                  // [m], any triangles: not always closed
    std::vector<Eigen::Vector2f> texture_places;  // per vertex, (0, 0) is the picture's top left;
                                                  // empty: none
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // RGB in [0, 1]
};

/// Whether the name ends as one of a file that `load_model` reads.
bool is_model_name(const std::filesystem::path& file);
/// What such a name ends in, for messages: ".obj, .ply, ...".
const std::string& model_endings();

/// Reads the triangles of a model at rest: Wavefront OBJ, PLY, STL, OFF and glTF 2 (.gltf, .glb).
/// Lengths are metres. +Z is up; glTF, which says that +Y is up, is turned so (its x, y, z become
/// x, -z, y). `scale` multiplies all coordinates.
///
/// For files of anybody: sizes are checked before and after reading, but the reading is Assimp's.
/// Errors name the file: kNotFound, or kInvalidData where it is damaged, holds no triangles or is
/// beyond `limits`.
Expected<std::vector<ModelPart>> load_model(const std::filesystem::path& file,
                                            double scale = 1.0,
                                            const ModelLimits& limits = {});

}  // namespace atrium::model
