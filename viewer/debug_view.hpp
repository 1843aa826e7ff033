#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "viewer/people_view.hpp"
#include "viewer/renderer/overlay.hpp"
#include "viewer/scene_view.hpp"

#include <Eigen/Core>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// The twelve edges of a box of that size around the origin of its frame.
void append_box(const Eigen::Matrix4d& world_from_box,
                const Eigen::Vector3d& size_m,
                const Eigen::Vector3f& colour,
                std::vector<renderer::Line>& lines);

/// What the camera sees, up to `length_m` before it, without its lens distortion.
void append_frustum(const geometry::CalibratedCamera& camera,
                    const Eigen::Matrix4d& world_from_site,
                    double length_m,
                    const Eigen::Vector3f& colour,
                    std::vector<renderer::Line>& lines);

/// What is behind the picture, as lines: the sites' spaces and cameras, the bounds of people and
/// things, and where things go. Of the drawing thread.
class DebugView {
public:
    /// Adds to `lines` and `labels` what is there now.
    void append(const SceneView& scene,
                const PeopleView& people,
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
