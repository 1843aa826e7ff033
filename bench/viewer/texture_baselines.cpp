#include "bench/viewer/texture_baselines.hpp"

#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/person_shader_text.hpp"

#include <Eigen/Geometry>
#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace atrium::bench {
namespace {

constexpr std::size_t kSlots = 8;  // cameras of one triangle, as many as GL's 16 attributes allow

float cos_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return a.normalized().dot(b.normalized());
}

CameraWeights no_weights(const renderer::PersonModel& model) {
    return {model.cameras.size(), std::vector<float>(model.vertices_site.size(), 0.0F)};
}

std::vector<Eigen::Vector3f> normals_of(const renderer::PersonModel& model) {
    std::vector<Eigen::Vector3f> normals(model.vertices_site.size(), Eigen::Vector3f::Zero());
    for (const auto& [a, b, c] : model.triangles) {
        const Eigen::Vector3f& p = model.vertices_site[a];
        const Eigen::Vector3f twice_area =
            (model.vertices_site[b] - p).cross(model.vertices_site[c] - p);
        for (const std::uint32_t v : {a, b, c}) normals[v] += twice_area;
    }
    return normals;
}

}  // namespace

CameraWeights nearest_camera(const renderer::PersonModel& model, const Eigen::Vector3d& eye_site) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& p : model.vertices_site)
        middle += p / static_cast<float>(model.vertices_site.size());
    const Eigen::Vector3f to_eye = eye_site.cast<float>() - middle;
    std::size_t nearest = 0;
    for (std::size_t c = 1; c < model.cameras.size(); ++c) {
        if (cos_between(model.cameras[c].centre_site - middle, to_eye) >
            cos_between(model.cameras[nearest].centre_site - middle, to_eye))
            nearest = c;
    }
    CameraWeights weights = no_weights(model);
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v)
        weights[nearest][v] = model.cameras[nearest].quality[v] > 0.0F ? 1.0F : 0.0F;
    return weights;
}

CameraWeights nearest_seeing_camera(const renderer::PersonModel& model,
                                    const Eigen::Vector3d& eye_site) {
    CameraWeights weights = no_weights(model);
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        const Eigen::Vector3f& p = model.vertices_site[v];
        float best = -2.0F;
        std::size_t nearest = 0;
        for (std::size_t c = 0; c < model.cameras.size(); ++c) {
            if (model.cameras[c].quality[v] <= 0.0F) continue;
            const float cos_angle =
                cos_between(model.cameras[c].centre_site - p, eye_site.cast<float>() - p);
            if (cos_angle <= best) continue;
            best = cos_angle;
            nearest = c;
        }
        if (best > -2.0F) weights[nearest][v] = 1.0F;
    }
    return weights;
}

CameraWeights all_facing_cameras(const renderer::PersonModel& model) {
    const std::vector<Eigen::Vector3f> normals = normals_of(model);
    CameraWeights weights = no_weights(model);
    for (std::size_t v = 0; v < model.vertices_site.size(); ++v) {
        float sum = 0.0F;
        for (std::size_t c = 0; c < model.cameras.size(); ++c) {
            const Eigen::Vector3f to_camera = model.cameras[c].centre_site - model.vertices_site[v];
            weights[c][v] = normals[v].dot(to_camera) > 0.0F ? 1.0F : 0.0F;
            sum += weights[c][v];
        }
        for (auto& of_camera : weights) of_camera[v] /= std::max(sum, 1.0F);
    }
    return weights;
}

WeightedDrawing::WeightedDrawing(const renderer::PersonModel& model)
    : model_(model), layout_(gl::make_vertex_array()), vertices_(gl::make_buffer()) {
    auto shader = gl::ShaderProgram::create("weighted person",
                                            renderer::shaders::person_vertex(kSlots),
                                            renderer::shaders::person_fragment(kSlots));
    if (!shader) {
        std::fprintf(stderr, "%s\n", shader.error().message.c_str());
        std::exit(1);
    }
    shader_ = std::move(*shader);
    glBindVertexArray(layout_.id());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
    const std::size_t stride = renderer::floats_per_vertex(kSlots) * sizeof(float);
    unsigned index = 0;
    std::size_t offset = 0;
    const auto add = [&](int count) {
        gl::float_attribute(index++, count, stride, offset * sizeof(float));
        offset += static_cast<std::size_t>(count);
    };
    add(3);
    add(3);
    for (std::size_t i = 0; i < kSlots; i += renderer::shaders::kLayersPerAttribute)
        add(static_cast<int>(renderer::shaders::kLayersPerAttribute));
    for (std::size_t i = 0; i < kSlots; ++i) add(4);
    GLuint id = 0;
    glGenTextures(1, &id);
    pictures_ = gl::Texture(id);
    glBindTexture(GL_TEXTURE_2D_ARRAY, id);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage3D(GL_TEXTURE_2D_ARRAY,
                 0,
                 GL_RGBA8,
                 model.layer_width,
                 model.layer_height,
                 static_cast<int>(model.cameras.size()),
                 0,
                 GL_RGBA,
                 GL_UNSIGNED_BYTE,
                 model.layers.data());
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

void WeightedDrawing::lay_out(const CameraWeights& weights, const Eigen::Vector3f& eye_site) {
    data_.clear();
    for (const auto& triangle : model_.triangles) {
        const Eigen::Vector3f& a = model_.vertices_site[triangle[0]];
        const Eigen::Vector3f normal =
            (model_.vertices_site[triangle[1]] - a).cross(model_.vertices_site[triangle[2]] - a);
        if (!(normal.dot(eye_site - a) > 0.0F)) continue;
        // the cameras with the largest sum of weights at the corners
        std::vector<std::pair<float, std::size_t>> used;
        for (std::size_t c = 0; c < weights.size(); ++c) {
            const float sum =
                weights[c][triangle[0]] + weights[c][triangle[1]] + weights[c][triangle[2]];
            if (sum > 0.0F) used.emplace_back(-sum, c);
        }
        std::sort(used.begin(), used.end());
        used.resize(kSlots, {0.0F, 0});
        for (const std::uint32_t v : triangle) {
            const Eigen::Vector3f& p = model_.vertices_site[v];
            const Eigen::Vector3f& fallback = model_.fallback[v];
            data_.insert(data_.end(), {p.x(), p.y(), p.z()});
            data_.insert(data_.end(), {fallback.x(), fallback.y(), fallback.z()});
            for (const auto& [sum, c] : used) data_.push_back(static_cast<float>(c));
            for (const auto& [sum, c] : used) {
                const Eigen::Vector3f& st = model_.cameras[c].layer_coordinates[v];
                data_.insert(data_.end(),
                             {st.x(), st.y(), st.z(), sum < 0.0F ? weights[c][v] : 0.0F});
            }
        }
    }
}

void WeightedDrawing::draw(const CameraWeights& weights,
                           const Eigen::Matrix4d& clip_from_site,
                           const Eigen::Vector3d& eye_site) {
    lay_out(weights, eye_site.cast<float>());
    gl::upload(vertices_, GL_ARRAY_BUFFER, std::span<const float>(data_), GL_STREAM_DRAW);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, pictures_.id());
    shader_.use();
    shader_.set("clip_from_site", Eigen::Matrix4f(clip_from_site.cast<float>()));
    shader_.set("pictures", 0);
    glBindVertexArray(layout_.id());
    glDrawArrays(
        GL_TRIANGLES, 0, static_cast<GLsizei>(data_.size() / renderer::floats_per_vertex(kSlots)));
}

}  // namespace atrium::bench
