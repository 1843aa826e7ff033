#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/camera_blend.hpp"
#include "viewer/renderer/person_model.hpp"

#include <array>

namespace atrium::renderer {

/// The shaders that all people share: one per group of triangles.
struct PersonShaders {
    std::array<gl::ShaderProgram, kCamerasPerTriangle.size()> by_group;
    static Expected<PersonShaders> create();
};

/// One person in GL's memory.
class PersonDrawing {
public:
    PersonDrawing();

    /// Takes over what it draws from now on and uploads what does not depend on the viewpoint.
    /// Hands back the former model, so that its memory can be used again.
    PersonModel set_model(PersonModel model);
    void set_pose(const Eigen::Matrix4d& world_from_site);
    /// What it blends with, or makes its shadow of, is up to the caller.
    void set_opacity(double opacity) { opacity_ = opacity; }
    double opacity() const { return opacity_; }
    bool is_solid() const { return opacity_ >= 1.0; }

    const PersonModel& model() const { return model_; }
    const Eigen::Matrix4d& world_from_site() const { return world_from_site_; }
    /// Array, one layer for each of the model's cameras.
    const gl::Texture& pictures() const { return pictures_; }

    void draw(const PersonShaders& shaders,
              const Eigen::Matrix4d& clip_from_world,
              const Eigen::Vector3d& eye_world);
    /// Draws the bare surface with the shader in use, whose "world_from_object" it sets.
    void draw_surface(const gl::ShaderProgram& shader) const;

private:
    void upload_pictures();
    void blend(const Eigen::Vector3f& eye_site);

    struct Group {
        gl::VertexArray layout;
        gl::Buffer vertices;
    };
    PersonModel model_;
    Eigen::Matrix4d world_from_site_ = Eigen::Matrix4d::Identity();
    double opacity_ = 1.0;
    std::array<Group, kCamerasPerTriangle.size()> groups_;
    BlendScratch scratch_;
    BlendedMesh blended_;
    bool is_blended_ = false;  // `blended_` is of this model, seen from `blended_eye_site_`
    Eigen::Vector3f blended_eye_site_ = Eigen::Vector3f::Zero();

    gl::Texture pictures_;  // array, one layer per camera
    std::array<int, 3> pictures_size_{};
    gl::VertexArray surface_layout_;
    gl::Buffer surface_vertices_;
    gl::Buffer surface_indices_;
};

}  // namespace atrium::renderer
