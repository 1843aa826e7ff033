#include "viewer/ui/escape_order.hpp"

#include "tests/support/source_dir.hpp"
#include "viewer/ui/asked_again.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

// What Esc ends, without a window.
namespace atrium::viewer {
namespace {

TEST(EscapeOrder, EndsOneThingAfterTheOther) {
    Openings open{true, true, true, true, true, true, true};
    EXPECT_EQ(escape_ends(open), EscapeEnds::kQuestion);
    open.question = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kPopup);
    open.popup = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kDrag);
    open.drag = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kPanel);
    open.panel = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kSelection);
    open.selection = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kFollowing);
    open.following = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kEyes);
    open.eyes = false;
    EXPECT_EQ(escape_ends(open), EscapeEnds::kViewer);
}

TEST(EscapeOrder, StandsInTheManual) {
    std::ifstream file(atrium::test::source_dir() + "/docs/viewer_window.md");
    const std::string manual{std::istreambuf_iterator<char>(file), {}};
    std::size_t at = manual.find("Esc ends one thing at a time");
    ASSERT_NE(at, std::string::npos);
    for (const char* word : {"question",
                             "text field",
                             "colour picker",
                             "drag",
                             "panel",
                             "selection",
                             "following",
                             "eyes",
                             "asks"}) {
        at = manual.find(word, at);
        EXPECT_NE(at, std::string::npos) << word;
    }
}

TEST(OpenedPanels, CloseTheOneThatWasOpenedLast) {
    OpenedPanels<int> panels;
    panels.toggle(1);
    panels.toggle(2);
    panels.toggle(3);
    panels.toggle(2);
    panels.open(1);
    panels.close_last();
    EXPECT_FALSE(panels.has(3));
    EXPECT_TRUE(panels.has(1)) << "opening it again changes nothing";
    panels.close_last();
    EXPECT_TRUE(panels.is_empty());
    panels.close_last();
}

TEST(AskedAgain, WantsTheSameKeyWithinThreeSeconds) {
    AskedAgain asked;
    EXPECT_FALSE(asked.action(10.0));
    EXPECT_FALSE(asked.is_confirmed(Action::kReset, 10.0));
    EXPECT_EQ(asked.action(12.9), Action::kReset);
    EXPECT_TRUE(asked.is_confirmed(Action::kReset, 12.9));
    EXPECT_FALSE(asked.is_confirmed(Action::kReset, 13.0)) << "it asks anew";
    EXPECT_FALSE(asked.is_confirmed(Action::kReset, 17.0)) << "too late";
    asked.pressed(Action::kNames);
    EXPECT_FALSE(asked.action(17.1));
    EXPECT_FALSE(asked.is_confirmed(Action::kReset, 18.0));
    asked.take_back();
    EXPECT_FALSE(asked.action(18.1));
}

}  // namespace
}  // namespace atrium::viewer
