#pragma once

#include "viewer/debug_view.hpp"
#include "viewer/name_tags.hpp"
#include "viewer/people_view.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <chrono>
#include <span>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the viewer draws over people and things. Of the drawing thread.
class Annotations {
public:
    using Clock = std::chrono::steady_clock;

    explicit Annotations(bool has_names) : has_names_(has_names) {}

    void toggle_names() { has_names_ = !has_names_; }
    /// What is behind the picture: meshes as wires, and DebugView's lines.
    void toggle_debug() { is_debug_ = !is_debug_; }

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
    bool is_debug_ = false;
    DebugView debug_;
    std::vector<renderer::Line> lines_;
};

}  // namespace atrium::viewer
