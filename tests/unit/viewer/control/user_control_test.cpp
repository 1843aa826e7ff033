#include "viewer/control/user_control.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace atrium::viewer {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A user who presses keys in a world without people.
class UserKeys : public testing::Test {
protected:
    UserKeys() {
        bus::SceneObject ball;
        ball.object = 3;
        ball.name = "ball";
        objects_[3] = ball;
    }
    UserControl::Shown shown() {
        const auto none = [](const Ray&) { return std::optional<Hit>(); };
        return {pointer_, none, people_, objects_, none, states_, {}, visible_};
    }
    std::vector<std::string> texts(const SurfaceEvents& events) {
        control_.move(events, shown(), now_);
        control_.edit(events, shown(), {}, now_);
        return control_.take({}, now_);
    }

    Pointer pointer_;
    FollowCamera::Places people_;
    FollowCamera::Places visible_;
    SceneEditor::Objects objects_;
    std::vector<bus::ObjectState> states_;
    UserControl::Clock::time_point now_{};
    UserControl control_{renderer::ViewCamera{}, "eve", false};
};

TEST_F(UserKeys, FollowTheNearestPersonWhoIsNotHidden) {
    people_["alice"].middle = {0.0, 0.0, 1.0};
    people_["bob"].middle = {5.0, 0.0, 1.0};
    SurfaceEvents events;
    events.follow = true;
    EXPECT_THAT(texts(events), ElementsAre("nobody to follow: all are hidden (L)"));
    EXPECT_EQ(control_.followed(), "");
    visible_["bob"] = people_["bob"];
    EXPECT_THAT(texts(events), IsEmpty());
    EXPECT_EQ(control_.followed(), "bob");
    events = {};
    events.stop_following = true;
    texts(events);
    EXPECT_EQ(control_.followed(), "");
}

TEST_F(UserKeys, AnswerWhenTheyHaveNoEffect) {
    EXPECT_THAT(texts({}), IsEmpty());
    SurfaceEvents events;
    events.person = 5;
    EXPECT_THAT(texts(events), ElementsAre("no person 5"));
    EXPECT_THAT(texts({}), IsEmpty()) << "once";
    events = {};
    events.follow = true;
    EXPECT_THAT(texts(events), ElementsAre("nobody is here to follow"));
    events = {};
    events.remove_pointed = true;
    EXPECT_THAT(texts(events),
                ElementsAre("nothing to remove here: select an object, or point at one"));
}

TEST_F(UserKeys, SayThatTheyActOnASelectedObject) {
    SurfaceEvents events;
    events.edit.duplicate = true;
    EXPECT_THAT(texts(events), ElementsAre("Ctrl+D duplicates the selected object: click one"));
    events = {};
    events.edit.next_handles = true;
    EXPECT_THAT(texts(events),
                ElementsAre("J switches the handles of the selected object: click one"));
    events = {};
    events.edit.local_axes = true;
    EXPECT_THAT(texts(events),
                ElementsAre("C switches the axes of the selected object: click one"));
    EXPECT_FALSE(control_.edit_view(shown()).handles.is_local);
    EXPECT_THAT(control_.take_edits(), IsEmpty());
}

TEST_F(UserKeys, GiveAddedObjectsNamesThatAreFree) {
    EditNews news;
    news.saved_worlds.emplace();  // the server knows edits
    control_.take(news, now_);
    SurfaceEvents events;
    events.add.emplace().name = "ball";  // as object 3 is called
    EXPECT_THAT(texts(events), IsEmpty());
    events = {};
    events.edit.add_model.emplace().file = "models/teddy.ply";
    texts(events);
    const WorldEditing::Edits added = control_.take_edits();
    ASSERT_EQ(added.size(), 2U);
    EXPECT_EQ(added[0].object.name, "ball_2");
    EXPECT_EQ(added[1].object.name, "teddy");
}

TEST_F(UserKeys, DuplicateTheSelectedObjectSelectItAndUndoRemovesIt) {
    SurfaceEvents events;
    events.edit.select = 3;
    events.edit.duplicate = true;
    EXPECT_THAT(texts(events),
                ElementsAre("ball was not duplicated: the world server does not know edits"));
    EditNews news;
    news.saved_worlds.emplace();  // the server knows edits
    control_.take(news, now_);
    events = {};
    events.edit.duplicate = true;
    EXPECT_THAT(texts(events), IsEmpty());
    const WorldEditing::Edits added = control_.take_edits();
    ASSERT_EQ(added.size(), 1U);
    EXPECT_EQ(added[0].kind, bus::EditKind::kAdd);
    EXPECT_EQ(added[0].object.name, "ball_2");
    EXPECT_THAT(texts(events),
                ElementsAre("ball was not duplicated: the last new object is still on its way"));
    news = {};
    news.results.push_back({.sender = "eve",
                            .number = added[0].number,
                            .is_done = true,
                            .object = 1000,
                            .revision = 1,
                            .text = ""});
    EXPECT_THAT(control_.take(news, now_), ElementsAre("ball_2 was added"));
    objects_[1000] = added[0].object;
    objects_[1000].object = 1000;
    texts({});
    EXPECT_EQ(control_.edit_view(shown()).selected->object, 1000U);
    events = {};
    events.edit.undo = true;
    texts(events);
    const WorldEditing::Edits removed = control_.take_edits();
    ASSERT_EQ(removed.size(), 1U);
    EXPECT_EQ(removed[0].kind, bus::EditKind::kRemove);
    EXPECT_EQ(removed[0].target, 1000U);
}

TEST_F(UserKeys, AClickThatMayNotPullSelectsInSilence) {
    const auto refuse = [&] {
        EditNews news;
        news.results.push_back(
            {.sender = "eve", .number = 0, .object = 3, .text = "not pulled: not allowed to eve"});
        return control_.take(news, now_);
    };
    const auto point = [&](double x_px, bool is_down) {
        pointer_.at_px = {x_px, 0.0};
        pointer_.is_down = is_down;
        control_.move({}, shown(), now_);
        return control_.take({}, now_);
    };
    const auto told = ElementsAre("not pulled: not allowed to eve");
    point(0, true);
    EXPECT_THAT(refuse(), IsEmpty());
    EXPECT_THAT(point(2, true), IsEmpty()) << "as far as a click";
    EXPECT_THAT(point(2, false), IsEmpty());
    point(0, true);
    EXPECT_THAT(point(50, true), IsEmpty()) << "of the last press";
    EXPECT_THAT(refuse(), IsEmpty());
    EXPECT_THAT(point(60, true), told);
    EXPECT_THAT(point(60, false), IsEmpty()) << "once";
    point(0, true);
    point(50, false);
    EXPECT_THAT(refuse(), IsEmpty());
    EXPECT_THAT(point(90, false), IsEmpty()) << "the move after the release is none of the press";
}

TEST_F(UserKeys, SayWhySoftObjectsAreNotDuplicated) {
    EditNews news;
    news.saved_worlds.emplace();  // the server knows edits
    control_.take(news, now_);
    objects_[3].shape = bus::Shape::kSoft;
    SurfaceEvents events;
    events.edit.select = 3;
    events.edit.duplicate = true;
    EXPECT_THAT(
        texts(events),
        ElementsAre("ball is soft: it cannot be duplicated, only described in the world file"));
    EXPECT_THAT(control_.take_edits(), IsEmpty());
}

TEST_F(UserKeys, ReturnToTheStartThatTheViewerChose) {
    const renderer::ViewCamera chosen{.position_m = {0, -2, 1}, .target_m = {0, 2, 1}};
    const renderer::ViewCamera later{.position_m = {3, -2, 1}, .target_m = {3, 2, 1}};
    const auto is_at = [&](const renderer::ViewCamera& view) {
        return (control_.camera().position_m - view.position_m).norm() < 1e-9;
    };
    control_.set_start(chosen);
    EXPECT_TRUE(is_at(chosen)) << "the user has not moved";
    SurfaceEvents turn;
    turn.motion.turn_px = {50.0, 0.0};
    control_.move(turn, shown(), now_);
    control_.set_start(later);
    EXPECT_FALSE(is_at(chosen) || is_at(later)) << "the user has moved";
    SurfaceEvents home;
    home.reset_view = true;
    control_.move(home, shown(), now_);
    EXPECT_TRUE(is_at(later));
    control_.set_start(chosen);
    EXPECT_TRUE(is_at(chosen));
}

TEST_F(UserKeys, KeepAnObjectSelectedUntilItIsReallyRemoved) {
    EditNews news;
    news.saved_worlds.emplace();  // the server knows edits
    control_.take(news, now_);
    SurfaceEvents events;
    events.edit.select = 3;
    EXPECT_THAT(texts(events), IsEmpty());
    events = {};
    events.remove_pointed = true;
    events.is_over_panel = true;
    EXPECT_THAT(texts(events), IsEmpty());
    EXPECT_EQ(control_.take_edits().size(), 1U);
    EXPECT_TRUE(control_.edit_view(shown()).selected) << "it may be refused";
    objects_.clear();
    EXPECT_FALSE(control_.edit_view(shown()).selected);
}

TEST_F(UserKeys, SelectNothingAfterALoadThatMayGiveTheNumberToAnotherObject) {
    EditNews news;
    news.saved_worlds.emplace();
    control_.take(news, now_);
    SurfaceEvents events;
    events.edit.select = 3;
    EXPECT_THAT(texts(events), IsEmpty());
    ASSERT_TRUE(control_.edit_view(shown()).selected);
    events = {};
    events.edit.load_world = "evening";
    EXPECT_THAT(texts(events), IsEmpty());
    EXPECT_FALSE(control_.edit_view(shown()).selected);
}

}  // namespace
}  // namespace atrium::viewer
