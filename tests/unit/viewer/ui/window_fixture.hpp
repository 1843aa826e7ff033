#pragma once

#include "tests/support/comes_true.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/virtual_display.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/ui/surface.hpp"

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace atrium::viewer {

inline constexpr const char* kTitle = "Atrium";

/// Shows the viewer's window on a private display and reads the display's pixels.
class ViewerWindow : public testing::Test {
protected:
    using VirtualDisplay = test_support::VirtualDisplay;
    using Colour = VirtualDisplay::Colour;
    using Size = VirtualDisplay::Size;

    void SetUp() override {
        auto started = VirtualDisplay::start(1280, 800);
        if (!started) GTEST_SKIP() << test::skip::kNoDisplay << started.error().message;
        display_ = std::move(*started);
        open();
    }

    void open() {
        auto window = open_window({.width = 640, .height = 360, .wait_for_display = false});
        ASSERT_TRUE(window) << window.error().message;
        window_ = std::move(*window);
        auto renderer = renderer::SceneRenderer::create({.width = 640, .height = 360});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
    }
    void close() {
        renderer_.reset();  // its context is destroyed with the window
        window_.reset();
    }
    void TearDown() override { close(); }

    // Draws and shows a picture as the viewer does.
    SurfaceEvents draw() {
        const SurfaceEvents events = window_->poll();
        const auto size = window_->size();
        if (size != Size{renderer_->width(), renderer_->height()}) {
            EXPECT_TRUE(renderer_->resize(size[0], size[1]));
        }
        renderer_->draw(renderer::ViewCamera{});
        window_->show(*renderer_, figures_);
        return events;
    }

    // The effects of a click at this place. It holds the button until the viewer has seen it, then
    // releases it.
    SurfaceEvents click(int x, int y) {
        display_->point_at(kTitle, x, y);
        for (int i = 0; i < 3; ++i) draw();
        SurfaceEvents all;
        const auto take = [&] {
            const SurfaceEvents events = draw();
            all.pointer.is_down |= events.pointer.is_down;
            all.reset_scene |= events.reset_scene;
            if (events.add) all.add = events.add;
            if (events.remove) all.remove = events.remove;
            if (events.viewpoint) all.viewpoint = events.viewpoint;
            if (!events.edit.save_world.empty()) all.edit.save_world = events.edit.save_world;
            // the viewer selects it
            if (events.edit.select) {
                figures_.edit.selected.emplace();
                figures_.edit.selected->object = *events.edit.select;
            }
        };
        for (const bool is_down : {true, false}) {
            display_->hold_button(kTitle, is_down);
            for (int i = 0; i < 3; ++i) take();
        }
        return all;
    }

    void press(const char* key) { display_->press(kTitle, key); }
    // What the pictures after a key report, all together.
    SurfaceEvents after(const char* key, int num_pictures = 10) {
        press(key);
        SurfaceEvents all;
        for (int i = 0; i < num_pictures; ++i) {
            const SurfaceEvents events = draw();
            all.names |= events.names;
            all.debug |= events.debug;
            all.remove_pointed |= events.remove_pointed;
            all.is_over_panel |= events.is_over_panel;
            all.motion.fly += events.motion.fly;
            if (!events.hide_site.empty()) all.hide_site = events.hide_site;
            if (!events.solo_site.empty()) all.solo_site = events.solo_site;
            if (events.person > 0) all.person = events.person;
            if (!events.edit.hint.empty()) all.edit.hint = events.edit.hint;
            if (events.edit.change) all.edit.change = events.edit.change;
            if (events.edit.place) all.edit.place = events.edit.place;
        }
        return all;
    }

    static ImGuiID id_of(const char* panel, const char* field) {
        const ImGuiWindow* window = ImGui::FindWindowByName(panel);
        return window == nullptr ? 0 : ImHashStr(field, 0, window->ID);
    }
    // Moves the mouse down a column of fields until it is over this one.
    bool point_at_field(ImGuiID field, int x) {
        for (int y = 10; y < window_->size()[1] - 10; y += 4) {
            display_->point_at(kTitle, x, y);
            for (int i = 0; i < 2; ++i) draw();
            if (ImGui::GetCurrentContext()->HoveredId != field) continue;
            at_ = {x, y};
            return true;
        }
        return false;
    }
    void hold(bool is_down) {
        display_->hold_button(kTitle, is_down);
        for (int i = 0; i < 3; ++i) draw();
    }

    // A pixel of the drawn picture, without the overlay.
    Colour drawn_at(int x, int y) const {
        renderer::RenderedPicture picture;
        renderer_->read_pixels(picture);
        const auto at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                             static_cast<std::size_t>(x));
        return {picture.rgba[at], picture.rgba[at + 1], picture.rgba[at + 2]};
    }

    Size at_{};  // of the mouse, over the field that was found last
    std::unique_ptr<VirtualDisplay> display_;
    std::unique_ptr<Surface> window_;
    HudContent figures_;
    std::optional<renderer::SceneRenderer> renderer_;
};

}  // namespace atrium::viewer
