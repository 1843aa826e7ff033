#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/object_look.hpp"
#include "viewer/renderer/overlay.hpp"
#include "viewer/renderer/person_model.hpp"
#include "viewer/renderer/soft_surface.hpp"
#include "viewer/renderer/view_camera.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace atrium::renderer {

/// 8-bit RGBA, rows from the top.
struct RenderedPicture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

enum class Antialias : std::uint8_t { kNone, kFxaa };

struct RendererOptions {
    int width = 960;
    int height = 540;
    Antialias antialias = Antialias::kNone;
};

/// Draws people and objects on a floor, seen from anywhere. Knows no DDS and no window.
///
/// Every call is made on one thread, with the same GL 3.3 context current, destruction included.
/// The picture goes into a framebuffer of its own; `present` copies it to the window's.
class SceneRenderer {
public:
    static Expected<SceneRenderer> create(const RendererOptions& options);
    SceneRenderer(SceneRenderer&&) noexcept;
    SceneRenderer& operator=(SceneRenderer&&) noexcept;
    ~SceneRenderer();

    /// Draws some of everything once, people included, for drivers that compile a shader when
    /// something is first drawn with it, which takes as long as several pictures. Before there is
    /// anything to see.
    void warm_up(const ViewCamera& camera);

    /// Shows `model` as the person of `site` from now on. Returns the model that was shown before,
    /// whose memory can be used for the next one.
    PersonModel set_person(const std::string& site, PersonModel model);
    void set_site_pose(const std::string& site, const geometry::RigidTransform& world_from_site);
    Eigen::Matrix4d world_from_site(const std::string& site) const;  // identity where none was set
    /// 1: solid, as one who is new; 0: not seen at all.
    void set_person_opacity(const std::string& site, double opacity);
    void remove_person(const std::string& site);
    std::size_t num_people() const;

    /// Planes with their normal up are drawn as floor, on the ground that reaches to the horizon.
    void set_object(std::uint32_t object, const ObjectLook& look);
    /// Unknown objects are left alone: their description has not come yet.
    void move_object(std::uint32_t object, const geometry::RigidTransform& world_from_object);
    void remove_object(std::uint32_t object);
    std::size_t num_objects() const;

    void set_soft_object(std::uint32_t object, const SoftLook& look);
    /// Unknown objects, and other numbers of nodes than `set_soft_object` was told of, are left
    /// alone.
    void move_soft_object(std::uint32_t object, std::span<const Eigen::Vector3f> nodes_world);
    void remove_soft_object(std::uint32_t object);

    /// What is only looked at, in the place of what had that name before; nothing: it is gone.
    /// Parts that reach 3.5 m from their origin cast no shadow: they are rooms, around everything.
    void set_scenery(const std::string& name, std::span<const ObjectLook> parts);

    /// The picture that lies from now on on all things whose look names it; kept until the renderer
    /// ends.
    void set_texture(const std::string& name, const TexturePicture& picture);

    /// What is drawn over people and objects from now on.
    Overlay& overlay();

    Expected<void> resize(int width, int height);
    int width() const;
    int height() const;

    /// Draws the scene at `scale` in (0, 1] of the picture's width and height, and enlarges it with
    /// a linear filter. Labels keep the full resolution; lines do not. The picture's size stays.
    /// 1, the default, costs nothing and changes no pixel.
    Expected<void> set_scale(double scale);
    double scale() const;
    /// Whether people and things cast shadows on the floor; they do by default.
    void set_shadows(bool are_on);
    bool has_shadows() const;

    void draw(const ViewCamera& camera);
    /// What several eyes see, one after the other, each in its part. Parts cover the picture.
    void draw(std::span<const EyeView> eyes);

    /// Copies the picture into the framebuffer of the window or context that is current.
    void present() const;
    /// Likewise its left half into the buffer for the left eye and its right one into the other: of
    /// a window that has both.
    void present_halves() const;
    /// The picture as last drawn. `out` keeps its memory.
    void read_pixels(RenderedPicture& out) const;

private:
    struct Impl;
    explicit SceneRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::renderer
