#pragma once

#include "core/base/expected.hpp"
#include "core/base/fingerprint.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Reads the triangles of model files. The world server and the viewers share this reader, thus
/// physics and pictures use the same shape.
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
    std::string name;             // as in the file; may be empty
    geometry::TriangleMesh mesh;  // [m]; need not be closed
    /// Texture coordinates per vertex, (0, 0) is the picture's top left; empty: none.
    std::vector<Eigen::Vector2f> texture_places;
    /// Colour per vertex, linear RGB in [0, 1]; empty: none.
    std::vector<Eigen::Vector3f> vertex_colours;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // RGB in [0, 1]
    bool has_colour = false;                                  // the file states the colour
    std::string own_texture;  // picture that the file names, "*0" inside it; viewers do not draw it
    /// File of materials that an OBJ file names and that is not there: the part has no colour then.
    std::string missing_materials;
    bool is_see_through = false;  // the file makes it transparent; viewers draw it opaque
};

/// The first picture that the parts name; empty: none.
std::string own_texture_of(const std::vector<ModelPart>& parts);

/// The file of materials that the parts lack; empty: none.
std::string missing_materials_of(const std::vector<ModelPart>& parts);

/// Whether the file makes one of the parts transparent.
bool has_see_through(const std::vector<ModelPart>& parts);

/// The different colours that the file states for its parts, in the order of the parts.
std::vector<Eigen::Vector3d> colours_of(const std::vector<ModelPart>& parts);

/// The suffix of the file's name in lower case: ".obj".
std::string ending_of(const std::filesystem::path& file);
/// Whether the ending is that of glTF, whose +Y is up. `load_model` turns it.
bool is_gltf(const std::filesystem::path& file);
/// True if `load_model` supports the suffix of the file's name.
bool is_model_name(const std::filesystem::path& file);
/// The supported suffixes, for messages: ".obj, .ply, ...".
const std::string& model_endings();

/// Reads the triangles of a model in its rest pose: Wavefront OBJ, PLY, STL, OFF and glTF 2 (.gltf,
/// .glb). Lengths are in metres, +Z is up. glTF has +Y up and is rotated: its x, y, z become x, -z,
/// y. `scale` multiplies all coordinates.
///
/// For untrusted files: checks sizes before and after reading, but relies on Assimp for the
/// reading. Errors name the file: kNotFound, or kInvalidData if it is damaged, has no triangles or
/// exceeds `limits`.
///
/// `read`, if not null, gets what was read, also of a file that fails: the model and the files of
/// colours (.mtl) and of vertices (.bin) that it names. Pictures are not read.
Expected<std::vector<ModelPart>> load_model(const std::filesystem::path& file,
                                            double scale = 1.0,
                                            const ModelLimits& limits = {},
                                            FilesRead* read = nullptr);

}  // namespace atrium::model
