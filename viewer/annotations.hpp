#pragma once

#include "viewer/debug_view.hpp"
#include "viewer/name_tags.hpp"
#include "viewer/people_view.hpp"
#include "viewer/proxy_view.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/viewer_config.hpp"

#include <chrono>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the viewer draws over people and things. Of the drawing thread.
class Annotations {
public:
    using Clock = std::chrono::steady_clock;

    Annotations(const ViewConfig& view, bool is_window)
        : has_names_(view.names == "on" || (view.names == "auto" && is_window)),
          is_debug_(view.debug == "on") {}

    void toggle_names() { has_names_ = !has_names_; }
    /// What is behind the picture: meshes as wires, and DebugView's lines.
    void toggle_debug() { is_debug_ = !is_debug_; }

    /// Asks for what they show, and takes what has come.
    void take(ProxyInbox& proxies, Clock::time_point now);

    /// `inside`: the person through whose eyes the viewer looks; empty: nobody.
    void update(const SceneView& scene,
                const PeopleView& people,
                const std::string& inside,
                std::span<const renderer::EyeView> eyes,
                Clock::time_point now,
                renderer::SceneRenderer& renderer);

private:
    bool has_names_;
    NameTags names_;
    bool is_debug_;
    DebugView debug_;
    ProxyView proxies_;
    std::vector<renderer::Line> lines_;
};

}  // namespace atrium::viewer
