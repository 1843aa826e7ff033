#include "tests/support/comes_true.hpp"
#include "tests/unit/viewer/ui/window_fixture.hpp"
#include "viewer/start/start_screen.hpp"
#include "viewer/ui/fields.hpp"
#include "viewer/ui/panel_style.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

// Fields of the panels: keys, typing, dragging and questions.
namespace atrium::viewer {
namespace {

using test_support::comes_true;

constexpr int kColumn_px = 120;  // of the fields of the object's panel
constexpr int kSecondColumn_px = 160;

class ObjectPanel : public ViewerWindow {
protected:
    void SetUp() override {
        ViewerWindow::SetUp();
        if (IsSkipped() || HasFatalFailure()) return;
        figures_.edit.is_supported = true;
        bus::SceneObject& object = figures_.edit.selected.emplace();
        object.object = 7;
        object.name = "box";
        object.mass_kg = 0.05;
        object.size_m = {0.3, 0.2, 0.1};
        after("h");  // in this small window the figures would move the panel
    }

    void click_field(ImGuiID field, int x = kColumn_px) {
        ASSERT_TRUE(point_at_field(field, x));
        hold(true);
        hold(false);
    }
    // One number of a field of several.
    static ImGuiID part_of(const char* field, int i) {
        return ImHashStr("", 0, ImHashData(&i, sizeof i, id_of("edit", field)));
    }
    static const ImGuiWindow* tooltip() {
        for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
            if (window->Active && !window->Hidden &&
                (window->Flags & ImGuiWindowFlags_Tooltip) != 0)
                return window;
        return nullptr;
    }
    SurfaceEvents type(std::initializer_list<const char*> keys) {
        SurfaceEvents last;
        for (const char* key : keys) {
            const SurfaceEvents events = after(key);
            EXPECT_FALSE(events.names || events.debug) << key;
            last = events;
        }
        return last;
    }
};

TEST_F(ObjectPanel, LettersDoNothingWhileTheColourPickerIsOpen) {
    const ImGuiID colour = id_of("edit", "colour");
    click_field(ImHashStr("##ColorButton", 0, colour), 24);
    const auto has_picker = [] {
        return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    };
    ASSERT_TRUE(has_picker());
    for (const char* key : {"n", "b", "Delete", "2"}) {
        const SurfaceEvents events = after(key);
        EXPECT_FALSE(events.names || events.debug || events.remove_pointed) << key;
        EXPECT_EQ(events.person, 0U);
    }
    press("Escape");
    EXPECT_TRUE(comes_true([&] {
        draw();
        return !has_picker();
    }));
    EXPECT_TRUE(after("n").names);
}

TEST_F(ObjectPanel, LettersDoNothingWhileTheMouseHoldsAField) {
    ASSERT_TRUE(point_at_field(id_of("edit", "mass"), kColumn_px));
    EXPECT_TRUE(after("n").names) << "the mouse over a panel takes no keys";
    const SurfaceEvents deleted = after("Delete");
    EXPECT_TRUE(deleted.remove_pointed) << "the selected object";
    EXPECT_TRUE(deleted.is_over_panel) << "not the object behind the panel";
    hold(true);
    EXPECT_FALSE(after("n").names);
    hold(false);
}

TEST_F(ObjectPanel, AClickTypesANumberAndACommaIsAPoint) {
    click_field(id_of("edit", "mass"));
    const SurfaceEvents events = type({"1", "2", "comma", "5", "Return"});
    ASSERT_TRUE(events.edit.change);
    EXPECT_EQ(events.edit.change->mass_kg, 12.5);
}

TEST_F(ObjectPanel, RefusesANumberBeyondTheRangeWithTheRange) {
    click_field(id_of("edit", "mass"));
    const SurfaceEvents events = type({"2", "0", "0", "0", "0", "Return"});
    EXPECT_FALSE(events.edit.change);
    EXPECT_EQ(events.edit.hint, "mass must be 0.006 kg to 180 kg, not 20000");
}

TEST_F(ObjectPanel, SaysThatLettersAreNoNumber) {
    click_field(id_of("edit", "mass"));
    EXPECT_EQ(tooltip(), nullptr);
    type({"a", "b"});
    ASSERT_NE(tooltip(), nullptr) << "while it is typed";
    const SurfaceEvents events = type({"c", "Return"});
    EXPECT_FALSE(events.edit.change);
    ASSERT_NE(tooltip(), nullptr) << "and after";
    const ImGuiWindow* panel = ImGui::FindWindowByName("edit");
    EXPECT_FALSE(panel->Rect().Overlaps(tooltip()->Rect())) << "beside the panel";
    const auto& typed = *static_cast<const TypedText*>(ImGui::GetIO().UserData);
    EXPECT_EQ(typed.typed, "abc");
    click_field(id_of("edit", "mass"));
    type({"1", "Return"});
    EXPECT_EQ(tooltip(), nullptr) << "a number takes it back";
}

TEST_F(ObjectPanel, KeepsItsNumberIfLettersAreTyped) {
    click_field(id_of("edit", "mass"));
    EXPECT_FALSE(type({"1", "2", "x", "Return"}).edit.change) << "12x is not 12";
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(draw().edit.change);
    click_field(id_of("edit", "mass"));
    const SurfaceEvents events = type({"1", "x", "BackSpace", "1", "2", "Return"});
    ASSERT_TRUE(events.edit.change) << "corrected";
    EXPECT_EQ(events.edit.change->mass_kg, 12.0);
}

TEST_F(ObjectPanel, ExplainsAFieldBesideThePanel) {
    ASSERT_TRUE(point_at_field(id_of("edit", "mass"), kColumn_px));
    EXPECT_TRUE(comes_true([&] {
        draw();
        return tooltip() != nullptr;
    }));
    EXPECT_FALSE(ImGui::FindWindowByName("edit")->Rect().Overlaps(tooltip()->Rect()));
}

TEST_F(ObjectPanel, DragsASmallMassBySmallSteps) {
    ASSERT_TRUE(point_at_field(id_of("edit", "mass"), kColumn_px));
    hold(true);
    std::optional<bus::SceneObject> changed;
    for (int moved = 20; moved <= 60; moved += 20) {
        display_->point_at(kTitle, at_[0] + moved, at_[1]);
        for (int i = 0; i < 3; ++i) draw();
    }
    display_->hold_button(kTitle, false);
    for (int i = 0; i < 5; ++i) {
        const SurfaceEvents events = draw();
        if (events.edit.change) changed = events.edit.change;
    }
    ASSERT_TRUE(changed);
    EXPECT_GT(changed->mass_kg, 0.06);
    EXPECT_LT(changed->mass_kg, 0.15) << "1 % per pixel";
}

TEST_F(ObjectPanel, TypesOneCoordinateAndKeepsTheOthersExactly) {
    geometry::RigidTransform& pose = figures_.edit.pose;
    pose.translation = {0.1, 0.2, 1.0 / 3.0};
    pose.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1.0, 2.0, 3.0).normalized());
    click_field(part_of("x y z", 1), kSecondColumn_px);
    for (const char* key : {"minus", "1", "period", "5"})
        EXPECT_FALSE(after(key).edit.place) << "half a number is no place";
    const SurfaceEvents events = after("Return");
    ASSERT_TRUE(events.edit.place);
    EXPECT_EQ(events.edit.place->object, 7U);
    EXPECT_FALSE(events.edit.place->is_held);
    const geometry::RigidTransform& placed = events.edit.place->world_from_object;
    EXPECT_EQ(placed.translation, Eigen::Vector3d(0.1, -1.5, 1.0 / 3.0));
    EXPECT_EQ(placed.rotation.coeffs(), pose.rotation.coeffs());
}

TEST_F(ObjectPanel, TypesAnAngle) {
    click_field(part_of("angles", 1), kSecondColumn_px);
    const SurfaceEvents events = type({"3", "0", "Return"});
    ASSERT_TRUE(events.edit.place);
    const Eigen::Quaterniond expected(
        Eigen::AngleAxisd(std::numbers::pi / 6.0, Eigen::Vector3d::UnitY()));
    EXPECT_LT(events.edit.place->world_from_object.rotation.angularDistance(expected), 1e-6);
}

TEST_F(ObjectPanel, RefusesAPlaceBeyondTheRange) {
    click_field(part_of("x y z", 1), kSecondColumn_px);
    const SurfaceEvents events = type({"2", "0", "0", "0", "Return"});
    EXPECT_FALSE(events.edit.place);
    EXPECT_EQ(events.edit.hint, "x y z must be -1000 m to 1000 m, not 2000");
}

TEST_F(ObjectPanel, HoldsTheObjectWhileACoordinateIsDragged) {
    ASSERT_TRUE(point_at_field(part_of("x y z", 1), kSecondColumn_px));
    hold(true);
    display_->point_at(kTitle, at_[0] + 40, at_[1]);
    std::optional<PlaceWanted> held;
    for (int i = 0; i < 5; ++i) {
        if (const SurfaceEvents events = draw(); events.edit.place) held = events.edit.place;
    }
    ASSERT_TRUE(held);
    EXPECT_TRUE(held->is_held);
    EXPECT_GT(held->world_from_object.translation.y(), 0.1) << "5 mm per pixel";
    display_->hold_button(kTitle, false);
    std::optional<PlaceWanted> placed;
    for (int i = 0; i < 5; ++i) {
        if (const SurfaceEvents events = draw(); events.edit.place) placed = events.edit.place;
    }
    ASSERT_TRUE(placed);
    EXPECT_FALSE(placed->is_held);
    EXPECT_EQ(placed->world_from_object.translation, held->world_from_object.translation);
}

TEST_F(ObjectPanel, NamesGetAnUnderscoreForOtherCharacters) {
    click_field(id_of("edit", "name"));
    for (int i = 0; i < 3; ++i) after("BackSpace");
    const SurfaceEvents events = type({"a", "space", "b", "comma", "Return"});
    ASSERT_TRUE(events.edit.change);
    EXPECT_EQ(events.edit.change->name, "a_b_");
}

TEST_F(ViewerWindow, APressThatComesWithTheJumpOntoAPanelIsNotForTheWorld) {
    display_->point_at(kTitle, 100, 100);
    after("m");
    const ImGuiWindow* menu = ImGui::FindWindowByName("menu");
    ASSERT_NE(menu, nullptr);
    ASSERT_FALSE(ImGui::GetIO().WantCaptureMouse);
    const auto middle = menu->Rect().GetCenter();
    display_->point_at(kTitle, static_cast<int>(middle.x), static_cast<int>(middle.y));
    display_->hold_button(kTitle, true);
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(draw().pointer.is_down) << i;
    display_->hold_button(kTitle, false);
    draw();
    EXPECT_TRUE(click(100, 100).pointer.is_down);
}

TEST_F(ViewerWindow, LinesBreakBetweenWordsOnly) {
    draw();
    const std::string text = "see its option world.saved_folder";
    EXPECT_EQ(first_line(text, text_width(text)), text);
    EXPECT_EQ(first_line(text, text_width("see its option world.saved")), "see its option");
    EXPECT_EQ(first_line("world.saved_folder", 1.0f), "world.saved_folder") << "at least a word";
    EXPECT_EQ(first_line("two\nlines", 1e6f), "two");
}

TEST_F(ViewerWindow, HidesASiteOnlyInTheOpenListAndSaysSo) {
    figures_.sites.emplace_back().name = "alice";
    const SurfaceEvents without = after("x");
    EXPECT_EQ(without.hide_site, "");
    EXPECT_EQ(without.edit.hint, "X hides the site chosen in the list of sites: L");
    EXPECT_EQ(after("o").edit.hint, "O shows only the site chosen in the list of sites: L");
    after("l");
    EXPECT_EQ(after("x").hide_site, "alice");
}

TEST_F(ViewerWindow, ControlSOpensTheSavedWorlds) {
    auto worlds = std::make_shared<bus::SavedWorlds>();
    worlds->is_on = true;
    figures_.edit.worlds = worlds;
    EXPECT_EQ(ImGui::FindWindowByName("menu"), nullptr);
    display_->press_with_control(kTitle, "s");
    for (int i = 0; i < 10; ++i) draw();
    ASSERT_NE(ImGui::FindWindowByName("menu"), nullptr);
    EXPECT_NE(ImGui::FindWindowByName("menu")->StateStorage.GetInt(id_of("menu", "saved worlds")),
              0);
}

TEST_F(ViewerWindow, TheMenusResetAsksAgainAndAnotherClickTakesItBack) {
    after("m");
    constexpr int kMenu_px = 640 - 10 - 290 + 100;
    const auto click_on = [&](const char* field) {
        EXPECT_TRUE(point_at_field(id_of("menu", field), kMenu_px)) << field;
        return click(at_[0], at_[1]);
    };
    EXPECT_FALSE(click_on("###reset").reset_scene) << "it asks first";
    EXPECT_TRUE(click_on("###reset").reset_scene);
    EXPECT_FALSE(click_on("###reset").reset_scene);
    click_on("name");
    EXPECT_FALSE(click_on("###reset").reset_scene) << "it was taken back";
}

TEST_F(ViewerWindow, SavingOverAWorldAsksAgainAtTheSamePlace) {
    display_->resize(kTitle, {640, 780});
    ASSERT_TRUE(comes_true([&] {
        draw();
        return window_->size() == Size{640, 780};
    }));
    auto worlds = std::make_shared<bus::SavedWorlds>();
    worlds->is_on = true;
    worlds->worlds.emplace_back().name = "evening";
    figures_.edit.worlds = worlds;
    after("m");
    constexpr int kMenu_px = 640 - 10 - 290 + 100;
    const auto click_on = [&](const char* field) {
        EXPECT_TRUE(point_at_field(id_of("menu", field), kMenu_px)) << field;
        return click(at_[0], at_[1]);
    };
    click_on("saved worlds");
    click_on("name##world");
    for (const char* key : {"e", "v", "e", "n", "i", "n", "g", "Return"}) after(key);
    EXPECT_EQ(click_on("###save").edit.save_world, "") << "it asks first";
    EXPECT_EQ(click(at_[0], at_[1]).edit.save_world, "evening");
    EXPECT_EQ(click(at_[0], at_[1]).edit.save_world, "");
    const Size button = at_;
    click(20, 600);  // in the scene
    EXPECT_EQ(click(button[0], button[1]).edit.save_world, "") << "it was taken back";
    EXPECT_EQ(click(button[0], button[1]).edit.save_world, "evening");
}

TEST_F(ViewerWindow, EscapeClosesThePanelsLastOpenedFirst) {
    const auto is_shown = [](const char* panel) {
        const ImGuiWindow* window = ImGui::FindWindowByName(panel);
        return window != nullptr && window->Active;
    };
    figures_.followed = "alice";
    after("m");
    after("k");
    after("l");
    ASSERT_TRUE(is_shown("menu") && is_shown("viewpoints") && is_shown("sites"));
    after("Escape");
    EXPECT_TRUE(is_shown("menu") && is_shown("viewpoints") && !is_shown("sites"));
    after("r");
    after("Escape");
    EXPECT_TRUE(is_shown("viewpoints")) << "it took the question back";
    after("Escape");
    after("Escape");
    EXPECT_FALSE(is_shown("viewpoints") || is_shown("menu"));
    press("Escape");
    EXPECT_TRUE(comes_true([&] { return draw().stop_following; }));
}

TEST_F(ViewerWindow, PanelsNeverCoverEachOtherAndMessagesLieOnTop) {
    figures_.notice = "ball was removed by bob";
    figures_.edit.is_supported = true;
    figures_.edit.selected.emplace();
    figures_.edit.selected->name = "box";
    for (const char* key : {"m", "l", "k", "r"}) after(key);
    std::vector<const ImGuiWindow*> panels;
    for (const char* name : {"figures", "menu", "edit", "sites", "viewpoints"}) {
        panels.push_back(ImGui::FindWindowByName(name));
        ASSERT_NE(panels.back(), nullptr) << name;
        ASSERT_TRUE(panels.back()->Active) << name;
        for (std::size_t i = 0; i + 1 < panels.size(); ++i)
            EXPECT_FALSE(panels[i]->Rect().Overlaps(panels.back()->Rect()))
                << panels[i]->Name << ", " << name;
    }
    const auto& order = ImGui::GetCurrentContext()->Windows;
    const std::size_t num = static_cast<std::size_t>(order.Size);
    ASSERT_GT(num, 2U);
    EXPECT_STREQ(order[order.Size - 1]->Name, "question");
    EXPECT_STREQ(order[order.Size - 2]->Name, "message");
}

TEST_F(ViewerWindow, TheStartScreenAsksBeforeEscapeEndsIt) {
    StartScreen screen(bus::BusOptions{}, "");
    const auto escape = [&] {
        press("Escape");
        for (int i = 0; i < 10; ++i) {
            window_->poll();
            window_->show_layout([&] { screen.draw({}); });
        }
        return screen.is_left();
    };
    EXPECT_FALSE(escape()) << "it asks first";
    EXPECT_TRUE(escape());
}

TEST_F(ViewerWindow, AnyOtherKeyTakesAQuestionBack) {
    press("Escape");
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(draw().close);
    EXPECT_TRUE(after("n").names);
    press("Escape");
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(draw().close) << "it asks anew";
}

}  // namespace
}  // namespace atrium::viewer
