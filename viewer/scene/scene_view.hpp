#pragma once

#include "viewer/control/mouse_grab.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene/file_advice.hpp"
#include "viewer/scene/model_library.hpp"
#include "viewer/scene/scene_timeline.hpp"
#include "viewer/scene/soft_timeline.hpp"
#include "viewer/scene/texture_library.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Moves the objects of the world from the session to the renderer: their look, and their pose at
/// the time shown. Drawing thread only.
class SceneView {
public:
    /// `models`: folder of the models and textures that worlds name. `delay`: age of the moments
    /// that `update` will be asked for.
    explicit SceneView(const std::filesystem::path& models, std::chrono::nanoseconds delay = {});

    /// Shows the objects at `instant` on the world's clock, or as late as the states allow. A large
    /// number of changes is spread over several pictures.
    void update(SceneChanges changes,
                SceneTimeline::Clock::time_point now,
                const std::optional<Timestamp>& instant,
                renderer::SceneRenderer& renderer);
    enum class Pickable : std::uint8_t { kMovable, kAllButPlanes };
    /// Nearest object on a ray, as shown now; none if scenery or a fixed object hides it.
    std::optional<Hit> pick(const Ray& ray, Pickable which = Pickable::kMovable) const;
    /// Distance along a ray to the first thing that never moves and hides what is behind it:
    /// scenery or a fixed object, but no plane [m]. Infinite: none. Models count once they are
    /// loaded.
    double free_m(const Ray& ray) const;
    /// Surface of an object with a model in its frame. Null: none, or not loaded yet.
    std::shared_ptr<const renderer::ShapeMesh> mesh_of(const bus::SceneObject& object) const;
    /// All objects, soft ones included.
    const std::map<std::uint32_t, bus::SceneObject>& objects() const { return objects_; }
    /// Poses of the rigid objects, as shown now.
    const std::vector<bus::ObjectState>& states() const { return states_; }
    /// Nodes of the soft objects, as shown now.
    const std::map<std::uint32_t, std::vector<Eigen::Vector3f>>& nodes() const { return nodes_; }
    /// All sites that have published a description, with or without a person.
    using Sites = std::map<std::string, std::shared_ptr<const bus::SiteDescription>>;
    const Sites& sites() const { return sites_; }
    std::set<std::string> site_names() const;
    /// Whether every model and texture has been read and every change is shown.
    bool is_complete() const;
    /// Of the objects and scenery.
    BadFiles bad_files() const;
    /// Increases with every change of `objects` and of the scenery.
    std::uint64_t revision() const { return revision_; }
    /// Drops everything; call it when the renderer is destroyed.
    void clear();

private:
    void take_changes(SceneTimeline::Clock::time_point until, renderer::SceneRenderer& renderer);
    void change(std::uint32_t id,
                const std::optional<bus::SceneObject>& object,
                renderer::SceneRenderer& renderer);
    void change(std::uint32_t id,
                const std::optional<bus::SoftBody>& body,
                renderer::SceneRenderer& renderer);
    void change(const std::string& name,
                const std::optional<bus::Scenery>& scenery,
                renderer::SceneRenderer& renderer);
    void expect_files(const SceneChanges& changes);
    void show_new_files(SceneTimeline::Clock::time_point now, renderer::SceneRenderer& renderer);
    template <typename IsModel, typename IsTexture>
    std::string file_that(const IsModel& is_model, const IsTexture& is_texture) const;
    std::optional<Hit> hit_object(const Ray& ray,
                                  const bus::SceneObject& object,
                                  const geometry::RigidTransform& world_from_object) const;
    void show_soft(std::uint32_t object, renderer::SceneRenderer& renderer);

    ModelLibrary models_;
    TextureLibrary textures_;
    SceneTimeline timeline_;
    SoftTimeline soft_timeline_;
    SceneChanges waiting_;  // changes postponed to the next picture
    std::map<std::uint32_t, bus::SceneObject> objects_;
    std::uint64_t revision_ = 0;
    std::map<std::uint32_t, bus::SoftBody> soft_bodies_;
    std::map<std::string, bus::Scenery> scenery_;
    Sites sites_;
    std::vector<bus::ObjectState> states_;                         // as shown now
    std::map<std::uint32_t, std::vector<Eigen::Vector3f>> nodes_;  // of soft bodies, as shown now
};

}  // namespace atrium::viewer
