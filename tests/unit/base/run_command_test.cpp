#include "core/base/run_command.hpp"

#include "tests/support/temporary_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace atrium {
namespace {

using testing::AllOf;
using testing::HasSubstr;

CommandOutput output_of(const std::vector<std::string>& command, std::string_view input = {}) {
    const auto output = run_command(command, input);
    EXPECT_TRUE(output);
    return output.value_or(CommandOutput{-1, "not run"});
}

TEST(RunCommand, ReturnsTheExitCode) {
    EXPECT_EQ(output_of({"true"}).exit_code, 0);
    EXPECT_EQ(output_of({"false"}).exit_code, 1);
    EXPECT_EQ(output_of({"sh", "-c", "exit 42"}).exit_code, 42);
}

TEST(RunCommand, ReturnsTheOutputOfBothStreams) {
    const CommandOutput output = output_of({"sh", "-c", "echo one; echo two >&2; exit 3"});
    EXPECT_EQ(output.text, "one\ntwo\n");
    EXPECT_EQ(output.exit_code, 3);
    EXPECT_EQ(output_of({"true"}).text, "");
}

TEST(RunCommand, GivesItsInputToTheProgram) {
    EXPECT_EQ(output_of({"cat"}, "secret\nlines").text, "secret\nlines");
    EXPECT_EQ(output_of({"cat"}).text, "") << "its end comes at once";
    EXPECT_EQ(output_of({"cat", "/dev/stdin"}, "as a file").text, "as a file");
    EXPECT_EQ(output_of({"cat"}, std::string("a\0b", 3)).text, std::string("a\0b", 3));
    // more than a pipe holds, and nobody reads it
    EXPECT_EQ(output_of({"true"}, std::string(1U << 20U, 'x')).exit_code, 0);
    EXPECT_EQ(output_of({"wc", "-c"}, std::string(1U << 20U, 'x')).text, "1048576\n");
}

TEST(RunCommand, NamesAMissingProgram) {
    EXPECT_EQ(output_of({"atrium-no-such-program"}).exit_code, kNoSuchProgram);
    EXPECT_EQ(output_of({"/no/such/program"}).exit_code, kNoSuchProgram);
    EXPECT_EQ(output_of({""}).exit_code, kNoSuchProgram);
    EXPECT_FALSE(run_command({}));
}

TEST(RunCommand, LeavesArgumentsToNoShell) {
    const test::TemporaryFolder folder;
    const std::string file = (folder / "made").string();
    for (const std::string& argument : {"$(touch " + file + ")",
                                        "`touch " + file + "`",
                                        "; touch " + file,
                                        "> " + file,
                                        std::string("$HOME *"),
                                        std::string("two  words\n"),
                                        std::string("'\"\\")})
        EXPECT_EQ(output_of({"printf", "%s", argument}).text, argument);
    EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(RunCommand, FindsNoProgramByAWholeCommandLine) {
    EXPECT_EQ(output_of({"echo one"}).exit_code, kNoSuchProgram);
    EXPECT_EQ(output_of({"true; true"}).exit_code, kNoSuchProgram);
}

TEST(RunCommand, ReportsDeathsBySignal) {
    EXPECT_EQ(output_of({"sh", "-c", "echo last; kill -9 $$"}).exit_code, 128);
    EXPECT_EQ(output_of({"sh", "-c", "echo last; kill -9 $$"}).text, "last\n");
    EXPECT_EQ(output_of({"sh", "-c", "kill -15 $$"}).exit_code, 128);
}

TEST(RunCommand, KillsAProgramThatWritesWithoutEnd) {
    const CommandOutput output = output_of({"yes"});
    EXPECT_EQ(output.exit_code, 128);
    EXPECT_GE(output.text.size(), 1U << 20U);
    EXPECT_LT(output.text.size(), 2U << 20U);
}

TEST(RunCommand, SpeaksEnglishAndFindsTheProgramsOfRoot) {
    const CommandOutput output = output_of({"sh", "-c", "echo $LC_ALL; echo $PATH"});
    EXPECT_THAT(output.text, AllOf(HasSubstr("C\n"), HasSubstr(":/usr/sbin:/sbin:")));
}

}  // namespace
}  // namespace atrium
