#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/overlay/proxy_view.hpp"
#include "viewer/renderer/overlay.hpp"
#include "viewer/scene/people_view.hpp"
#include "viewer/scene/scene_view.hpp"

#include <Eigen/Core>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Appends the frustum of `camera` up to `length_m` before it. Ignores the lens distortion.
void append_frustum(const geometry::CalibratedCamera& camera,
                    const Eigen::Matrix4d& world_from_site,
                    double length_m,
                    const Eigen::Vector3f& colour,
                    std::vector<renderer::Line>& lines);

/// Draws the internals of the scene as lines: spaces and cameras of the sites, bounding boxes of
/// people, collision shapes of people and objects, and their velocities. Drawing thread only.
class DebugView {
public:
    static constexpr double kFrustumM = 0.35;  // length of the camera frustums [m]

    /// Appends the lines and labels of the current state.
    void append(const SceneView& scene,
                const PeopleView& people,
                const ProxyView& proxies,
                const renderer::SceneRenderer& renderer,
                std::vector<renderer::Line>& lines,
                std::vector<renderer::Label>& labels);
    /// Scale of the camera names, and the height of the pictures that they appear in.
    void set_names(double scale, int picture_px);
    /// Drops the rendered camera names.
    void clear() { names_.clear(); }

private:
    void append_site(const bus::SiteDescription& site,
                     const Eigen::Matrix4d& world_from_site,
                     std::vector<renderer::Line>& lines,
                     std::vector<renderer::Label>& labels);

    std::map<std::string, std::shared_ptr<const renderer::TexturePicture>> names_;
    int num_new_names_ = 0;  // rendered for this picture
    double name_height_ = 0.0;
    int name_px_ = 0;
};

}  // namespace atrium::viewer
