#include "tools/play/keyboard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace atrium::play {
namespace {

using ::testing::ElementsAre;

// Standard input is a pipe of the test.
class PipedKeyboard : public ::testing::Test {
protected:
    void SetUp() override {
        saved_ = ::dup(STDIN_FILENO);
        int ends[2];
        ASSERT_EQ(::pipe(ends), 0);
        ASSERT_EQ(::dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
        ::close(ends[0]);
        input_ = ends[1];
    }
    void TearDown() override {
        close_input();
        ::dup2(saved_, STDIN_FILENO);
        ::close(saved_);
    }
    void type(std::string_view text) const {
        ASSERT_EQ(::write(input_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    }
    void close_input() {
        if (input_ >= 0) ::close(input_);
        input_ = -1;
    }
    static constexpr std::chrono::milliseconds kWait{1};

    int saved_ = -1;
    int input_ = -1;
};

TEST_F(PipedKeyboard, ReadsWholeLines) {
    Keyboard keyboard;
    EXPECT_FALSE(keyboard.has_keys());
    EXPECT_TRUE(keyboard.read(kWait).empty());
    type("one\ntw");
    EXPECT_THAT(keyboard.read(kWait), ElementsAre("one"));
    type("o\n\nthree\n");
    EXPECT_THAT(keyboard.read(kWait), ElementsAre("two", "three"));
    EXPECT_TRUE(keyboard.is_open());
}

TEST_F(PipedKeyboard, ReadsTheLastLineWithoutItsEnd) {
    Keyboard keyboard;
    type("quit");
    close_input();
    EXPECT_TRUE(keyboard.read(kWait).empty());
    EXPECT_THAT(keyboard.read(kWait), ElementsAre("quit"));
    EXPECT_FALSE(keyboard.is_open());
    EXPECT_TRUE(keyboard.read(kWait).empty());
}

TEST_F(PipedKeyboard, ForgetsALineWithoutEnd) {
    Keyboard keyboard;
    const std::string much(30'000, 'x');
    for (int i = 0; i < 30; ++i) {
        type(much);
        for (int k = 0; k < 8; ++k) EXPECT_TRUE(keyboard.read(kWait).empty());
    }
    type("\nafter\n");
    const auto lines = keyboard.read(kWait);
    ASSERT_FALSE(lines.empty());
    EXPECT_EQ(lines.back(), "after");
    EXPECT_LE(lines.front().size(), 100'000u);
}

}  // namespace
}  // namespace atrium::play
