#pragma once

#include "viewer/model_library.hpp"
#include "viewer/mouse_grab.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene_timeline.hpp"
#include "viewer/session.hpp"
#include "viewer/soft_timeline.hpp"
#include "viewer/texture_library.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

namespace atrium::viewer {

/// The things of the world on their way from the bus to the picture: what they look like, and where
/// they are at the moment that is shown. Of the drawing thread.
class SceneView {
public:
    /// `models`: the folder of models and textures that worlds name.
    /// `delay`: how long ago the moments lie that it will be asked for.
    explicit SceneView(const std::filesystem::path& models, std::chrono::nanoseconds delay = {});

    /// Shows the things as they were at `instant` of the world's clock; without one, as late as the
    /// states allow. What is new of very many things is shown over several pictures.
    void update(SceneChanges changes,
                SceneTimeline::Clock::time_point now,
                const std::optional<Timestamp>& instant,
                renderer::SceneRenderer& renderer);
    /// The nearest thing that moves on a ray, as shown now.
    std::optional<Hit> pick(const Ray& ray) const;
    /// What is in the world, soft things included.
    const std::map<std::uint32_t, bus::SceneObject>& objects() const { return objects_; }
    /// Where those that are rigid are, as shown now.
    const std::vector<bus::ObjectState>& states() const { return states_; }
    /// And the nodes of those that are soft.
    const std::map<std::uint32_t, std::vector<Eigen::Vector3f>>& nodes() const { return nodes_; }
    /// All sites that have described themselves, whether anybody is there or not.
    using Sites = std::map<std::string, std::shared_ptr<const bus::SiteDescription>>;
    const Sites& sites() const { return sites_; }
    /// Grows whenever `objects` change.
    std::uint64_t revision() const { return revision_; }
    /// Of what is drawn, which ends with its renderer.
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
    void show_new_files(renderer::SceneRenderer& renderer);
    void show_soft(std::uint32_t object, renderer::SceneRenderer& renderer);

    ModelLibrary models_;
    TextureLibrary textures_;
    SceneTimeline timeline_;
    SoftTimeline soft_timeline_;
    SceneChanges waiting_;  // descriptions that this picture had no time for
    std::map<std::uint32_t, bus::SceneObject> objects_;
    std::uint64_t revision_ = 0;
    std::map<std::uint32_t, bus::SoftBody> soft_bodies_;
    std::map<std::string, bus::Scenery> scenery_;
    Sites sites_;
    std::vector<bus::ObjectState> states_;                         // as shown now
    std::map<std::uint32_t, std::vector<Eigen::Vector3f>> nodes_;  // of soft bodies, as shown now
};

}  // namespace atrium::viewer
