#include "tools/site_control/control.hpp"

#include "tools/site_control/remote_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace atrium::site_control {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using namespace std::chrono_literals;

constexpr auto kPatience = 60s;

hosts::HostEntry host(const std::string& name, bool is_model = false) {
    hosts::HostEntry entry;
    entry.name = name;
    entry.cameras = {"camera of " + name};
    entry.is_model = is_model;
    return entry;
}

TEST(RunScript, ReturnsOutputAndExitCode) {
    const auto answer = run_script({"sh", "-s"}, "echo one; echo two >&2; exit 3\n", kPatience);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->exit_code, 3);
    EXPECT_THAT(answer->output, HasSubstr("one\n"));
    EXPECT_THAT(answer->output, HasSubstr("two\n"));
}

TEST(RunScript, SendsAndReceivesMoreThanAPipeHolds) {
    std::string script = "cat << 'END'\n";
    for (int i = 0; i < 40'000; ++i) script += "a line of a long file\n";
    script += "END\n";
    const auto answer = run_script({"sh", "-s"}, script, kPatience);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->output.size(), 40'000u * 22u);
}

TEST(RunScript, EndsACommandThatDoesNotAnswer) {
    const auto answer = run_script({"sleep", "1000"}, "", 1s);
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(answer.error().message, HasSubstr("no answer for 1 s"));
}

TEST(RunScript, NamesAMissingProgramAndSurvivesOneThatReadsNothing) {
    EXPECT_THAT(run_script({"no-such-program"}, "", kPatience).error().message,
                HasSubstr("cannot run 'no-such-program'"));
    const std::string large(1 << 20, 'x');
    const auto answer = run_script({"true"}, large, kPatience);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->exit_code, 0);
}

TEST(Scripts, QuotesAnything) {
    for (const std::string text : {"", "a b", "it's", "$HOME `id` \"x\" \\"}) {
        const auto answer = run_script({"sh", "-s"}, "printf %s " + quoted(text) + "\n", kPatience);
        ASSERT_TRUE(answer);
        EXPECT_EQ(answer->output, text);
    }
}

TEST(Shell, ThisHostNeedsNoSsh) {
    EXPECT_THAT(shell_of("left", "left", {"ssh"}), testing::ElementsAre("sh", "-s"));
    EXPECT_THAT(shell_of("left", "hull", {"ssh", "-l", "lab"}),
                testing::ElementsAre("ssh", "-l", "lab", "left", "sh", "-s"));
}

// All hosts are this one, each with a home of its own: `ssh` is a script that runs its command
// here.
class Control : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) / ("site_control_" + std::to_string(getpid()));
        fs::create_directories(folder_ / "deploy" / "sites");
        fs::create_directories(folder_ / "deploy" / "rigs");
        fs::create_directories(folder_ / "bin");
        write("deploy/sites/hall.toml", "[site]\nname = \"hall\"\n");
        write("deploy/rigs/hall.toml", "units = \"m\"\n# it's a $rig\n");
        write("fake_ssh",
              "#!/bin/sh\nhost=$1; shift\n[ \"$host\" = dead ] && exec sleep 1000\n"
              "folder=" +
                  folder_.string() +
                  "\nexport HOME=$folder/home/$host; mkdir -p \"$HOME\"\n"
                  "[ -d \"$folder/commands\" ] && export PATH=\"$folder/commands\"\nexec \"$@\"\n");
        // a program that shows its file's rig and goes on, as a site would
        write("bin/camera_node",
              "#!/bin/sh\necho \"2026 info camera_node $*\"; cat \"$(dirname "
              "\"$2\")/../rigs/hall.toml\"\n"
              "echo \"2026 warning camera_node something\"\nexec sleep 1000\n");
        write("bin/site_node", "#!/bin/sh\necho 'site_node: error: no network'; exit 3\n");
        for (const char* file : {"fake_ssh", "bin/camera_node", "bin/site_node"})
            fs::permissions(folder_ / file, fs::perms::owner_all);
        options_.site = "hall";
        options_.site_file = folder_ / "deploy" / "sites" / "hall.toml";
        options_.rig_file = folder_ / "deploy" / "rigs" / "hall.toml";
        options_.this_host = "desk";
        options_.ssh = {(folder_ / "fake_ssh").string()};
        options_.programs = (folder_ / "bin").string();
        options_.patience = kPatience;
        options_.hosts = {host("left"), host("right")};
    }
    void TearDown() override {
        lines(Command::kDown);
        fs::remove_all(folder_);
    }
    void write(const std::string& file, const std::string& text) {
        std::ofstream(folder_ / file) << text;
    }
    std::vector<std::string> lines(Command command) {
        options_.command = command;
        std::vector<std::string> said;
        is_good_ = control(options_, [&](const std::string& line) { said.push_back(line); });
        return said;
    }
    // A program that was started has not written its log yet.
    std::vector<std::string> logs_when_they_have(const std::string& line) {
        const auto give_up = std::chrono::steady_clock::now() + kPatience;
        auto logs = lines(Command::kLogs);
        while (std::ranges::find(logs, line) == logs.end() &&
               std::chrono::steady_clock::now() < give_up)
            logs = lines(Command::kLogs);
        return logs;
    }

    fs::path folder_;
    ControlOptions options_;
    bool is_good_ = false;
};

TEST_F(Control, StartsShowsAndEndsThePrograms) {
    EXPECT_THAT(lines(Command::kStatus), Contains("left: does not run camera_node"));
    EXPECT_FALSE(is_good_);
    EXPECT_THAT(lines(Command::kUp), Contains(StartsWith("left: started camera_node ")));
    EXPECT_TRUE(is_good_);
    EXPECT_THAT(lines(Command::kUp), Contains(StartsWith("right: runs camera_node ")))
        << "not twice";
    const auto logs = logs_when_they_have("left: 2026 warning camera_node something");
    EXPECT_THAT(logs, Contains(HasSubstr("--host left")));
    EXPECT_THAT(logs, Contains("left: # it's a $rig")) << "the rig lies where the file says";
    const auto status = lines(Command::kStatus);
    EXPECT_TRUE(is_good_);
    EXPECT_THAT(status, Contains(ContainsRegex("^left: runs camera_node [0-9]+, for [0-9]+ s$")));
    EXPECT_THAT(status, Contains(HasSubstr("warning camera_node something")));
    EXPECT_THAT(lines(Command::kDown), Contains("left: ended camera_node"));
    const auto ended = lines(Command::kStatus);
    EXPECT_THAT(ended, Contains("right: does not run camera_node"));
    EXPECT_THAT(ended, Not(Contains(HasSubstr("warning")))) << "of before";
    EXPECT_THAT(lines(Command::kDown), Contains("left: did not run camera_node"));
}

TEST_F(Control, SaysWhyAProgramFails) {
    options_.hosts = {host("left", true)};
    const auto said = lines(Command::kUp);
    EXPECT_FALSE(is_good_);
    EXPECT_THAT(said, Contains(StartsWith("left: started camera_node ")));
    EXPECT_THAT(said, Contains("left: failed site_node: site_node: error: no network"));
    EXPECT_THAT(lines(Command::kStatus), Contains("left:   site_node: error: no network"));
    // all commands of this host but ours, whose packages may be installed
    fs::create_directories(folder_ / "commands");
    for (const fs::directory_entry& command : fs::directory_iterator("/usr/bin")) {
        const std::string name = command.path().filename().string();
        if (!name.ends_with("camera_node"))
            fs::create_symlink(command.path(), folder_ / "commands" / name);
    }
    options_.programs = "/nowhere";
    options_.hosts = {host("right")};
    EXPECT_THAT(lines(Command::kUp),
                Contains("right: failed camera_node: it is not installed on this host"));
}

TEST_F(Control, AHostThatDoesNotAnswerDelaysNoOther) {
    options_.hosts.push_back(host("dead"));
    options_.patience = 4s;
    const auto said = lines(Command::kUp);
    EXPECT_FALSE(is_good_);
    EXPECT_THAT(said, Contains(StartsWith("left: started camera_node ")));
    EXPECT_THAT(said, Contains("dead: no answer for 4 s"));
}

TEST(Files, KeepTheWayFromTheSiteToItsRig) {
    const fs::path folder =
        fs::path(testing::TempDir()) / ("site_files_" + std::to_string(getpid()));
    fs::create_directories(folder / "a" / "b");
    for (const char* file : {"a/b/site.toml", "a/b/rig.toml", "rig.toml"})
        std::ofstream(folder / file) << "x = 1\n";
    const auto beside = files_to_send(folder / "a/b/site.toml", folder / "a/b/rig.toml");
    ASSERT_TRUE(beside);
    EXPECT_EQ((*beside)[0].path, "site.toml");
    EXPECT_EQ((*beside)[1].path, "rig.toml");
    const auto above = files_to_send(folder / "a/b/site.toml", folder / "a/b/../../rig.toml");
    ASSERT_TRUE(above);
    EXPECT_EQ((*above)[0].path, "site/site/site.toml");
    EXPECT_EQ((*above)[1].path, "rig.toml");
    EXPECT_FALSE(files_to_send(folder / "none.toml", {}));
    fs::remove_all(folder);
}

}  // namespace
}  // namespace atrium::site_control
