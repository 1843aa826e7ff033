#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/renderer/object/soft_surface.hpp"
#include "viewer/renderer/overlay.hpp"
#include "viewer/renderer/person/person_model.hpp"
#include "viewer/renderer/rendered_picture.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace atrium::renderer {

struct RendererOptions {
    int width = 960;
    int height = 540;
    Antialias antialias = Antialias::kNone;
    bool has_soft_outlines = true;  // of people (OutlineStrip)
};

/// Draws people and objects on a floor from any viewpoint. Knows no DDS and no window.
///
/// Make every call on one thread with the same GL 3.3 context current, destruction included. Draws
/// into its own framebuffer; `present` copies that to the window.
class SceneRenderer {
public:
    static Expected<SceneRenderer> create(const RendererOptions& options);
    SceneRenderer(SceneRenderer&&) noexcept;
    SceneRenderer& operator=(SceneRenderer&&) noexcept;
    ~SceneRenderer();

    /// Draws every kind of object and person once. Some drivers compile a shader at its first use,
    /// which takes as long as several pictures. Call it while the scene is empty.
    void warm_up(const ViewCamera& camera);

    /// Shows `model` as the person of `site`. Returns the former model for reuse.
    PersonModel set_person(const std::string& site, PersonModel model);
    void set_site_pose(const std::string& site, const geometry::RigidTransform& world_from_site);
    Eigen::Matrix4d world_from_site(const std::string& site) const;  // identity if none was set
    /// 1: solid, the value of a new person; 0: invisible.
    void set_person_opacity(const std::string& site, double opacity);
    void remove_person(const std::string& site);
    std::size_t num_people() const;

    /// Sets an object. Planes with their normal up are drawn as floor, on the ground that reaches
    /// to the horizon.
    void set_object(std::uint32_t object, const ObjectLook& look);
    /// Moves an object. Ignores unknown objects, whose description has not arrived yet.
    void move_object(std::uint32_t object, const geometry::RigidTransform& world_from_object);
    void remove_object(std::uint32_t object);
    std::size_t num_objects() const;

    void set_soft_object(std::uint32_t object, const SoftLook& look);
    /// Moves the nodes of a soft object. Ignores unknown objects and numbers of nodes that differ
    /// from `set_soft_object`.
    void move_soft_object(std::uint32_t object, std::span<const Eigen::Vector3f> nodes_world);
    void remove_soft_object(std::uint32_t object);

    /// Sets scenery under a name, or removes it if `parts` is empty. Scenery is only visual. Parts
    /// that reach 3.5 m from their origin cast no shadow: they are rooms around everything.
    void set_scenery(const std::string& name, std::span<const ObjectLook> parts);

    /// Sets the texture for all objects that name it. Kept as long as the renderer.
    void set_texture(const std::string& name, const TexturePicture& picture);

    /// Labels and lines over the scene.
    Overlay& overlay();

    Expected<void> resize(int width, int height);
    int width() const;
    int height() const;

    /// Sets the resolution of the scene as a share in (0, 1] of the picture's width and height; a
    /// linear filter enlarges it. Labels keep the full resolution, lines do not. The size of the
    /// picture does not change. 1, the default, costs nothing and changes no pixel.
    Expected<void> set_scale(double scale);
    double scale() const;
    /// Whether people and objects cast shadows on the floor. On by default.
    void set_shadows(bool are_on);
    bool has_shadows() const;

    void draw(const ViewCamera& camera);
    /// Draws several eyes, each into its part. The parts cover the picture.
    void draw(std::span<const EyeView> eyes);

    /// Copies the picture into the framebuffer of the current window or context.
    void present() const;
    /// Copies the left half into the buffer for the left eye and the right half into the other.
    /// Needs a stereo window.
    void present_halves() const;
    /// Reads back the last picture. Reuses the memory of `out`.
    void read_pixels(RenderedPicture& out) const;

private:
    struct Impl;
    explicit SceneRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::renderer
