#include "tests/support/run_program.hpp"
#include "tools/atrium/commands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace atrium::front {
namespace {

namespace fs = std::filesystem;
using test_support::Outcome;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Front : public testing::Test {
protected:
    void SetUp() override {
        const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / "atrium_front" / test->name();
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    void add_program(const std::string& name, const std::string& script = "") const {
        const fs::path path = folder_ / name;
        std::ofstream(path) << "#!/bin/sh\n" << script;
        fs::permissions(path, fs::perms::owner_all);
    }
    std::vector<std::string> installed() const {
        std::vector<std::string> names;
        for (const Command& command : installed_commands(folder_)) names.push_back(command.name);
        return names;
    }
    Expected<std::vector<std::string>> program(const std::vector<std::string>& words) const {
        return program_for(words, folder_);
    }
    // The real front command, in a folder of other tools.
    Outcome run(const std::string& arguments) const {
        fs::copy_file(
            ATRIUM_BIN_DIR "/atrium", folder_ / "atrium", fs::copy_options::overwrite_existing);
        return test_support::run_program((folder_ / "atrium").string() + " " + arguments, 20);
    }

    fs::path folder_;
};

TEST_F(Front, ListsShippedCommandsFirstThenOthersByName) {
    for (const char* name : {"atrium-zoom", "atrium-hull", "atrium-extra", "atrium-demo", "other"})
        add_program(name);
    std::ofstream(folder_ / "atrium-notes.txt") << "not executable";
    EXPECT_THAT(installed(), ElementsAre("demo", "hull", "extra", "zoom"));
    EXPECT_THAT(help(installed_commands(folder_)),
                AllOf(HasSubstr("  hull        compute one visual hull"), HasSubstr("  zoom")));
}

TEST_F(Front, SaysSoWhereNoToolIsInstalled) {
    EXPECT_THAT(installed(), IsEmpty());
    EXPECT_THAT(help({}), HasSubstr("none: no program"));
    EXPECT_THAT(installed_commands(folder_ / "missing"), IsEmpty());
}

TEST_F(Front, HandsTheArgumentsToTheProgram) {
    add_program("atrium-hull");
    const std::string path = (folder_ / "atrium-hull").string();
    EXPECT_THAT(program({"hull", "views.json", "-o", "a b.ply"}).value(),
                ElementsAre(path, "views.json", "-o", "a b.ply"));
    EXPECT_THAT(program({"help", "hull"}).value(), ElementsAre(path, "--help"));
}

TEST_F(Front, NamesTheCommandThatMayBeMeant) {
    add_program("atrium-monitor");
    const auto misspelt = program({"monitr"});
    ASSERT_FALSE(misspelt);
    EXPECT_EQ(misspelt.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(misspelt.error().message,
                AllOf(HasSubstr("'monitr'"), HasSubstr("did you mean 'monitor'?")));
    const auto unknown = program({"bake"});
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().message, Not(HasSubstr("did you mean")));
}

TEST_F(Front, TellsAMissingToolFromAnUnknownOne) {
    const auto missing = program({"demo"});
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(missing.error().message, HasSubstr((folder_ / "atrium-demo").string()));
}

TEST_F(Front, RefusesNamesThatLeaveTheFolder) {
    fs::create_directories(folder_ / "atrium-");
    add_program("atrium-/tool");
    for (const char* name : {"/tool", "../atrium-hull", ""}) EXPECT_FALSE(program({name})) << name;
    EXPECT_EQ(program({"--no-such-option"}).error().kind, ErrorKind::kConfiguration);
}

TEST_F(Front, EndsAsTheToolEnds) {
    add_program("atrium-extra", "echo \"got $# [$1] [$2]\"; exit 7\n");
    const Outcome outcome = run("extra 'a b' --help");
    EXPECT_EQ(outcome.exit_code, 7);
    EXPECT_THAT(outcome.output, HasSubstr("got 2 [a b] [--help]"));
}

TEST_F(Front, ExplainsItself) {
    add_program("atrium-extra");
    for (const char* words : {"", "help", "--help", "-h"}) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exit_code, 0) << words;
        EXPECT_THAT(outcome.output, AllOf(HasSubstr("Usage: atrium NAME"), HasSubstr("extra")));
    }
    EXPECT_THAT(run("--version").output, HasSubstr("atrium "));
    EXPECT_EQ(run("no_such_command").exit_code, 2);
    EXPECT_EQ(run("monitor").exit_code, 3);
}

}  // namespace
}  // namespace atrium::front
