#pragma once

#include "simulation/model.hpp"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

struct aiMaterial;
struct aiScene;

namespace atrium::simulation {

/// Colours and pictures of a model's materials.
class ModelLook {
public:
    ModelLook(const aiScene& scene, const std::filesystem::path& file)
        : scene_(scene), file_(file) {}

    struct Look {
        Eigen::Vector3f colour;   // multiplies the texture
        int texture = -1;         // -1: none
        bool is_cut_out = false;  // the texture's transparent places are holes
    };
    /// The look of a material. A black one without a picture that the file names is grey.
    Look look_of(const aiMaterial& material, bool has_texture_places);

    /// True if every material so far is black and has no picture.
    bool is_all_black() const { return num_black_ == num_materials_ && num_materials_ > 0; }
    std::vector<ModelTexture> take_textures() { return std::move(textures_); }
    /// What is missing or replaced. Call it last.
    std::vector<std::string> warnings() const;

private:
    int texture_of(const std::string& path);
    int with_opacity(int texture, const std::string& path);

    const aiScene& scene_;
    const std::filesystem::path& file_;
    std::vector<ModelTexture> textures_;
    std::map<std::string, int> known_;
    std::map<std::pair<int, std::string>, int> known_opacity_;
    std::set<std::string> missing_, unreadable_;
    std::size_t num_materials_ = 0;
    std::size_t num_black_ = 0;
    std::size_t num_grey_ = 0;
};

}  // namespace atrium::simulation
