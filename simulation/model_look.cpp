#include "simulation/model_look.hpp"

#include "simulation/model_pictures.hpp"

#include <assimp/GltfMaterial.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace atrium::simulation {
namespace {

const Eigen::Vector3f kGrey(0.6f, 0.6f, 0.6f);
constexpr float kBlack = 0.02f;

// Empty if the data is no picture.
ModelTexture embedded_texture(const aiTexture& embedded) {
    if (embedded.mHeight == 0) {  // an encoded file of mWidth bytes
        return decode_picture(
            {reinterpret_cast<const std::uint8_t*>(embedded.pcData), embedded.mWidth});
    }
    ModelTexture texture;
    texture.width = static_cast<int>(embedded.mWidth);
    texture.height = static_cast<int>(embedded.mHeight);
    const std::size_t num_texels = std::size_t{embedded.mWidth} * embedded.mHeight;
    for (std::size_t i = 0; i < num_texels; ++i) {
        const aiTexel& texel = embedded.pcData[i];
        texture.rgba.insert(texture.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
    }
    return texture;
}

std::string path_of(const aiMaterial& material, std::initializer_list<aiTextureType> types) {
    for (const aiTextureType type : types) {
        aiString path;
        if (material.GetTexture(type, 0, &path) == aiReturn_SUCCESS && path.length > 0)
            return path.C_Str();
    }
    return {};
}

bool has_gltf_holes(const aiMaterial& material) {
    aiString mode;
    return material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS &&
           std::strcmp(mode.C_Str(), "OPAQUE") != 0;
}

bool has_transparent_places(const ModelTexture& texture) {
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
        if (texture.rgba[i] < 128) return true;
    }
    return false;
}

}  // namespace

ModelLook::Look ModelLook::look_of(const aiMaterial& material, bool has_texture_places) {
    ++num_materials_;
    aiColor4D colour(0.8f, 0.8f, 0.8f, 1.0f);
    if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS)
        material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    Look look{.colour = {colour.r, colour.g, colour.b}, .texture = -1, .is_cut_out = false};
    if (!look.colour.allFinite()) look.colour = kGrey;
    const std::string path = path_of(
        material, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE, aiTextureType_EMISSIVE});
    const std::string opacity = path_of(material, {aiTextureType_OPACITY});
    if (!path.empty() && has_texture_places) look.texture = texture_of(path);
    const bool is_black = look.colour.maxCoeff() < kBlack;
    if (look.texture < 0) {
        if (is_black) ++num_black_;
        if (is_black && !path.empty()) {
            look.colour = kGrey;
            ++num_grey_;
        }
        return look;
    }
    // in FBX and Collada a texture replaces the colour, which is often left black
    if (is_black) look.colour.setOnes();
    if (!opacity.empty()) look.texture = with_opacity(look.texture, opacity);
    look.is_cut_out = (!opacity.empty() || has_gltf_holes(material)) &&
                      has_transparent_places(textures_[static_cast<std::size_t>(look.texture)]);
    return look;
}

// Returns -1 if it cannot be found or read.
int ModelLook::texture_of(const std::string& path) {
    const auto known = known_.find(path);
    if (known != known_.end()) return known->second;
    ModelTexture texture;
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(path.c_str())) {
        texture = embedded_texture(*embedded);
        if (texture.rgba.empty()) unreadable_.insert(fmt::format("{} (in the model)", path));
    } else if (const auto found = find_picture(path, file_)) {
        texture = read_picture(*found);
        if (texture.rgba.empty()) unreadable_.insert(found->string());
    } else {
        missing_.insert(path);
    }
    int index = -1;
    if (!texture.rgba.empty()) {
        index = static_cast<int>(textures_.size());
        textures_.push_back(std::move(texture));
    }
    known_.emplace(path, index);
    return index;
}

// Returns the texture with the alpha of the opacity picture: its own alpha where it has one, else
// its brightness.
int ModelLook::with_opacity(int texture, const std::string& path) {
    const int mask_index = texture_of(path);
    if (mask_index < 0 || mask_index == texture) return texture;
    const auto known = known_opacity_.find({texture, path});
    if (known != known_opacity_.end()) return known->second;
    ModelTexture combined = textures_[static_cast<std::size_t>(texture)];
    const ModelTexture& mask = textures_[static_cast<std::size_t>(mask_index)];
    const std::size_t channel = has_transparent_places(mask) ? 3 : 1;
    for (int y = 0; y < combined.height; ++y) {
        for (int x = 0; x < combined.width; ++x) {
            const int mask_x = x * mask.width / combined.width;
            const int mask_y = y * mask.height / combined.height;
            const auto from = static_cast<std::size_t>(mask_y * mask.width + mask_x);
            const auto to = static_cast<std::size_t>(y * combined.width + x);
            combined.rgba[4 * to + 3] = mask.rgba[4 * from + channel];
        }
    }
    const int index = static_cast<int>(textures_.size());
    textures_.push_back(std::move(combined));
    known_opacity_.emplace(std::pair(texture, path), index);
    return index;
}

std::vector<std::string> ModelLook::warnings() const {
    std::vector<std::string> warnings;
    const auto list = [](const std::set<std::string>& names) {
        constexpr std::size_t kMost = 8;
        std::vector<std::string> first;
        for (const std::string& name : names) {
            if (first.size() < kMost) first.push_back(name);
        }
        return fmt::format(
            "{}{}",
            fmt::join(first, ", "),
            names.size() > kMost ? fmt::format(" and {} more", names.size() - kMost) : "");
    };
    if (!missing_.empty()) {
        warnings.push_back(fmt::format(
            "missing textures: {}; {}. Put the files beside the model or into a folder 'textures' "
            "there",
            list(missing_),
            num_grey_ > 0 ? "black materials without them are drawn grey"
                          : "the colours of the materials are drawn"));
    }
    if (!unreadable_.empty()) {
        warnings.push_back(fmt::format(
            "textures that cannot be read: {}. Convert them to PNG, JPEG or TGA, keep the name",
            list(unreadable_)));
    }
    if (is_all_black() && num_black_ > num_grey_) {
        warnings.emplace_back(
            "all materials are black and name no picture; the model is drawn grey. Export it with "
            "its textures");
    }
    return warnings;
}

}  // namespace atrium::simulation
