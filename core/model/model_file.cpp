#include "core/model/model_file.hpp"

#include "core/base/readable.hpp"
#include "core/model/assimp_errors.hpp"
#include "core/model/gltf_extensions.hpp"
#include "core/model/material_file.hpp"
#include "core/model/ply_length.hpp"
#include "core/model/recorded_files.hpp"

#include <Eigen/LU>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <string_view>
#include <system_error>

namespace atrium::model {
namespace {

constexpr std::array<std::string_view, 6> kEndings{".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
constexpr int kMaxDepth = 100;  // nesting of nodes

Eigen::Matrix4d to_eigen(const aiMatrix4x4& m) {
    Eigen::Matrix4d transform;
    transform << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
        m.d3, m.d4;
    return transform;
}

Eigen::Vector3d colour_of(const aiMaterial& material) {
    aiColor4D colour(0.7F, 0.7F, 0.7F, 1.0F);
    if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS)
        material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    Eigen::Vector3d rgb(colour.r, colour.g, colour.b);
    if (!rgb.allFinite()) return Eigen::Vector3d::Constant(0.7);
    return rgb.cwiseMax(0.0).cwiseMin(1.0);
}

// Assimp adds a material to parts without one: of that name, or for glTF white without a name.
bool states_colour(const aiMaterial& material) {
    aiString name;
    material.Get(AI_MATKEY_NAME, name);
    if (name.length > 0) return std::string_view(name.C_Str()) != AI_DEFAULT_MATERIAL_NAME;
    return (colour_of(material).array() < 1.0).any();
}

// glTF says it by its mode and the colour's alpha, other formats by an opacity.
bool is_see_through(const aiMaterial& material) {
    constexpr float kOpaque = 0.99F;
    aiString mode;
    if (material.Get("$mat.gltf.alphaMode", 0, 0, mode) == aiReturn_SUCCESS) {
        aiColor4D colour(1.0F, 1.0F, 1.0F, 1.0F);
        material.Get(AI_MATKEY_BASE_COLOR, colour);
        return std::string_view(mode.C_Str()) == "BLEND" && colour.a < kOpaque;
    }
    float opacity = 1.0F;
    return material.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity < kOpaque;
}

float linear_of(float encoded) {
    return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

// Only glTF has linear ones, which multiply the colour of the material.
Eigen::Vector3f vertex_colour_of(const aiColor4D& colour, const ModelPart& part, bool is_linear) {
    Eigen::Vector3f rgb(colour.r, colour.g, colour.b);
    if (!rgb.allFinite()) return part.colour.cast<float>();
    rgb = rgb.cwiseMax(0.0F).cwiseMin(1.0F);
    if (!is_linear) return rgb.unaryExpr(&linear_of);
    return part.has_colour ? rgb.cwiseProduct(part.colour.cast<float>()).eval() : rgb;
}

std::string texture_of(const aiMaterial& material) {
    aiString path;
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
        if (material.GetTexture(type, 0, &path) == aiReturn_SUCCESS) return path.C_Str();
    }
    return {};
}

class PartCollector {
public:
    PartCollector(const aiScene& scene,
                  const std::filesystem::path& file,
                  const ModelLimits& limits)
        : scene_(scene), file_(file), limits_(limits) {}

    Expected<std::vector<ModelPart>> take(const Eigen::Matrix4d& model_from_file) {
        if (scene_.mRootNode == nullptr) return invalid("is empty");
        if (auto taken = take_node(*scene_.mRootNode, model_from_file, 0); !taken)
            return tl::unexpected(taken.error());
        if (num_triangles_ == 0) return invalid("has no triangles");
        return std::move(parts_);
    }

private:
    tl::unexpected<Error> invalid(const std::string& what) const {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file_.string(), what));
    }

    Expected<void> take_node(const aiNode& node, const Eigen::Matrix4d& model_from_up, int depth) {
        if (depth > kMaxDepth)
            return invalid(fmt::format("has more than {} levels of nested nodes", kMaxDepth));
        const Eigen::Matrix4d model_from_node = model_from_up * to_eigen(node.mTransformation);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) {
            const aiMesh& mesh = *scene_.mMeshes[node.mMeshes[i]];
            if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) continue;
            if (auto taken = take_mesh(mesh, model_from_node); !taken) return taken;
        }
        for (unsigned i = 0; i < node.mNumChildren; ++i) {
            if (auto taken = take_node(*node.mChildren[i], model_from_node, depth + 1); !taken)
                return taken;
        }
        return {};
    }

    Expected<void> take_mesh(const aiMesh& mesh, const Eigen::Matrix4d& model_from_mesh) {
        num_vertices_ += mesh.mNumVertices;
        num_triangles_ += mesh.mNumFaces;
        if (parts_.size() == limits_.max_parts)
            return invalid(fmt::format("has more than {} parts", limits_.max_parts));
        if (num_vertices_ > limits_.max_vertices)
            return invalid(fmt::format("has more than {} vertices", limits_.max_vertices));
        if (num_triangles_ > limits_.max_triangles)
            return invalid(fmt::format("has more than {} triangles", limits_.max_triangles));
        ModelPart part;
        part.name = mesh.mName.C_Str();
        if (mesh.mMaterialIndex < scene_.mNumMaterials) {
            part.colour = colour_of(*scene_.mMaterials[mesh.mMaterialIndex]);
            part.has_colour = states_colour(*scene_.mMaterials[mesh.mMaterialIndex]);
            part.own_texture = texture_of(*scene_.mMaterials[mesh.mMaterialIndex]);
            part.is_see_through = is_see_through(*scene_.mMaterials[mesh.mMaterialIndex]);
        }
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& p = mesh.mVertices[v];
            const Eigen::Vector3d at =
                (model_from_mesh * Eigen::Vector4d(p.x, p.y, p.z, 1.0)).head<3>();
            // NaN fails this condition as well
            if (!(at.cwiseAbs().maxCoeff() <= limits_.max_coordinate_m))
                return invalid(
                    fmt::format("a vertex of part '{}' is further than {} m from the "
                                "origin, or not a number; scale = 0.001 reads millimetres",
                                part.name,
                                limits_.max_coordinate_m));
            part.mesh.vertices.push_back(at);
            if (mesh.HasVertexColors(0)) {
                part.vertex_colours.push_back(
                    vertex_colour_of(mesh.mColors[0][v], part, is_gltf(file_)));
            }
            if (!mesh.HasTextureCoords(0)) continue;
            const aiVector3D& place = mesh.mTextureCoords[0][v];
            part.texture_places.emplace_back(place.x, place.y);
        }
        take_triangles(mesh, model_from_mesh.topLeftCorner<3, 3>().determinant() < 0.0, part.mesh);
        if (!part.mesh.triangles.empty()) parts_.push_back(std::move(part));
        return {};
    }

    static void take_triangles(const aiMesh& mesh, bool is_mirrored, geometry::TriangleMesh& out) {
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;
            std::array<std::uint32_t, 3> t{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
            if (std::max({t[0], t[1], t[2]}) >= mesh.mNumVertices) continue;
            if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
            if (is_mirrored) std::swap(t[1], t[2]);
            out.triangles.push_back(t);
        }
    }

    const aiScene& scene_;
    const std::filesystem::path& file_;
    const ModelLimits& limits_;
    std::vector<ModelPart> parts_;
    std::size_t num_vertices_ = 0;
    std::size_t num_triangles_ = 0;
};

Expected<void> check_file(const std::filesystem::path& file, const ModelLimits& limits) {
    const auto wrong = [&](ErrorKind kind, const std::string& what) {
        return make_error(kind, fmt::format("{}: {}", file.string(), what));
    };
    if (!is_model_name(file)) {
        return wrong(ErrorKind::kInvalidData,
                     fmt::format("unknown model format; must be one of {}", model_endings()));
    }
    if (auto readable = check_readable(file); !readable) return readable;
    std::error_code failure;
    const std::uintmax_t num_bytes = std::filesystem::file_size(file, failure);
    if (failure) return wrong(ErrorKind::kNotFound, failure.message());
    if (num_bytes > limits.max_file_bytes) {
        return wrong(
            ErrorKind::kInvalidData,
            fmt::format("has {} bytes, at most {} are allowed", num_bytes, limits.max_file_bytes));
    }
    if (num_bytes > 0 && ending_of(file) == ".ply") {
        if (const std::string lacks = what_ply_lacks(file); !lacks.empty())
            return wrong(ErrorKind::kInvalidData, lacks);
    }
    if (const std::string extension = unread_extension(file); !extension.empty())
        return wrong(ErrorKind::kInvalidData, extension);
    return {};
}

}  // namespace

std::string ending_of(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) {
        return static_cast<char>(std::tolower(c));
    });
    return ending;
}

bool is_gltf(const std::filesystem::path& file) {
    const std::string ending = ending_of(file);
    return ending == ".gltf" || ending == ".glb";
}

std::string own_texture_of(const std::vector<ModelPart>& parts) {
    for (const ModelPart& part : parts) {
        if (!part.own_texture.empty()) return part.own_texture;
    }
    return {};
}

std::string missing_materials_of(const std::vector<ModelPart>& parts) {
    return parts.empty() ? std::string() : parts.front().missing_materials;
}

bool has_see_through(const std::vector<ModelPart>& parts) {
    return std::ranges::any_of(parts, &ModelPart::is_see_through);
}

std::vector<Eigen::Vector3d> colours_of(const std::vector<ModelPart>& parts) {
    constexpr double kSame = 0.02;
    std::vector<Eigen::Vector3d> colours;
    for (const ModelPart& part : parts) {
        const auto is_same = [&](const Eigen::Vector3d& known) {
            return (known - part.colour).cwiseAbs().maxCoeff() < kSame;
        };
        if (part.has_colour && std::ranges::none_of(colours, is_same))
            colours.push_back(part.colour);
    }
    return colours;
}

bool is_model_name(const std::filesystem::path& file) {
    return std::find(kEndings.begin(), kEndings.end(), ending_of(file)) != kEndings.end();
}

const std::string& model_endings() {
    static const std::string kList = fmt::format("{}", fmt::join(kEndings, ", "));
    return kList;
}

Expected<std::vector<ModelPart>> load_model(const std::filesystem::path& file,
                                            double scale,
                                            const ModelLimits& limits,
                                            FilesRead* read) {
    if (read != nullptr) *read = {{}, {{file, file_stamp(file)}}};
    if (auto good = check_file(file, limits); !good) return tl::unexpected(good.error());
    Assimp::Importer importer;
    auto files = std::make_unique<RecordedFiles>(file, limits.max_file_bytes);
    const RecordedFiles& recorded = *files;
    importer.SetIOHandler(files.release());  // which owns it
    importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    const aiScene* scene = importer.ReadFile(
        file.string(),
        aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType |
            aiProcess_FlipUVs | aiProcess_ValidateDataStructure);
    if (read != nullptr) *read = recorded.read();
    if (scene == nullptr) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: {}", file.string(), why_unreadable(file, importer)));
    }
    Eigen::Matrix4d model_from_file = Eigen::Matrix4d::Identity();
    const std::string missing = missing_material_file(file);
    if (is_gltf(file)) model_from_file << 1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1;
    model_from_file.topRows<3>() *= scale;
    auto parts = PartCollector(*scene, file, limits).take(model_from_file);
    if (!parts || missing.empty()) return parts;
    for (ModelPart& part : *parts) {  // Assimp gives each material a grey of its own
        part.colour = ModelPart().colour;
        part.has_colour = false;
        part.missing_materials = missing;
    }
    return parts;
}

}  // namespace atrium::model
