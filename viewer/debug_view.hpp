#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/people_view.hpp"
#include "viewer/proxy_view.hpp"
#include "viewer/renderer/overlay.hpp"
#include "viewer/scene_view.hpp"

#include <Eigen/Core>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the camera sees, up to `length_m` before it, without its lens distortion.
void append_frustum(const geometry::CalibratedCamera& camera,
                    const Eigen::Matrix4d& world_from_site,
                    double length_m,
                    const Eigen::Vector3f& colour,
                    std::vector<renderer::Line>& lines);

/// What is behind the picture, as lines: the sites' spaces and cameras, the bounds of people, what
/// the physics takes people and things for, and where they go. Of the drawing thread.
class DebugView {
public:
    static constexpr double kFrustumM = 0.35;  // length of the cameras' frustums

    /// Adds to `lines` and `labels` what is there now.
    void append(const SceneView& scene,
                const PeopleView& people,
                const ProxyView& proxies,
                const renderer::SceneRenderer& renderer,
                std::vector<renderer::Line>& lines,
                std::vector<renderer::Label>& labels);
    /// Forgets the pictures of the cameras' names.
    void clear() { names_.clear(); }

private:
    void append_site(const bus::SiteDescription& site,
                     const Eigen::Matrix4d& world_from_site,
                     std::vector<renderer::Line>& lines,
                     std::vector<renderer::Label>& labels);

    std::map<std::string, std::shared_ptr<const renderer::TexturePicture>> names_;
    int num_new_names_ = 0;  // drawn for this picture
};

}  // namespace atrium::viewer
