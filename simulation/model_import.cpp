#include "simulation/model_rig.hpp"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <map>
#include <optional>

// Converts Assimp's scene to a rig and a surface.
namespace atrium::simulation {
namespace {

constexpr std::size_t kMaxVertices = 4'000'000;
constexpr int kMaxDepth = 1000;

Eigen::Affine3f to_eigen(const aiMatrix4x4& m) {
    Eigen::Affine3f transform;
    transform.matrix() << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4,
        0.0f, 0.0f, 0.0f, 1.0f;
    return transform;
}

Eigen::Vector3f to_eigen(const aiVector3D& v) { return {v.x, v.y, v.z}; }

ModelTexture to_texture(const cv::Mat& bgr) {
    ModelTexture texture;
    if (bgr.empty()) return texture;
    texture.width = bgr.cols;
    texture.height = bgr.rows;
    for (int y = 0; y < bgr.rows; ++y) {
        for (int x = 0; x < bgr.cols; ++x) {
            const auto& pixel = bgr.at<cv::Vec3b>(y, x);
            texture.rgb.insert(texture.rgb.end(), {pixel[2], pixel[1], pixel[0]});
        }
    }
    return texture;
}

// Empty if the data is no picture.
ModelTexture embedded_texture(const aiTexture& embedded) {
    if (embedded.mHeight == 0) {  // an encoded file of mWidth bytes
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(embedded.pcData);
        const std::vector<std::uint8_t> file(bytes, bytes + embedded.mWidth);
        return to_texture(cv::imdecode(file, cv::IMREAD_COLOR));
    }
    ModelTexture texture;
    texture.width = static_cast<int>(embedded.mWidth);
    texture.height = static_cast<int>(embedded.mHeight);
    const std::size_t num_texels = std::size_t{embedded.mWidth} * embedded.mHeight;
    for (std::size_t i = 0; i < num_texels; ++i) {
        const aiTexel& texel = embedded.pcData[i];
        texture.rgb.insert(texture.rgb.end(), {texel.r, texel.g, texel.b});
    }
    return texture;
}

class Importer {
public:
    Importer(const aiScene& scene, const std::filesystem::path& file)
        : scene_(scene), folder_(file.parent_path()), file_(file) {}

    Expected<ModelParts> run() {
        if (scene_.mRootNode == nullptr) return invalid("has no nodes");
        if (!add_nodes(*scene_.mRootNode, -1, 0)) return invalid("its nodes are nested too deeply");
        parts_.rig.first_weight.push_back(0);
        for (const auto& [node, index] : meshes_) {
            if (auto added = add_mesh(node, *scene_.mMeshes[index]); !added)
                return tl::unexpected(added.error());
        }
        if (parts_.surface.triangles.empty()) return invalid("has no triangles");
        if (scene_.mNumAnimations > 0) add_animation(*scene_.mAnimations[0]);
        if (scene_.mMetaData != nullptr) {
            int up_axis = 1;
            if (scene_.mMetaData->Get("UpAxis", up_axis)) parts_.rig.is_z_up = up_axis == 2;
        }
        return std::move(parts_);
    }

private:
    tl::unexpected<Error> invalid(const std::string& what) const {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file_.string(), what));
    }

    bool add_nodes(const aiNode& node, int parent, int depth) {
        if (depth > kMaxDepth) return false;
        const std::size_t index = parts_.rig.nodes.size();
        ModelNode ours;
        ours.parent = parent;
        ours.parent_from_node = to_eigen(node.mTransformation);
        parts_.rig.nodes.push_back(std::move(ours));
        by_name_.emplace(node.mName.C_Str(), index);
        for (unsigned i = 0; i < node.mNumMeshes; ++i) meshes_.emplace_back(index, node.mMeshes[i]);
        for (unsigned i = 0; i < node.mNumChildren; ++i) {
            if (!add_nodes(*node.mChildren[i], static_cast<int>(index), depth + 1)) return false;
        }
        return true;
    }

    Expected<void> add_mesh(std::size_t node, const aiMesh& mesh) {
        if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return {};
        const std::size_t first = parts_.rig.positions.size();
        if (first + mesh.mNumVertices > kMaxVertices)
            return invalid(fmt::format("has more than {} vertices", kMaxVertices));
        ModelSurface& surface = parts_.surface;
        const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
        const Eigen::Vector3f colour = colour_of(material);
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            parts_.rig.positions.push_back(to_eigen(mesh.mVertices[v]));
            parts_.rig.normals.push_back(mesh.HasNormals() ? to_eigen(mesh.mNormals[v])
                                                           : Eigen::Vector3f::UnitY());
            surface.texture_places.push_back(
                mesh.HasTextureCoords(0)
                    ? Eigen::Vector2f(mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y)
                    : Eigen::Vector2f::Zero());
            surface.colours.push_back(colour);
            if (mesh.HasVertexColors(0)) {
                const aiColor4D& own = mesh.mColors[0][v];
                surface.colours.back().array() *= Eigen::Array3f(own.r, own.g, own.b);
            }
            if (!parts_.rig.positions.back().allFinite())
                return invalid(
                    fmt::format("mesh {} has vertices that are not finite", mesh.mName.C_Str()));
        }
        ModelPart part{.first_triangle = surface.triangles.size(),
                       .num_triangles = 0,
                       .texture = mesh.HasTextureCoords(0) ? texture_of(material) : -1};
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
            const aiFace& face = mesh.mFaces[f];
            if (face.mNumIndices != 3) continue;
            std::array<std::uint32_t, 3> triangle{};
            for (std::size_t k = 0; k < 3; ++k)
                triangle[k] = static_cast<std::uint32_t>(first + face.mIndices[k]);
            surface.triangles.push_back(triangle);
        }
        part.num_triangles = surface.triangles.size() - part.first_triangle;
        surface.parts.push_back(part);
        return add_weights(node, mesh);
    }

    Expected<void> add_weights(std::size_t node, const aiMesh& mesh) {
        ModelRig& rig = parts_.rig;
        std::vector<std::vector<BoneWeight>> of_vertex(mesh.mNumVertices);
        for (unsigned b = 0; b < mesh.mNumBones; ++b) {
            const aiBone& bone = *mesh.mBones[b];
            const auto carrier = by_name_.find(bone.mName.C_Str());
            if (carrier == by_name_.end())
                return invalid(fmt::format("bone '{}' is not a node", bone.mName.C_Str()));
            const auto index = static_cast<std::uint32_t>(rig.bones.size());
            rig.bones.push_back({carrier->second, to_eigen(bone.mOffsetMatrix)});
            for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                const aiVertexWeight& weight = bone.mWeights[w];
                if (weight.mVertexId < mesh.mNumVertices && weight.mWeight > 0.0f)
                    of_vertex[weight.mVertexId].push_back({index, weight.mWeight});
            }
        }
        const auto rigid = static_cast<std::uint32_t>(rig.bones.size());
        rig.bones.push_back({node, Eigen::Affine3f::Identity()});  // for vertices without bones
        for (std::vector<BoneWeight>& weights : of_vertex) {
            float sum = 0.0f;
            for (const BoneWeight& weight : weights) sum += weight.weight;
            if (weights.empty()) weights.push_back({rigid, sum = 1.0f});
            for (const BoneWeight& weight : weights)
                rig.weights.push_back({weight.bone, weight.weight / sum});
            rig.first_weight.push_back(static_cast<std::uint32_t>(rig.weights.size()));
        }
        return {};
    }

    static Eigen::Vector3f colour_of(const aiMaterial& material) {
        aiColor4D colour(0.8f, 0.8f, 0.8f, 1.0f);
        if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS)
            material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
        return {colour.r, colour.g, colour.b};
    }

    // Returns -1 if it has no readable texture.
    int texture_of(const aiMaterial& material) {
        aiString path;
        if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &path) != aiReturn_SUCCESS &&
            material.GetTexture(aiTextureType_DIFFUSE, 0, &path) != aiReturn_SUCCESS) {
            return -1;
        }
        const auto known = textures_.find(path.C_Str());
        if (known != textures_.end()) return known->second;
        ModelTexture texture;
        if (const aiTexture* embedded = scene_.GetEmbeddedTexture(path.C_Str())) {
            texture = embedded_texture(*embedded);
        } else {
            std::string name = path.C_Str();
            std::replace(name.begin(), name.end(), '\\', '/');
            texture = to_texture(cv::imread((folder_ / name).string(), cv::IMREAD_COLOR));
        }
        int index = -1;
        if (!texture.rgb.empty()) {
            index = static_cast<int>(parts_.surface.textures.size());
            parts_.surface.textures.push_back(std::move(texture));
        }
        textures_.emplace(path.C_Str(), index);
        return index;
    }

    void add_animation(const aiAnimation& animation) {
        // Assimp's documented default
        const double ticks_per_s =
            animation.mTicksPerSecond > 0.0 ? animation.mTicksPerSecond : 25.0;
        parts_.rig.duration_s = std::max(0.0, animation.mDuration / ticks_per_s);
        for (unsigned c = 0; c < animation.mNumChannels; ++c) {
            const aiNodeAnim& channel = *animation.mChannels[c];
            const auto found = by_name_.find(channel.mNodeName.C_Str());
            if (found == by_name_.end()) continue;
            ModelNode& node = parts_.rig.nodes[found->second];
            for (unsigned k = 0; k < channel.mNumPositionKeys; ++k) {
                const aiVectorKey& key = channel.mPositionKeys[k];
                node.translations.push_back({key.mTime / ticks_per_s, to_eigen(key.mValue)});
            }
            for (unsigned k = 0; k < channel.mNumRotationKeys; ++k) {
                const aiQuaternion& q = channel.mRotationKeys[k].mValue;
                node.rotations.push_back({channel.mRotationKeys[k].mTime / ticks_per_s,
                                          Eigen::Quaternionf(q.w, q.x, q.y, q.z).normalized()});
            }
            for (unsigned k = 0; k < channel.mNumScalingKeys; ++k) {
                const aiVectorKey& key = channel.mScalingKeys[k];
                node.scales.push_back({key.mTime / ticks_per_s, to_eigen(key.mValue)});
            }
        }
    }

    const aiScene& scene_;
    const std::filesystem::path folder_;
    const std::filesystem::path file_;
    ModelParts parts_;
    std::map<std::string, std::size_t> by_name_;
    std::vector<std::pair<std::size_t, unsigned>> meshes_;  // node, mesh
    std::map<std::string, int> textures_;
};

}  // namespace

Expected<ModelParts> take_model(const aiScene& scene, const std::filesystem::path& file) {
    return Importer(scene, file).run();
}

}  // namespace atrium::simulation
