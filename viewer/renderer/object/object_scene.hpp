#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/renderer/backdrop/backdrop.hpp"
#include "viewer/renderer/drawing/textures.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/renderer/object/object_batch.hpp"
#include "viewer/renderer/object/object_drawing.hpp"
#include "viewer/renderer/object/object_mesh.hpp"
#include "viewer/renderer/object/object_shaders.hpp"

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace atrium::renderer {

/// Holds and draws the rigid objects, soft objects and scenery of a scene. SceneRenderer documents
/// them.
class ObjectScene {
public:
    static Expected<ObjectScene> create();

    /// Effect of a change on the floor. kFloor: its shape or place, and so its shadows, too.
    enum class Affects : std::uint8_t { kNothing, kShadows, kFloor };
    Affects set(std::uint32_t object, const ObjectLook& look);
    Affects move(std::uint32_t object, const geometry::RigidTransform& world_from_object);
    Affects remove(std::uint32_t object);
    Affects move_soft(std::uint32_t object, std::span<const Eigen::Vector3f> nodes_world);
    // these affect shadows only
    void set_soft(std::uint32_t object, const SoftLook& look);
    void remove_soft(std::uint32_t object) { soft_objects_.erase(object); }
    void set_scenery(const std::string& name, std::span<const ObjectLook> parts);

    /// Number of objects, soft ones included, without scenery.
    std::size_t size() const { return objects_.size() + soft_objects_.size(); }
    /// Planes with their normal up, which the backdrop draws. Valid until the next change.
    std::vector<const ObjectLook*> floors() const;
    Textures& textures() { return textures_; }

    /// Draws all but the floors.
    void draw(const View& view);
    /// Draws the shadows of all but planes and rooms. Call it where Backdrop expects solid shapes.
    void draw_shadows(Backdrop& backdrop);
    /// Draws the shadows that others throw on what faces up. Call it after `draw` and all floors.
    void draw_received_shadows(const View& view, Backdrop& backdrop);

private:
    ObjectScene() = default;
    Affects affected_by(std::uint32_t object) const;
    void add_to_batch(const View& view, const ObjectDrawing& object);
    void draw_soft(const View& view) const;

    ObjectShaders shaders_;
    ObjectShaders soft_shaders_;
    Textures textures_;
    ObjectMeshes meshes_;
    ObjectBatch batch_;
    std::map<std::uint32_t, ObjectDrawing> objects_;
    std::map<std::uint32_t, SoftDrawing> soft_objects_;
    std::map<std::string, std::vector<ObjectDrawing>> scenery_;
};

}  // namespace atrium::renderer
