#include "viewer/control/edit_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using History = EditHistory;
const History::Clock::time_point kBegin{};

History::Object thing_of(std::uint32_t id, double mass_kg) {
    History::Object thing;
    thing.object.object = id;
    thing.object.name = "ball";
    thing.object.mass_kg = mass_kg;
    return thing;
}

bus::EditResult answer(const bus::SceneEdit& edit,
                       std::uint32_t revision,
                       std::uint32_t object,
                       const std::string& refusal = "") {
    bus::EditResult result;
    result.sender = edit.sender;
    result.number = edit.number;
    result.is_done = refusal.empty();
    result.object = object;
    result.revision = revision;
    result.text = refusal;
    return result;
}

TEST(EditHistory, UndoesInReverseOrderWithTheNewestRevision) {
    History history("eve");
    std::vector<std::string> texts;
    auto light = thing_of(7, 1.0);
    auto heavy = thing_of(7, 2.0);
    auto heavier = thing_of(7, 3.0);
    const auto first = history.change(light, heavy.object, kBegin);
    EXPECT_EQ(first.revision, bus::SceneEdit::kAnyRevision);
    EXPECT_THAT(history.take({answer(first, 1, 7)}, true, kBegin), ElementsAre("ball was changed"));
    const auto second = history.change(heavy, heavier.object, kBegin);
    history.take({answer(second, 2, 7)}, true, kBegin);

    history.want_undo();
    history.want_undo();
    const auto undo = history.next(kBegin, texts);
    ASSERT_TRUE(undo);
    EXPECT_EQ(undo->object.mass_kg, 2.0);
    EXPECT_EQ(undo->revision, 2U);
    EXPECT_FALSE(history.next(kBegin, texts)) << "one at a time";
    EXPECT_THAT(history.take({answer(*undo, 3, 7)}, true, kBegin),
                ElementsAre("undone: changed ball: 2 kg"));
    const auto undo_first = history.next(kBegin, texts);
    ASSERT_TRUE(undo_first);
    EXPECT_EQ(undo_first->object.mass_kg, 1.0);
    EXPECT_EQ(undo_first->revision, 3U) << "this viewer's own undo is no change by somebody else";
    history.take({answer(*undo_first, 4, 7)}, true, kBegin);

    history.want_undo();
    EXPECT_FALSE(history.next(kBegin, texts));
    EXPECT_THAT(texts, ElementsAre("nothing to undo"));
    history.want_redo();
    const auto redo = history.next(kBegin, texts);
    ASSERT_TRUE(redo);
    EXPECT_EQ(redo->object.mass_kg, 2.0);
    history.take({answer(*redo, 5, 7)}, true, kBegin);
    ASSERT_NE(history.redo_step(), nullptr);
    // a new edit ends what can be redone
    const auto third = history.change(heavy, light.object, kBegin);
    history.take({answer(third, 6, 7)}, true, kBegin);
    EXPECT_EQ(history.redo_step(), nullptr);
}

TEST(EditHistory, TellsWhoMadeAnUndoImpossibleAndDropsIt) {
    History history("eve");
    std::vector<std::string> texts;
    const auto place = history.place(thing_of(7, 1.0), {}, kBegin);
    history.take({answer(place, 1, 7)}, true, kBegin);
    history.want_undo();
    const auto undo = history.next(kBegin, texts);
    ASSERT_TRUE(undo);
    EXPECT_THAT(
        history.take({answer(*undo, 0, 7, "ball was changed by bob meanwhile")}, true, kBegin),
        ElementsAre("not undone: placed ball: ball was changed by bob meanwhile"));
    EXPECT_EQ(history.undo_step(), nullptr);
    EXPECT_EQ(history.redo_step(), nullptr);
}

TEST(EditHistory, AddedAndRemovedObjectsChangePlaces) {
    History history("eve");
    std::vector<std::string> texts;
    const auto add = history.add(thing_of(0, 1.0).object, kBegin);
    EXPECT_EQ(add.target, 0U);
    history.take({answer(add, 1, 1003)}, true, kBegin);
    EXPECT_EQ(history.take_added(), 1003U);
    EXPECT_EQ(history.take_added(), 0U);
    history.want_undo();
    const auto undo = history.next(kBegin, texts);
    ASSERT_TRUE(undo);
    EXPECT_EQ(undo->kind, bus::EditKind::kRemove);
    EXPECT_EQ(undo->target, 1003U);
    history.take({answer(*undo, 2, 1003)}, true, kBegin);
    history.want_redo();
    const auto redo = history.next(kBegin, texts);
    ASSERT_TRUE(redo);
    EXPECT_EQ(redo->kind, bus::EditKind::kAdd);
    EXPECT_EQ(redo->target, 1003U) << "it comes back under its number";
}

TEST(EditHistory, ReportsWhatHasNoResult) {
    History history("eve");
    history.change(thing_of(7, 1.0), thing_of(7, 2.0).object, kBegin);
    EXPECT_THAT(history.take({}, true, kBegin + 2400ms), IsEmpty());
    EXPECT_THAT(history.take({}, true, kBegin + 2600ms),
                ElementsAre("ball: no result: the world server did not react"));
    history.save_world("room", kBegin);
    EXPECT_THAT(history.take({}, false, kBegin + 3s),
                ElementsAre("world room: no result: no world server that knows edits is running"));
    // refusals of holds have no watched edit
    EXPECT_THAT(
        history.take(
            {answer(history.edit(bus::EditKind::kHold, 7), 0, 7, "held by bob")}, true, kBegin),
        ElementsAre("held by bob"));
}

TEST(EditHistory, CorrectsThatThereIsNoResultWhenItComesLate) {
    History history("eve");
    const auto load = history.load_world("evening", kBegin);
    const auto change = history.change(thing_of(7, 1.0), thing_of(7, 2.0).object, kBegin);
    EXPECT_THAT(history.take({}, true, kBegin + 3s), SizeIs(2));
    EXPECT_THAT(history.take({answer(load, 0, 0), answer(change, 1, 7)}, true, kBegin + 6s),
                ElementsAre("world evening was loaded (late, after 6 s)",
                            "ball was changed (late, after 6 s)"));
    ASSERT_NE(history.undo_step(), nullptr) << "it can be undone";
    EXPECT_THAT(history.take({answer(load, 0, 0)}, true, kBegin + 7s), IsEmpty()) << "once";
}

TEST(EditHistory, KnowsWhatThisViewerRemoved) {
    History history("eve");
    std::vector<std::string> texts;
    const auto remove = history.remove(thing_of(7, 1.0), kBegin);
    EXPECT_TRUE(history.has_removed(7)) << "asked for";
    history.take({answer(remove, 1, 7)}, true, kBegin);
    EXPECT_TRUE(history.has_removed(7));
    history.want_undo();
    const auto undo = history.next(kBegin, texts);
    ASSERT_TRUE(undo);
    history.take({answer(*undo, 2, 7)}, true, kBegin);
    EXPECT_FALSE(history.has_removed(7)) << "it is back";
}

TEST(EditHistory, PassesOnAnswersToCommands) {
    History history("eve");
    history.change(thing_of(7, 1.0), thing_of(7, 2.0).object, kBegin);
    const bus::SceneEdit without_number;
    bus::EditResult done = answer(without_number, 0, 0);
    done.text = "all objects were reset";
    EXPECT_THAT(history.take({answer(without_number, 0, 0, "not pulled"), done}, true, kBegin),
                ElementsAre("not pulled", "all objects were reset"));
    EXPECT_EQ(history.undo_step(), nullptr);
    EXPECT_THAT(history.take({}, true, kBegin + 3s), SizeIs(1)) << "the change is still awaited";
}

}  // namespace
}  // namespace atrium::viewer
