#include "tests/support/comes_true.hpp"
#include "tests/unit/viewer/ui/window_fixture.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>

#include <optional>
#include <set>
#include <string>

namespace atrium::viewer {
namespace {

using test_support::comes_true;

// Points at the right edge, where no figures are drawn: sky above, floor below.
TEST_F(ViewerWindow, ShowsThePictureAndFollowsResizes) {
    for (const Size& size : {Size{640, 360}, Size{1000, 700}}) {
        display_->resize(kTitle, size);
        EXPECT_TRUE(comes_true([&] {
            draw();
            if (window_->size() != size) return false;
            const int right = size[0] - 10;
            const Colour above = drawn_at(right, 10);
            const Colour below = drawn_at(right, size[1] - 10);
            return above != below && display_->colour_in(kTitle, right, 10) == above &&
                   display_->colour_in(kTitle, right, size[1] - 10) == below;
        })) << size[0];
    }
}

TEST_F(ViewerWindow, EscapeAndTheFrameCloseIt) {
    EXPECT_FALSE(draw().close);
    display_->press_escape(kTitle);
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().close) << "it asks first";
    display_->press_escape(kTitle);
    EXPECT_TRUE(comes_true([&] { return draw().close; }));
    close();
    EXPECT_TRUE(comes_true([&] { return !display_->size_of(kTitle); }));
    open();
    EXPECT_FALSE(draw().close);
    display_->ask_to_close(kTitle);
    EXPECT_TRUE(comes_true([&] { return draw().close; }));
}

TEST_F(ViewerWindow, ReportsItsKeys) {
    const auto gives = [&](const std::string& key, auto&& has) {
        display_->press(kTitle, key);
        return comes_true([&] { return has(draw()); });
    };
    EXPECT_TRUE(gives("F12", [](const SurfaceEvents& e) { return e.screenshot; }));
    EXPECT_TRUE(gives("F9", [](const SurfaceEvents& e) { return e.record; }));
    display_->press(kTitle, "r");
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().reset_scene) << "it asks first";
    EXPECT_TRUE(gives("r", [](const SurfaceEvents& e) { return e.reset_scene; }));
    EXPECT_TRUE(gives("n", [](const SurfaceEvents& e) { return e.names; }));
    EXPECT_TRUE(gives("b", [](const SurfaceEvents& e) { return e.debug; }));
    EXPECT_TRUE(gives("Delete", [](const SurfaceEvents& e) { return e.remove_pointed; }));
    EXPECT_TRUE(gives("v", [](const SurfaceEvents& e) { return e.reset_view; }));
    EXPECT_TRUE(gives("f", [](const SurfaceEvents& e) { return e.follow; }));
    EXPECT_TRUE(gives("2", [](const SurfaceEvents& e) { return e.person == 2; }));
    EXPECT_TRUE(gives("j", [](const SurfaceEvents& e) { return e.edit.next_handles; }));
    EXPECT_TRUE(gives("c", [](const SurfaceEvents& e) { return e.edit.local_axes; }));
    EXPECT_TRUE(gives("g", [](const SurfaceEvents& e) { return e.motion.walk; }));
    EXPECT_TRUE(gives("g", [](const SurfaceEvents& e) { return !e.motion.walk; }));
    EXPECT_TRUE(gives("BackSpace", [](const SurfaceEvents& e) { return e.other_world; }));
    using Ask = ViewpointEvent::Kind;
    const auto asks = [](const SurfaceEvents& e, Ask kind) {
        return e.viewpoint && e.viewpoint->kind == kind;
    };
    EXPECT_TRUE(gives("Next", [&](const SurfaceEvents& e) { return asks(e, Ask::kGoNext); }));
    EXPECT_TRUE(gives("Prior", [&](const SurfaceEvents& e) { return asks(e, Ask::kGoPrevious); }));
    EXPECT_TRUE(gives("exclam", [&](const SurfaceEvents& e) {
        return asks(e, Ask::kGo) && e.viewpoint->number == 1;
    })) << "Shift+1";
    display_->press_with_control(kTitle, "d");
    EXPECT_TRUE(comes_true([&] { return draw().edit.duplicate; }));
    display_->press_with_control(kTitle, "3");
    EXPECT_TRUE(comes_true([&] {
        const SurfaceEvents e = draw();
        return asks(e, Ask::kKeep) && e.viewpoint->number == 3;
    }));
}

TEST_F(ViewerWindow, BackspaceAsksWhileAnObjectIsSelected) {
    figures_.edit.selected.emplace();
    draw();
    display_->press(kTitle, "BackSpace");
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().other_world) << "it asks first";
    display_->press(kTitle, "BackSpace");
    EXPECT_TRUE(comes_true([&] { return draw().other_world; }));
}

TEST_F(ViewerWindow, EscapeLeavesTheEyesOfAPersonFirst) {
    figures_.inside = "alice";
    draw();
    display_->press_escape(kTitle);
    EXPECT_TRUE(comes_true([&] {
        const SurfaceEvents events = draw();
        EXPECT_FALSE(events.close);
        return events.leave_eyes;
    }));
}

// Pictures may take longer than a tap on a key or a click.
TEST_F(ViewerWindow, SeesTapsAndClicksBetweenTwoPictures) {
    display_->point_at(kTitle, 600, 100);
    for (int i = 0; i < 3; ++i) draw();
    display_->hold_button(kTitle, true);
    display_->hold_button(kTitle, false);
    int num_down = 0;
    for (int i = 0; i < 20; ++i) num_down += draw().pointer.is_down ? 1 : 0;
    EXPECT_EQ(num_down, 1);
    bool is_seen = false;
    const auto look = [&] {
        window_->poll();
        window_->show_layout([&] { is_seen |= ImGui::IsKeyPressed(GLFW_KEY_ENTER, false); });
    };
    display_->press(kTitle, "Return");
    EXPECT_TRUE(comes_true([&] {
        look();
        return is_seen;
    }));
    is_seen = false;
    for (int i = 0; i < 5; ++i) look();
    EXPECT_FALSE(is_seen) << "it is released";
}

// The list is at the lower right. The test finds its buttons by clicking.
TEST_F(ViewerWindow, RenamesAViewpointWithoutTakingItsLettersForKeys) {
    figures_.viewpoints = {{1, "view 1", true}};
    display_->press(kTitle, "k");
    for (int i = 0; i < 10; ++i) draw();
    std::optional<ViewpointEvent> renamed;
    for (int x = 620; x > 500 && !renamed; x -= 20) {
        click(x, 277);
        for (int i = 0; i < 5; ++i) draw();  // the field appears
        for (const char* key : {"n", "b", "Return"}) {
            display_->press(kTitle, key);
            for (int i = 0; i < 5; ++i) {
                const SurfaceEvents events = draw();
                if (events.viewpoint && events.viewpoint->kind == ViewpointEvent::Kind::kRename)
                    renamed = events.viewpoint;
            }
        }
    }
    ASSERT_TRUE(renamed);
    EXPECT_EQ(renamed->number, 1);
    EXPECT_EQ(renamed->name, "nb");
}

TEST_F(ViewerWindow, DeletesAViewpointAtTheSecondPress) {
    figures_.viewpoints = {{1, "view 1", true}};
    display_->press(kTitle, "k");
    for (int i = 0; i < 10; ++i) draw();
    const auto deletes = [&](int x) {
        const auto viewpoint = click(x, 277).viewpoint;
        return viewpoint && viewpoint->kind == ViewpointEvent::Kind::kForget;
    };
    bool is_deleted = false;
    for (int x = 636; x > 500 && !is_deleted; x -= 12) {
        EXPECT_FALSE(deletes(x)) << "it asks first";
        is_deleted = deletes(x);
    }
    EXPECT_TRUE(is_deleted);
}

// The list is at the lower left. The test finds its boxes by clicking.
TEST_F(ViewerWindow, HidesSitesFromTheirListByMouseAndKeys) {
    figures_.sites = {{"alice", 1, "15/s", "live"}, {"bob", 2, "15/s", "live"}};
    const auto after = [&](const char* key) {
        display_->press(kTitle, key);
        SurfaceEvents all;
        for (int i = 0; i < 20; ++i) {
            const SurfaceEvents events = draw();
            if (!events.hide_site.empty()) all.hide_site = events.hide_site;
            if (!events.solo_site.empty()) all.solo_site = events.solo_site;
        }
        return all;
    };
    EXPECT_EQ(after("x").hide_site, "") << "the user must see what is chosen";
    after("l");
    EXPECT_EQ(after("x").hide_site, "alice");
    EXPECT_EQ(after("o").solo_site, "alice");
    after("Down");
    after("Down");
    EXPECT_EQ(after("x").hide_site, "bob");
    after("Up");
    EXPECT_EQ(after("o").solo_site, "alice");
    std::set<std::string> clicked;
    for (int y = 340; y > 220 && clicked.size() < 2; y -= 9) {
        display_->point_at(kTitle, 28, y);
        for (int i = 0; i < 3; ++i) draw();
        for (const bool is_down : {true, false}) {
            display_->hold_button(kTitle, is_down);
            for (int i = 0; i < 3; ++i) {
                const SurfaceEvents events = draw();
                if (!events.hide_site.empty()) clicked.insert(events.hide_site);
                EXPECT_FALSE(events.pointer.is_down) << "the list takes the mouse";
            }
        }
    }
    EXPECT_EQ(clicked, (std::set<std::string>{"alice", "bob"}));
    display_->press_escape(kTitle);
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().close) << "Escape closes the list first";
}

// Between two slow pictures a hand presses and moves on.
TEST_F(ViewerWindow, ADragBeginsWhereTheButtonWasPressed) {
    const Eigen::Vector2d from(400, 150), to(470, 190);
    const auto point_at = [&](const Eigen::Vector2d& place) {
        display_->point_at(kTitle, static_cast<int>(place.x()), static_cast<int>(place.y()));
    };
    point_at(from);
    ASSERT_TRUE(comes_true([&] { return draw().pointer.at_px == from; }));
    display_->hold_button(kTitle, true);
    point_at(to);
    SurfaceEvents events;
    ASSERT_TRUE(comes_true([&] { return (events = draw()).pointer.is_down; }));
    EXPECT_EQ(events.pointer.at_px, from);
    EXPECT_TRUE(events.motion.turn_px.isZero()) << "the way to the press is no drag";
    Eigen::Vector2d turned = Eigen::Vector2d::Zero();
    ASSERT_TRUE(comes_true([&] {
        events = draw();
        turned += events.motion.turn_px;
        return events.pointer.at_px == to;
    }));
    EXPECT_TRUE(events.pointer.is_down);
    EXPECT_GT(turned.x(), 0.0);
    EXPECT_NEAR(turned.y() / turned.x(), 40.0 / 70.0, 1e-6) << "the way from there";
    display_->hold_button(kTitle, false);
    EXPECT_TRUE(comes_true([&] { return !draw().pointer.is_down; }));
}

TEST_F(ViewerWindow, AKeyOfAShortcutDoesNotMoveTheView) {
    const auto flies = [&] { return draw().motion.fly.x() > 0.0; };
    display_->hold_key(kTitle, "d", true, true);  // Ctrl is let go before D
    ASSERT_TRUE(comes_true([&] { return draw().edit.duplicate; }));
    for (int i = 0; i < 10; ++i) EXPECT_FALSE(flies());
    display_->hold_key(kTitle, "d", false);
    display_->hold_key(kTitle, "d", true);
    EXPECT_TRUE(comes_true(flies));
    display_->hold_key(kTitle, "d", false);
}

TEST_F(ViewerWindow, ThePanelOfFiguresIsNarrowAgainWithoutDetails) {
    const auto width = [&] {
        for (int i = 0; i < 5; ++i) draw();
        const ImGuiWindow* panel = ImGui::FindWindowByName("figures");
        return panel == nullptr ? 0.0f : panel->Size.x;
    };
    figures_.sites.resize(1);
    figures_.sites[0].name = "alice";
    const float narrow = width();
    display_->press(kTitle, "t");
    float wide = 0.0f;
    ASSERT_TRUE(comes_true([&] { return (wide = width()) > narrow; }));
    display_->press(kTitle, "t");
    EXPECT_TRUE(comes_true([&] { return width() < wide; }));
    EXPECT_EQ(width(), narrow);
}

// The list of all keys is in the middle of the picture.
TEST_F(ViewerWindow, ListsItsKeysOnRequest) {
    const auto shows_list = [&] {
        draw();
        const auto [width, height] = window_->size();
        int num_different = 0;
        for (int x = width / 2 - 100; x < width / 2 + 100; x += 4) {
            const auto shown = display_->colour_in(kTitle, x, height / 2);
            num_different += shown && *shown != drawn_at(x, height / 2) ? 1 : 0;
        }
        return num_different > 40;
    };
    EXPECT_FALSE(shows_list());
    display_->press(kTitle, "question");
    EXPECT_TRUE(comes_true(shows_list));
    display_->press(kTitle, "question");
    EXPECT_TRUE(comes_true([&] { return !shows_list(); }));
}

// The menu is at the right, 290 pixels wide. The test finds its entries by clicking.
TEST_F(ViewerWindow, MenuTakesTheMouseAndTheKeys) {
    display_->resize(kTitle, {640, 520});
    ASSERT_TRUE(comes_true([&] {
        draw();
        return window_->size() == Size{640, 520};
    }));
    const int x = 640 - 10 - 290 + 150;
    EXPECT_TRUE(click(x, 120).pointer.is_down) << "a click beside the menu must reach the world";
    display_->press(kTitle, "m");
    for (int i = 0; i < 20; ++i) draw();
    figures_.objects = {{7, "ball (7)"}, {8, "box (8)"}};
    std::optional<int> reset_at;
    std::optional<int> name_at;
    std::optional<NewObject> added;
    for (int y = 20; y < 340; y += 7) {
        const SurfaceEvents events = click(x, y);
        EXPECT_FALSE(events.pointer.is_down) << y;
        EXPECT_FALSE(events.remove) << "no object is selected yet";
        if (events.reset_scene && !reset_at) reset_at = y;
        if (events.add) {
            added = events.add;
            break;
        }
        display_->press(kTitle, "n");
        bool is_taken = true;
        for (int i = 0; i < 5; ++i) is_taken &= !draw().names;
        if (is_taken) {  // a name, or a number that is typed after a click
            name_at = y;
            for (const char* key : {"b", "question", "4"}) display_->press(kTitle, key);
            for (int i = 0; i < 5; ++i) EXPECT_FALSE(draw().debug);
        }
    }
    EXPECT_TRUE(reset_at);
    EXPECT_TRUE(name_at);
    ASSERT_TRUE(added);
    EXPECT_LE(added->shape, bus::Shape::kCapsule) << "the clicks must have hit a shape button";
    EXPECT_GT(added->size_m.minCoeff(), 0.0);
    EXPECT_EQ(added->name.substr(0, 4), "nb_4") << "names must have no question marks";
    std::optional<std::uint32_t> removed;
    for (int y = 290; y < 480 && !removed; y += 9) removed = click(x, y).remove;
    ASSERT_TRUE(removed);
    EXPECT_TRUE(*removed == 7 || *removed == 8);
    display_->press_escape(kTitle);
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().close) << "Escape must close only the menu";
    EXPECT_TRUE(click(x, 120).pointer.is_down) << "it is closed";
}

TEST_F(ViewerWindow, PanelOfTheSelectedObjectChangesItOnceAndEscapeDeselects) {
    figures_.edit.is_supported = true;
    figures_.edit.selected.emplace();
    figures_.edit.selected->object = 7;
    figures_.edit.selected->name = "box";
    figures_.edit.selected->mass_kg = 2.5;
    figures_.edit.selected->size_m = {0.3, 0.2, 0.1};
    display_->press(kTitle, "h");  // in this small window the figures would move the panel
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().edit.change) << "nothing was changed";
    // the column of the check box, from above
    const auto fixed_by_click = [&](int y) {
        display_->point_at(kTitle, 24, y);
        std::optional<bus::SceneObject> changed;
        int num_changes = 0;
        for (const bool is_down : {true, false}) {
            for (int i = 0; i < 3; ++i) draw();
            display_->hold_button(kTitle, is_down);
            for (int i = 0; i < 5; ++i) {
                const SurfaceEvents events = draw();
                num_changes += events.edit.change ? 1 : 0;
                if (events.edit.change) changed = events.edit.change;
            }
        }
        EXPECT_LE(num_changes, 1);
        return changed;
    };
    std::optional<bus::SceneObject> changed;
    int y = 90;
    for (; y < 340 && !changed; y += 8) changed = fixed_by_click(y);
    ASSERT_TRUE(changed);
    EXPECT_EQ(changed->object, 7U);
    EXPECT_EQ(changed->mass_kg, 0.0);
    EXPECT_EQ(changed->size_m, Eigen::Vector3d(0.3, 0.2, 0.1)) << "bit for bit";
    const auto has_picker = [] {
        return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    };
    for (; y < 340 && !has_picker(); y += 8) fixed_by_click(y);
    ASSERT_TRUE(has_picker()) << "of the colour";
    display_->press_escape(kTitle);
    EXPECT_TRUE(comes_true([&] {
        EXPECT_FALSE(draw().edit.cancel) << "the object stays selected";
        return !has_picker();
    }));
    display_->press_escape(kTitle);
    EXPECT_TRUE(comes_true([&] {
        const SurfaceEvents events = draw();
        EXPECT_FALSE(events.close);
        return events.edit.cancel;
    }));
}

TEST_F(ViewerWindow, TogglesFullScreen) {
    const Size before = window_->size();
    display_->press(kTitle, "F11");
    EXPECT_TRUE(comes_true([&] {
        draw();
        return window_->size() == Size{1280, 800};
    }));
    display_->press(kTitle, "F11");
    EXPECT_TRUE(comes_true([&] {
        draw();
        return window_->size() == before;
    }));
}

}  // namespace
}  // namespace atrium::viewer
