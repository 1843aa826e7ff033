#pragma once

#include "viewer/config/viewer_config.hpp"
#include "viewer/overlay/debug_view.hpp"
#include "viewer/overlay/edit_shapes.hpp"
#include "viewer/overlay/name_tags.hpp"
#include "viewer/overlay/proxy_view.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/scene/people_view.hpp"

#include <Eigen/Geometry>

#include <chrono>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Draws name tags and debug lines over the scene. Drawing thread only.
class Annotations {
public:
    using Clock = std::chrono::steady_clock;

    Annotations(const ViewConfig& view, bool is_window)
        : ui_scale_(view.ui_scale),
          has_names_(view.names == "on" || (view.names == "auto" && is_window)),
          is_debug_(view.debug == "on") {}

    void toggle_names() { has_names_ = !has_names_; }
    /// Shows or hides the debug view: wireframe meshes and the lines of DebugView.
    void toggle_debug() { is_debug_ = !is_debug_; }

    /// Subscribes to proxies while the debug view is on, and takes those that arrived.
    void take(ProxyInbox& proxies, Clock::time_point now);

    /// What the next picture shows of the editing.
    void set_edit(EditView edit) { edit_ = std::move(edit); }

    /// `inside` names the person through whose eyes the viewer looks. Empty: nobody.
    void update(const SceneView& scene,
                const PeopleView& people,
                const std::string& inside,
                std::span<const renderer::EyeView> eyes,
                Clock::time_point now,
                renderer::SceneRenderer& renderer);

    /// What the labels of the last picture cover, see label_boxes. Empty with two eyes.
    const std::vector<Eigen::AlignedBox2f>& boxes() const { return label_boxes_; }

private:
    double ui_scale_;
    bool has_names_;
    NameTags names_;
    bool is_debug_;
    DebugView debug_;
    ProxyView proxies_;
    std::vector<renderer::Line> lines_;
    void append_edit(const SceneView& scene,
                     std::span<const renderer::EyeView> eyes,
                     std::vector<renderer::Label>& labels);
    EditView edit_;
    std::vector<Eigen::AlignedBox2f> label_boxes_;
    EditShapes edit_shapes_;
    std::vector<renderer::Triangle> triangles_;
};

}  // namespace atrium::viewer
