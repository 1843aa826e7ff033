#include "simulation/model_look.hpp"
#include "simulation/model_nodes.hpp"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

// Converts Assimp's scene to a rig and a surface.
namespace atrium::simulation {
namespace {

constexpr std::size_t kMaxVertices = 4'000'000;
class Importer {
public:
    Importer(const aiScene& scene, const std::filesystem::path& file)
        : scene_(scene), file_(file), look_(scene, file_) {}

    Expected<ModelParts> run() {
        if (auto taken = take_nodes(scene_, file_, parts_.rig); !taken)
            return tl::unexpected(taken.error());
        for (std::size_t i = 0; i < parts_.rig.nodes.size(); ++i)
            by_name_.emplace(parts_.rig.nodes[i].name, i);
        std::size_t next = 0;
        list_meshes(*scene_.mRootNode, next);
        parts_.rig.first_weight.push_back(0);
        for (const auto& [node, index] : meshes_) {
            if (auto added = add_mesh(node, *scene_.mMeshes[index]); !added)
                return tl::unexpected(added.error());
        }
        if (parts_.surface.triangles.empty()) return no_triangles();
        if (look_.is_all_black()) {
            for (Eigen::Vector3f& colour : parts_.surface.colours) colour.setConstant(0.6f);
        }
        parts_.surface.textures = look_.take_textures();
        parts_.warnings = look_.warnings();
        parts_.rig.num_skin_bones = skin_nodes_.size();
        take_animation(scene_, parts_.rig);
        return std::move(parts_);
    }

private:
    tl::unexpected<Error> invalid(const std::string& what) const {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file_.string(), what));
    }

    tl::unexpected<Error> no_triangles() const {
        if (scene_.mNumAnimations == 0) return invalid("has no triangles");
        return invalid(
            "has no triangles, only bones and a motion. Give it as simulation.motion_file, and as "
            "simulation.model a file with a mesh (exported \"with skin\")");
    }

    // In the order of `take_nodes`.
    void list_meshes(const aiNode& node, std::size_t& next) {
        const std::size_t index = next++;
        for (unsigned i = 0; i < node.mNumMeshes; ++i) meshes_.emplace_back(index, node.mMeshes[i]);
        for (unsigned i = 0; i < node.mNumChildren; ++i) list_meshes(*node.mChildren[i], next);
    }

    Expected<void> add_mesh(std::size_t node, const aiMesh& mesh) {
        if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return {};
        const std::size_t first = parts_.rig.positions.size();
        if (first + mesh.mNumVertices > kMaxVertices)
            return invalid(fmt::format("has more than {} vertices", kMaxVertices));
        ModelSurface& surface = parts_.surface;
        const aiMaterial& material = *scene_.mMaterials[mesh.mMaterialIndex];
        const ModelLook::Look look = look_.look_of(material, mesh.HasTextureCoords(0));
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            parts_.rig.positions.push_back(to_eigen(mesh.mVertices[v]));
            parts_.rig.normals.push_back(mesh.HasNormals() ? to_eigen(mesh.mNormals[v])
                                                           : Eigen::Vector3f::UnitY());
            surface.texture_places.push_back(
                mesh.HasTextureCoords(0)
                    ? Eigen::Vector2f(mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y)
                    : Eigen::Vector2f::Zero());
            surface.colours.push_back(look.colour);
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
                       .texture = look.texture,
                       .is_cut_out = look.is_cut_out};
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
            skin_nodes_.insert(carrier->second);  // several meshes may share a bone
            const auto index = static_cast<std::uint32_t>(rig.bones.size());
            rig.bones.push_back({carrier->second, to_eigen(bone.mOffsetMatrix), node});
            for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                const aiVertexWeight& weight = bone.mWeights[w];
                if (weight.mVertexId < mesh.mNumVertices && weight.mWeight > 0.0f)
                    of_vertex[weight.mVertexId].push_back({index, weight.mWeight});
            }
        }
        const auto rigid = static_cast<std::uint32_t>(rig.bones.size());
        rig.bones.push_back(
            {node, Eigen::Affine3f::Identity(), node});  // for vertices without bones
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

    const aiScene& scene_;
    const std::filesystem::path file_;
    ModelLook look_;
    ModelParts parts_;
    std::map<std::string, std::size_t> by_name_;
    std::set<std::size_t> skin_nodes_;
    std::vector<std::pair<std::size_t, unsigned>> meshes_;  // node, mesh
};

}  // namespace

Expected<ModelParts> take_model(const aiScene& scene, const std::filesystem::path& file) {
    return Importer(scene, file).run();
}

}  // namespace atrium::simulation
