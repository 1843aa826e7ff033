#pragma once

#include "core/gl/offscreen_context.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/source_dir.hpp"
#include "viewer/control/user_control.hpp"
#include "viewer/overlay/annotations.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/record/picture_file.hpp"
#include "viewer/scene/scene_view.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace atrium::test {

using test_support::comes_true;
using Clock = std::chrono::steady_clock;

inline constexpr int kEditWidth = 640;
inline constexpr int kEditHeight = 360;
inline bus::BusOptions edit_bus() {
    bus::BusOptions options;
    options.world = "world-editing-test-" + std::to_string(getpid());
    options.domain = 185;  // used by this test only
    return options;
}

inline renderer::ViewCamera edit_camera() {
    return {.position_m = {1.6, -2.2, 1.5}, .target_m = {0.0, 0.0, 0.35}, .fov_deg = 45.0};
}

/// A viewer without a window, stepped by the test.
class Editor {
public:
    explicit Editor(const std::string& name, const bus::BusOptions& bus = edit_bus())
        : session_(viewer::Session::create(bus, name).value()),
          thread_([this](const std::stop_token& stop) { session_->receive(stop); }),
          context_(gl::OffscreenContext::create(16, 16).value()),
          control_(edit_camera(), name, false) {
        renderer_.emplace(
            renderer::SceneRenderer::create({.width = kEditWidth, .height = kEditHeight}).value());
        annotations_.emplace(viewer::ViewConfig{}, false);
        pointer_.width_px = kEditWidth;
        pointer_.height_px = kEditHeight;
    }

    /// One picture, as Viewer draws it.
    void step(viewer::SurfaceEvents events = {}) {
        const auto now = Clock::now();
        scene_.update(session_->take_scene(), now, std::nullopt, *renderer_);
        for (const std::string& text : control_.take(session_->edits().take(), now))
            texts_.push_back(text);
        const viewer::UserControl::Shown shown = this->shown();
        for (const auto& command : control_.move(events, shown, now))
            EXPECT_TRUE(session_->send(command));
        for (const auto& command : control_.edit(events, shown, shown.eye, now))
            EXPECT_TRUE(session_->send(command));
        for (const bus::SceneEdit& edit : control_.take_edits())
            EXPECT_TRUE(session_->edits().send(edit));
    }
    bool until(const std::function<bool()>& condition) {
        return comes_true([&] {
            step();
            return condition();
        });
    }
    bool has_said(const std::string& text) {
        return until([&] {
            return std::any_of(texts_.begin(), texts_.end(), [&](const std::string& said) {
                return said.find(text) != std::string::npos;
            });
        });
    }

    viewer::UserControl::Shown shown() {
        renderer::EyeView eye = renderer::eye_of(control_.camera(), kEditWidth, kEditHeight);
        using Pickable = viewer::SceneView::Pickable;
        return {
            pointer_,
            [this](const viewer::Ray& ray) { return scene_.pick(ray); },
            {},
            scene_.objects(),
            [this](const viewer::Ray& ray) { return scene_.pick(ray, Pickable::kAllButPlanes); },
            scene_.states(),
            eye};
    }
    viewer::EditView edit() { return control_.edit_view(shown()); }
    void point_at(const Eigen::Vector3d& p_world) {
        pointer_.at_px = *viewer::pixel_of(p_world, shown().eye);
    }
    void hold_button(bool is_down) { pointer_.is_down = is_down; }
    void click(const Eigen::Vector3d& p_world) {
        point_at(p_world);
        for (const bool is_down : {false, true, false}) {
            hold_button(is_down);
            step();
        }
    }
    /// Drags from one place in the world to another in the picture, in steps.
    void drag(const Eigen::Vector3d& from, const Eigen::Vector3d& to, bool snaps = false) {
        point_at(from);
        step();
        hold_button(true);
        step();
        for (int i = 1; i <= 10; ++i) {
            point_at(from + 0.1 * i * (to - from));
            viewer::SurfaceEvents events;
            events.edit.snaps = snaps;
            step(events);
            std::this_thread::sleep_for(std::chrono::milliseconds(16));  // the period of a mouse
        }
    }
    /// Place of the tip of an arrow of the selected object.
    Eigen::Vector3d arrow(viewer::Handle handle) {
        const viewer::EditHandles handles = edit().handles;
        return handles.world_from_object.translation +
               0.8 * handles.metres(viewer::EditHandles::kLength, shown().eye) *
                   handles.axis(handle);
    }
    Eigen::Vector3d place_of(std::uint32_t object) const {
        for (const bus::ObjectState& state : scene_.states())
            if (state.object == object) return state.world_from_object.translation;
        return Eigen::Vector3d::Constant(1e9);
    }
    const std::map<std::uint32_t, bus::SceneObject>& objects() const { return scene_.objects(); }
    void ask(const std::function<void(viewer::EditEvents&)>& set) {
        viewer::SurfaceEvents events;
        set(events.edit);
        step(events);
    }
    /// Draws; writes the picture if ATRIUM_EDITING_SHOTS names a folder.
    renderer::RenderedPicture draw(const std::string& name) {
        annotations_->set_edit(edit());
        const std::vector<renderer::EyeView> eyes{
            renderer::eye_of(control_.camera(), kEditWidth, kEditHeight)};
        annotations_->update(scene_, people_, {}, eyes, Clock::now(), *renderer_);
        renderer_->draw(eyes);
        renderer::RenderedPicture picture;
        renderer_->read_pixels(picture);
        if (const char* folder = std::getenv("ATRIUM_EDITING_SHOTS")) {
            EXPECT_TRUE(
                viewer::write_png(std::filesystem::path(folder) / (name + ".png"), picture));
        }
        return picture;
    }
    std::vector<std::string>& texts() { return texts_; }

private:
    std::unique_ptr<viewer::Session> session_;
    std::jthread thread_;
    gl::OffscreenContext context_;
    std::optional<renderer::SceneRenderer> renderer_;
    std::optional<viewer::Annotations> annotations_;
    viewer::PeopleView people_;
    viewer::SceneView scene_{atrium::test::source_dir() + "/deploy/worlds"};
    viewer::UserControl control_;
    viewer::Pointer pointer_;
    std::vector<std::string> texts_;
};

}  // namespace atrium::test
