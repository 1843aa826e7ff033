#include "tests/support/source_dir.hpp"
#include "viewer/start/start_screen.hpp"
#include "viewer/ui/curve.hpp"
#include "viewer/ui/fields.hpp"
#include "viewer/ui/hud.hpp"
#include "viewer/ui/keys.hpp"
#include "viewer/ui/panel_layout.hpp"
#include "viewer/ui/site_lines.hpp"
#include "viewer/ui/ui_scale.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

// What the panels show, without a window.
namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;

std::string text_of_file(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(atrium::test::source_dir() + "/" + file).rdbuf();
    return text.str();
}

TEST(Hud, SaysWhomToWaitFor) {
    HudContent content;
    EXPECT_EQ(nobody_text(content), "nobody is here");
    content.preparing = {"lab"};
    EXPECT_EQ(nobody_text(content), "site lab is preparing");
    content.preparing = {"lab", "studio"};
    EXPECT_EQ(nobody_text(content), "sites lab, studio are preparing");
    content.sites.resize(1);
    EXPECT_EQ(nobody_text(content), "1 site, no people yet; sites lab, studio are preparing");
    content.preparing.clear();
    EXPECT_EQ(nobody_text(content), "1 site, no people yet");
    content.num_rejected = 3;
    EXPECT_EQ(nobody_text(content),
              "1 site, whose people are refused: the log says why (person_rejected)");
}

TEST(Keys, BindEveryActionOnceAndNoKeyTwice) {
    std::set<Action> actions;
    std::map<std::tuple<int, bool, bool, bool>, std::string_view> keys;
    for (const KeyBinding& binding : key_bindings()) {
        EXPECT_FALSE(binding.what.empty());
        const bool is_new = actions.insert(binding.action).second;
        const bool may_repeat = binding.action == Action::kMouse || binding.action == Action::kRedo;
        EXPECT_TRUE(is_new || may_repeat) << binding.shown;
        EXPECT_EQ(binding.keys[0] == 0, binding.action == Action::kMouse) << binding.shown;
        for (const int key : binding.keys) {
            if (key == 0) continue;
            const auto [at, is_free] = keys.emplace(
                std::tuple(key, binding.with_control, binding.with_shift, binding.while_dragging),
                binding.shown);
            EXPECT_TRUE(is_free) << binding.shown << " has a key of " << at->second;
            const int modifiers = (binding.with_control ? 2 : 0) | (binding.with_shift ? 1 : 0);
            const auto found = find_key(key, modifiers, binding.while_dragging);
            ASSERT_TRUE(found) << binding.shown;
            EXPECT_EQ(found->action, binding.action);
        }
    }
    // kMouse is the last action
    EXPECT_EQ(actions.size(), static_cast<std::size_t>(Action::kMouse) + 1);
}

TEST(Keys, ModifiersChooseTheBinding) {
    constexpr int kOne = '1';
    EXPECT_EQ(find_key(kOne, 0)->action, Action::kEyes);
    EXPECT_EQ(find_key(kOne, 1)->action, Action::kGoToView);
    EXPECT_EQ(find_key(kOne + 4, 2)->action, Action::kStoreView);
    EXPECT_EQ(find_key(kOne + 4, 2)->number, 5);
    EXPECT_EQ(find_key('R', 1)->action, Action::kReset) << "Shift does not matter for letters";
    EXPECT_FALSE(find_key('R', 2)) << "Ctrl+R is not R";
    EXPECT_EQ(find_key('X', 0)->action, Action::kHideSite);
    EXPECT_EQ(find_key('X', 0, true)->action, Action::kAxis);
    EXPECT_EQ(find_key('Z', 2)->action, Action::kUndo);
    EXPECT_EQ(find_key('Z', 3)->action, Action::kRedo);
    EXPECT_EQ(find_key('Z', 2, true)->number, 3) << "Ctrl means steps while dragging";
    EXPECT_FALSE(find_key(0, 0));
    EXPECT_FALSE(find_key(-1, 0));
}

// The list of keys is made from the bindings. The window may not bind more.
TEST(Keys, TheWindowBindsOnlyWhatTheListShows) {
    const std::string bindings = text_of_file("viewer/ui/keys.cpp");
    const std::regex key("GLFW_KEY_[A-Z0-9_]+");
    const std::set<std::string> modifiers{"GLFW_KEY_LEFT_SHIFT",
                                          "GLFW_KEY_RIGHT_SHIFT",
                                          "GLFW_KEY_LEFT_CONTROL",
                                          "GLFW_KEY_RIGHT_CONTROL"};
    const std::string window = text_of_file("viewer/ui/window.cpp");
    ASSERT_FALSE(window.empty());
    for (std::sregex_iterator at(window.begin(), window.end(), key), end; at != end; ++at) {
        if (modifiers.contains(at->str())) continue;
        EXPECT_TRUE(std::regex_search(bindings, std::regex(at->str() + "\\b"))) << at->str();
    }
}

TEST(Keys, TheManualListsThemAll) {
    const std::string manual = text_of_file("docs/viewer_window.md");
    for (const KeyBinding& binding : key_bindings())
        EXPECT_THAT(manual, testing::HasSubstr("| " + std::string(binding.shown) + " |"));
}

TEST(UiScale, GrowsWithThePictureAndTheDisplay) {
    EXPECT_EQ(ui_scale_of(0.0, {640, 360}, 1.0), 1.0) << "smaller letters cannot be read";
    EXPECT_EQ(ui_scale_of(0.0, {1280, 720}, 1.0), 1.0);
    EXPECT_EQ(ui_scale_of(0.0, {1920, 1080}, 1.0), 1.5);
    EXPECT_EQ(ui_scale_of(0.0, {3840, 2160}, 1.0), 3.0);
    EXPECT_EQ(ui_scale_of(0.0, {1280, 720}, 2.0), 2.0);
    EXPECT_EQ(ui_scale_of(0.0, {3840, 2160}, 2.0), 3.0);
    EXPECT_EQ(ui_scale_of(1.25, {3840, 2160}, 2.0), 1.25) << "as the user asks";
    EXPECT_EQ(ui_scale_of(0.0, {500, 900}, 1.0), 1.0) << "a narrow window";
}

TEST(Panels, LieBesideEachOtherWhereThereIsRoom) {
    const std::vector<PanelBox> taken{{10, 10, 330, 80}, {10, 400, 368, 310}, {388, 560, 420, 150}};
    const PanelBox list{868, 580, 400, 130};
    const PanelBox at_once = free_place(list, taken, 1280, 720, 10);
    EXPECT_EQ(at_once.left, list.left);
    EXPECT_EQ(at_once.top, list.top) << "it covers nothing there";
    const PanelBox wide{670, 580, 600, 130};
    const PanelBox moved = free_place(wide, taken, 1280, 720, 10);
    EXPECT_EQ(moved.left, wide.left);
    EXPECT_EQ(moved.top, 560 - 10 - 130) << "above the list that it would cover";
    const PanelBox squeezed = free_place({100, 100, 250, 150}, {{10, 10, 280, 100}}, 300, 200, 10);
    EXPECT_EQ(squeezed.top, 40) << "within the picture, covering as little as it can";
}

// Panels as they are at scale 1, at the size of a window.
struct PanelCase {
    std::array<float, 2> window;
    float scale;
};
class PanelLayout : public testing::TestWithParam<PanelCase> {
protected:
    PanelWish wish(Corner corner, float width, float height) const {
        return {corner, GetParam().scale * width, GetParam().scale * height};
    }
    PanelRoom room() const {
        const auto& [window, scale] = GetParam();
        return {window[0], window[1], 10.0f * scale, 14.0f * scale};
    }
};

TEST_P(PanelLayout, CoversNoPanelAndStaysInThePicture) {
    const std::vector<PanelWish> all{wish(Corner::kUpperLeft, 340, 80),
                                     wish(Corner::kUpperRight, 290, 520),
                                     wish(Corner::kLowerLeft, 368, 310),
                                     wish(Corner::kLowerLeft, 420, 150),
                                     wish(Corner::kLowerRight, 400, 130)};
    for (unsigned shown = 1; shown < 1u << all.size(); ++shown) {
        std::vector<PanelWish> wishes;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (((shown >> i) & 1u) != 0u) wishes.push_back(all[i]);
        const std::vector<PanelBox> boxes = lay_out_panels(wishes, room());
        ASSERT_EQ(boxes.size(), wishes.size());
        const float margin = room().margin - 0.01f;  // rounding
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const PanelBox& box = boxes[i];
            EXPECT_GE(box.left, margin) << shown;
            EXPECT_GE(box.top, margin) << shown;
            EXPECT_LE(box.left + box.width, room().width - margin) << shown;
            EXPECT_LE(box.top + box.height, room().height - margin) << shown;
            EXPECT_GE(box.height, std::min(wishes[i].height, 0.2f * room().height)) << shown;
            EXPECT_GE(box.width, std::min(wishes[i].width, 0.4f * room().width)) << shown;
            for (std::size_t k = 0; k < i; ++k) {
                const PanelBox common = common_part(box, boxes[k]);
                EXPECT_LT(common.width * common.height, 1.0f) << shown << ": " << k << ", " << i;
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Windows,
                         PanelLayout,
                         testing::Values(PanelCase{{1280, 720}, 1.0f},
                                         PanelCase{{1280, 720}, 1.5f},
                                         PanelCase{{1280, 720}, 2.0f},
                                         PanelCase{{636, 400}, 1.0f},
                                         PanelCase{{3840, 2160}, 2.0f},
                                         PanelCase{{3840, 2160}, 3.0f}));

TEST(Panels, KeepTheirSizeAndCornerWhereTheyFit) {
    const std::vector<PanelWish> wishes{{Corner::kUpperLeft, 340, 80},
                                        {Corner::kUpperRight, 290, 520},
                                        {Corner::kLowerLeft, 368, 310},
                                        {Corner::kLowerLeft, 420, 150}};
    const std::vector<PanelBox> boxes = lay_out_panels(wishes, {1280, 720, 10, 14});
    EXPECT_EQ(boxes[1].left, 1280 - 10 - 290);
    EXPECT_EQ(boxes[1].height, 520);
    EXPECT_EQ(boxes[2].top, 720 - 10 - 310);
    EXPECT_EQ(boxes[3].top, 400 - 10 - 150) << "above the object's panel, the nearest free place";
    EXPECT_EQ(boxes[3].height, 150);
}

TEST(Panels, CutTheLargestFirst) {
    const std::vector<PanelWish> wishes{{Corner::kUpperLeft, 340, 80},
                                        {Corner::kLowerLeft, 368, 310}};
    const std::vector<PanelBox> boxes = lay_out_panels(wishes, {400, 360, 10, 14});
    EXPECT_EQ(boxes[0].height, 80);
    EXPECT_EQ(boxes[1].height, 360 - 3 * 10 - 80);
    EXPECT_EQ(boxes[1].width, 380) << "as wide as the picture lets it, for its scroll bar";
    EXPECT_EQ(boxes[1].top + boxes[1].height, 350);
}

TEST(Masses, AreThoseOfTheSize) {
    const NumberRange crate = masses_of(bus::Shape::kBox, {0.3, 0.3, 0.3}, 3.0);
    EXPECT_FLOAT_EQ(crate.least, 0.027f);
    EXPECT_FLOAT_EQ(crate.most, 810.0f);
    EXPECT_LT(masses_of(bus::Shape::kSphere, {0.3, 0.3, 0.3}, 3.0).most, crate.most);
    EXPECT_FLOAT_EQ(masses_of(bus::Shape::kBox, {10, 10, 10}, 3.0).most, 10'000.0f);
    EXPECT_EQ(masses_of(bus::Shape::kConvex, {0.3, 0.3, 0.3}, 3.0).least, 0.0f);
    EXPECT_FLOAT_EQ(masses_of(bus::Shape::kBox, {0.3, 0.3, 0.3}, 0.02).least, 0.02f)
        << "what it has is allowed";
}

TEST(Curve, HasAScaleOfRoundNumbers) {
    EXPECT_EQ(top_of_scale(50.0f), 50.0f);
    EXPECT_EQ(top_of_scale(50.1f), 100.0f);
    EXPECT_EQ(top_of_scale(163.0f), 200.0f);
    EXPECT_EQ(top_of_scale(0.3f), 0.5f);
    EXPECT_EQ(top_of_scale(0.0f), 1.0f);
    EXPECT_EQ(top_of_scale(std::numeric_limits<float>::infinity()), 1.0f);
    for (float value = 0.01f; value < 1e6f; value *= 1.37f) {
        EXPECT_GE(top_of_scale(value), value);
        EXPECT_LE(top_of_scale(value), 2.6f * value) << "the curve must not be flat";
    }
}

TEST(SiteLines, ShowRatesAndStates) {
    StatusLines reports;
    bus::SiteStatus status;
    status.metaframes_per_s = 30.0;
    const StatusLines::Clock::time_point now{std::chrono::hours(1)};
    reports.add("alice", status, now);
    reports.add("carol", status, now);
    std::vector<SiteLine> lines = site_lines(
        {{"alice", {15.0, 0.0}}, {"bob", {0.0, 1.3}}}, {"alice", "bob", "carol", "dave"}, reports);
    ASSERT_EQ(lines.size(), 4U);
    EXPECT_EQ(lines[0].rate + ", " + lines[0].state, "15 of 30/s, live");
    EXPECT_EQ(lines[1].rate + ", " + lines[1].state, "0/s, nothing new for 1.3 s");
    EXPECT_EQ(lines[2].rate + ", " + lines[2].state, "30/s, nobody there");
    EXPECT_EQ(lines[3].rate + ", " + lines[3].state, "-, no report");
    EXPECT_EQ(lines[1].number, 2U) << "its person is seen with key 2";
    EXPECT_EQ(lines[2].number, 0U);
    EXPECT_FALSE(lines[0].is_warning || lines[2].is_warning);
    EXPECT_TRUE(lines[1].is_warning && lines[3].is_warning);
    SiteSelection selection;
    selection.toggle("bob");
    mark_selected(selection, lines);
    EXPECT_TRUE(lines[0].is_shown && !lines[1].is_shown);
    selection.toggle_solo("alice");
    mark_selected(selection, lines);
    EXPECT_TRUE(lines[0].is_solo && lines[0].is_shown && !lines[2].is_shown);
}

TEST(SiteLines, TellForAWhileWhoLeft) {
    const auto line = [](const char* name, std::size_t number) {
        SiteLine made;
        made.name = name;
        made.number = number;
        return made;
    };
    const std::vector<SiteLine> before{
        line("alice", 1), line("bob", 2), line("carol", 3), line("empty", 0)};
    const DepartedPeople::Clock::time_point begin{};
    DepartedPeople departed;
    EXPECT_EQ(departed.update({}, begin), "");
    EXPECT_EQ(departed.update(before, begin), "");
    const std::vector<SiteLine> after{line("alice", 0), line("carol", 1)};
    EXPECT_EQ(departed.update(after, begin + 1s), "alice just left, bob just left")
        << "alice's room is still there";
    EXPECT_EQ(departed.update(after, begin + 6s), "alice left 5 s ago, bob left 5 s ago");
    const std::vector<SiteLine> back{line("bob", 1), line("carol", 2)};
    EXPECT_EQ(departed.update(back, begin + 7s), "alice left 6 s ago");
    EXPECT_EQ(departed.update(back, begin + 1s + DepartedPeople::kShown), "alice left 20 s ago");
    EXPECT_EQ(departed.update(back, begin + 2s + DepartedPeople::kShown), "");
}

TEST(SiteLines, AreBounded) {
    std::set<std::string> names;
    for (int i = 0; i < 1000; ++i) names.insert("site-" + std::to_string(i));
    EXPECT_EQ(site_lines({}, names, StatusLines()).size(), 64U);
}

TEST(StartScreen, ListsTheHeardWorldsAndThenTheRememberedOnes) {
    bus::BusOptions options;
    options.domain = 3;
    presence::HeardWorld lab;
    lab.name = "lab";
    lab.servers = {"ada"};
    lab.sites = {"alice", "bob"};
    bus::BusOptions known = options;
    known.world = "lab";
    bus::BusOptions silent = options;
    silent.world = "garden";
    bus::BusOptions elsewhere = silent;
    elsewhere.network = "lan";
    const auto entries = world_entries(options, {lab}, {known, silent, elsewhere});
    ASSERT_EQ(entries.size(), 3U);
    EXPECT_EQ(entries[0].options.world, "lab");
    EXPECT_EQ(entries[0].options.domain, 3U);
    EXPECT_TRUE(entries[0].is_heard);
    EXPECT_EQ(entries[0].text, "world server on ada, 2 sites: alice, bob");
    EXPECT_EQ(entries[1].text, "joined before; not heard now");
    EXPECT_EQ(entries[2].text, "joined before; network lan, domain 3");
    EXPECT_FALSE(entries[1].is_heard || entries[2].is_heard);
}

}  // namespace
}  // namespace atrium::viewer
