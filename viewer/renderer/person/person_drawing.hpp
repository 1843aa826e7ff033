#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/backdrop/shadow_heights.hpp"
#include "viewer/renderer/drawing/triangle_coverage.hpp"
#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/outline_strip.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

/// Shaders of all people, one per group of triangles.
struct PersonShaders {
    std::array<gl::ShaderProgram, kCamerasPerTriangle.size()> by_group;
    gl::ShaderProgram outline;
    static Expected<PersonShaders> create();
};

/// One person in GL memory.
class PersonDrawing {
public:
    PersonDrawing();

    /// Replaces the model and uploads what does not depend on the viewpoint. Returns the former
    /// model for reuse.
    PersonModel set_model(PersonModel model);
    void set_pose(const Eigen::Matrix4d& world_from_site);
    /// Sets the opacity. Blending and shadow are up to the caller, but for `draw_outline`.
    void set_opacity(double opacity) { opacity_ = opacity; }
    double opacity() const { return opacity_; }
    bool is_solid() const { return opacity_ >= 1.0; }

    const PersonModel& model() const { return model_; }
    const Eigen::Matrix4d& world_from_site() const { return world_from_site_; }
    Eigen::AlignedBox3d bounds_world() const;
    /// Texture array with one layer per camera of the model.
    const gl::Texture& pictures() const { return pictures_; }

    void draw(const PersonShaders& shaders,
              const Eigen::Matrix4d& clip_from_world,
              const Eigen::Vector3d& eye_world);
    /// Draws the strip around the outline (OutlineStrip) over what is behind it, after that and
    /// after `draw`, in a picture of this height. Nothing if the person is so small that it could
    /// not be seen. Leaves blending off and depth writes on.
    void draw_outline(const PersonShaders& shaders,
                      const Eigen::Matrix4d& clip_from_world,
                      const Eigen::Vector3d& eye_world,
                      int height_px);
    /// Pixels of the shadow map that the person covers, and how high it is above them
    /// (`Backdrop::add_shadow`).
    std::span<const PixelRun> shadow() const { return shadow_scratch_.runs; }
    const ShadowHeights& shadow_heights() const { return shadow_scratch_.heights; }

private:
    void upload_pictures();
    void blend(const Eigen::Vector3d& eye_world);
    void find_strip();
    void find_shadow();
    double px_per_m(const Eigen::Matrix4d& clip_from_world, int height_px) const;

    struct Group {
        gl::VertexArray layout;
        gl::Buffer vertices;
        std::size_t capacity_bytes = 0;
    };
    struct ShadowScratch {
        std::vector<Eigen::Vector2f> corners_px;
        CoverageScratch cover;
        std::vector<PixelRun> runs;
        ShadowHeights heights;
    };
    PersonModel model_;
    Eigen::Matrix4d world_from_site_ = Eigen::Matrix4d::Identity();
    double opacity_ = 1.0;
    std::array<Group, kCamerasPerTriangle.size()> groups_;
    OutlineStrip strip_;
    bool has_strip_ = false;  // `strip_` is that of `blended_`
    Group strip_group_;
    BlendScratch scratch_;
    BlendedMesh blended_;
    bool is_blended_ = false;  // `blended_` is of this model, seen from `blended_eye_site_`
    Eigen::Vector3f blended_eye_site_ = Eigen::Vector3f::Zero();

    gl::Texture pictures_;  // array, one layer per camera
    std::array<int, 3> pictures_size_{};
    ShadowScratch shadow_scratch_;
};

}  // namespace atrium::renderer
