#include "world_server/command_answers.hpp"
#include "world_server/command_inbox.hpp"
#include "world_server/command_rights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::world_server {
namespace {

using namespace std::chrono_literals;
using bus::CommandKind;
using testing::HasSubstr;

Expected<Rights> read(const std::string& toml) {
    auto reader = config::TableReader::parse(toml, "world.toml");
    if (!reader) return tl::unexpected(reader.error());
    Rights rights;
    read_rights(*reader, rights);
    if (const auto done = reader->finish(); !done) return tl::unexpected(done.error());
    return rights;
}

// In a world without keys.
bool may(const Rights& rights, CommandKind kind, const std::string& sender) {
    return !refusal(rights, right_for(kind), sender, std::nullopt);
}

TEST(Rights, OfTheFileAndOfTheKeyAreBothNeeded) {
    const auto rights = read("[rights]\npush = ['bob']\n");
    ASSERT_TRUE(rights);
    const keys::Rights pushes{keys::Right::kPush};
    EXPECT_FALSE(refusal(*rights, keys::Right::kPush, "bob", pushes));
    EXPECT_THAT(refusal(*rights, keys::Right::kGrab, "bob", pushes).value_or(""),
                HasSubstr("the key of bob does not have the right grab"));
    EXPECT_THAT(refusal(*rights, keys::Right::kPush, "eve", pushes).value_or(""),
                HasSubstr("not allowed to eve by [rights] push"));
    EXPECT_TRUE(refusal(*rights, keys::Right::kPush, "bob", keys::Rights()));
}

TEST(Rights, HaveTheKeysOfTheFileInTheOrderOfTheCertifiedOnes) {
    for (std::size_t i = 0; i < kRights.size(); ++i)
        EXPECT_EQ(keys::rights_text({static_cast<keys::Right>(i)}), kRights[i].first);
}

TEST(Rights, AllowEveryoneAllButSavingWithoutATable) {
    const auto rights = read("");
    ASSERT_TRUE(rights);
    for (const CommandKind kind : {CommandKind::kAdd,
                                   CommandKind::kRemove,
                                   CommandKind::kReset,
                                   CommandKind::kPush,
                                   CommandKind::kGrab,
                                   CommandKind::kMove,
                                   CommandKind::kRelease})
        EXPECT_TRUE(may(*rights, kind, "anybody")) << to_string(kind);
    EXPECT_FALSE(may(*rights, CommandKind::kSave, "anybody"));
    EXPECT_FALSE(may(*rights, CommandKind::kRestore, "anybody"));
}

TEST(Rights, FollowTheFile) {
    const auto rights = read(
        "[rights]\nadd = 'nobody'\nreset = ['eve', 'bob']\nsave = ['bob']\ngrab = []\n"
        "push = 'everyone'\nmax_per_s = 10\n");
    ASSERT_TRUE(rights) << rights.error().message;
    EXPECT_FALSE(may(*rights, CommandKind::kAdd, "eve"));
    EXPECT_TRUE(may(*rights, CommandKind::kReset, "eve"));
    EXPECT_FALSE(may(*rights, CommandKind::kReset, "ev"));
    EXPECT_FALSE(may(*rights, CommandKind::kReset, "mallory"));
    EXPECT_TRUE(may(*rights, CommandKind::kSave, "bob"));
    EXPECT_TRUE(may(*rights, CommandKind::kRestore, "bob"));
    EXPECT_FALSE(may(*rights, CommandKind::kMove, "bob")) << "move follows grab";
    EXPECT_TRUE(may(*rights, CommandKind::kPush, "mallory"));
    EXPECT_TRUE(may(*rights, CommandKind::kRemove, "mallory")) << "remove is not in the file";
    EXPECT_EQ(rights->max_per_s, 10.0);
}

TEST(Rights, EveryoneInAListIsEveryone) {
    const auto rights = read("[rights]\nsave = ['everyone']\nadd = ['eve', 'everyone']\n");
    ASSERT_TRUE(rights) << rights.error().message;
    EXPECT_TRUE(may(*rights, CommandKind::kSave, "mallory"));
    EXPECT_TRUE(may(*rights, CommandKind::kAdd, "mallory"));
}

TEST(Rights, NameErrors) {
    EXPECT_THAT(read("[rights]\nadd = 'some'").error().message, HasSubstr("world.toml:2"));
    EXPECT_THAT(read("[rights]\nadd = ['a b']").error().message, HasSubstr("viewers' names"));
    EXPECT_THAT(read("[rights]\nadd = 'host'").error().message, HasSubstr("[\"host\"]"));
    EXPECT_FALSE(read("[rights]\nadd = [1]"));
    EXPECT_FALSE(read("[rights]\nadd = 1"));
    EXPECT_THAT(read("[rights]\nfly = 'nobody'").error().message, HasSubstr("fly"));
    EXPECT_FALSE(read("[rights]\nmax_per_s = 0"));
}

TEST(CommandRates, LimitEachSenderSeparately) {
    CommandRates rates(10.0);
    const CommandRates::Clock::time_point start{};
    int admitted = 0;
    for (int i = 0; i < 100; ++i) admitted += rates.admit("eve", start) ? 1 : 0;
    EXPECT_EQ(admitted, 5) << "a burst";
    EXPECT_TRUE(rates.admit("bob", start)) << "another sender must not be limited";
    admitted = 0;
    for (int i = 0; i < 1000; ++i) admitted += rates.admit("eve", start + i * 10ms) ? 1 : 0;
    EXPECT_NEAR(admitted, 100, 2) << "10 s";
    EXPECT_TRUE(rates.admit("eve", start + 1h));
    rates.forget("eve");
    EXPECT_EQ(rates.num_senders(), 1U);
}

bus::SceneCommand command(const std::string& sender, CommandKind kind) {
    bus::SceneCommand c;
    c.sender = sender;
    c.kind = kind;
    return c;
}

TEST(CommandInbox, RefusesForbiddenTooFrequentAndTooManyCommands) {
    Rights rights;
    rights.max_per_s = 600.0;
    rights.reset = {false, {"bob"}};
    CommandInbox inbox(rights);
    const CommandRates::Clock::time_point now{};
    EXPECT_FALSE(inbox.put(command("bob", CommandKind::kReset), now));
    EXPECT_EQ(inbox.put(command("eve", CommandKind::kReset), now).value(),
              "reset: not allowed to eve by [rights] reset of the world file");
    int num_fast = 0;
    int num_many = 0;
    for (int i = 0; i < 400; ++i) {
        const auto why = inbox.put(command("eve", CommandKind::kPush), now);
        if (!why) continue;
        num_fast += why->find("a second") != std::string::npos ? 1 : 0;
        num_many += why->find("at once") != std::string::npos ? 1 : 0;
    }
    EXPECT_GT(num_fast, 50);
    EXPECT_GT(num_many, 10);
    inbox.leave("eve");
    const auto content = inbox.take_all();
    EXPECT_EQ(content.commands.size(), 256U);
    EXPECT_EQ(content.commands.front().sender, "bob") << "in order";
    EXPECT_TRUE(content.left.contains("eve"));
    EXPECT_TRUE(inbox.take_all().commands.empty());
}

TEST(CommandAnswers, TellASenderAtALimitedRateWhyItsCommandsHaveNoEffect) {
    CommandAnswers answers;
    const CommandAnswers::Clock::time_point start{};
    const std::string why = "grab: not allowed to eve by [rights] grab of the world file";
    const auto first = answers.refused("eve", CommandKind::kGrab, 7, why, start);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->sender, "eve");
    EXPECT_EQ(first->text, "not pulled: not allowed to eve by [rights] grab of the world file");
    EXPECT_FALSE(first->is_done);
    EXPECT_EQ(first->number, 0U) << "no edit has it";
    EXPECT_EQ(first->object, 7U);
    int num_answers = 0;
    for (int i = 0; i < 15; ++i)
        num_answers += answers.refused("eve", CommandKind::kGrab, 7, why, start + i * 16ms) ? 1 : 0;
    EXPECT_EQ(num_answers, 0);
    const auto reset = answers.refused("eve", CommandKind::kReset, 7, why, start);
    ASSERT_TRUE(reset) << "another command";
    EXPECT_EQ(reset->object, 0U);
    EXPECT_TRUE(answers.refused("joe", CommandKind::kGrab, 7, why, start)) << "another sender";
    EXPECT_TRUE(answers.refused("eve", CommandKind::kGrab, 7, why, start + 250ms));
}

TEST(CommandAnswers, SkipWhatFollowsAGrabAndWhatTheViewerWatchesItself) {
    CommandAnswers answers;
    for (const CommandKind kind :
         {CommandKind::kMove, CommandKind::kRelease, CommandKind::kAdd, CommandKind::kRemove})
        EXPECT_FALSE(answers.refused("eve", kind, 7, "no", {})) << to_string(kind);
    EXPECT_FALSE(answers.done("eve", CommandKind::kGrab, {}));
    const auto reset = answers.done("eve", CommandKind::kReset, {});
    ASSERT_TRUE(reset);
    EXPECT_TRUE(reset->is_done);
    EXPECT_EQ(reset->text, "all objects were reset");
}

TEST(CommandAnswers, RememberABoundedNumberOfSenders) {
    CommandAnswers answers;
    for (int i = 0; i < 5000; ++i)
        answers.refused("eve" + std::to_string(i), CommandKind::kPush, 7, "no", {});
    EXPECT_LE(answers.num_remembered(), 4096U);
    answers.forget("eve7");
    EXPECT_TRUE(answers.refused("eve7", CommandKind::kPush, 7, "no", {}));
}

}  // namespace
}  // namespace atrium::world_server
