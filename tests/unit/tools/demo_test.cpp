#include "tools/demo/log_lines.hpp"
#include "tools/demo/result_folder.hpp"
#include "tools/demo/start_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::demo {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string log_line(const std::string& level, const std::string& text) {
    return "2026-11-24T18:56:42.118 " + level + " site_node " + text + "\n";
}

TEST(DemoLogLines, FindsTheLastErrorElseTheLastWarning) {
    const std::string warned = log_line("warning", "first") + log_line("warning", "machine slow") +
                               log_line("info", "running");
    EXPECT_EQ(last_problem(warned, true), "machine slow");
    EXPECT_EQ(last_problem(warned, false), "") << "no reason for a death by signal";
    const std::string failed =
        warned + log_line("error", "failed reason=\"x\"") + log_line("warning", "later");
    EXPECT_EQ(last_problem(failed, true), "failed reason=\"x\"");
    EXPECT_EQ(last_problem("site_node: error: --a: must be b\n", true),
              "site_node: error: --a: must be b");
    EXPECT_EQ(last_problem("terminate called after throwing\n", false),
              "terminate called after throwing");
    EXPECT_EQ(last_problem("", true), "");
    EXPECT_EQ(last_problem("\n\nno log line", true), "");
}

TEST(DemoLogLines, KnowsHowFarARoomIsRendered) {
    const std::string rendering = log_line("info", "started version=1") +
                                  log_line("info", "rendering the simulated room 40 %");
    EXPECT_EQ(rendering_percent(rendering), 40);
    EXPECT_EQ(rendering_percent(rendering + log_line("warning", "machine_too_slow")), 40);
    EXPECT_EQ(rendering_percent(rendering + log_line("info", "source opened")), std::nullopt);
    EXPECT_EQ(rendering_percent(log_line("info", "rendering the simulated room 100 %")),
              std::nullopt);
    EXPECT_EQ(rendering_percent(log_line("info", "rendering the simulated room much")),
              std::nullopt);
    EXPECT_EQ(rendering_percent(""), std::nullopt);
}

class DemoFolder : public testing::Test {
protected:
    void SetUp() override { fs::remove_all(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    static void write(const fs::path& file, const std::string& text) {
        std::ofstream(file) << text;
    }
    static std::string read(const fs::path& file) {
        std::ifstream stream(file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }

    fs::path folder_ = fs::path(testing::TempDir()) / "atrium_demo_test";
};

TEST_F(DemoFolder, KeepsEarlierResultsUntilAnotherDemoSucceeds) {
    const auto run = [&](const std::string& text, bool succeeds) {
        const auto folder = ResultFolder::create(folder_);
        ASSERT_TRUE(folder) << folder.error().message;
        write(folder->running() / "report.json", text);
        if (succeeds) {
            ASSERT_TRUE(folder->keep());
        }
        folder->set_aside();
        EXPECT_FALSE(fs::exists(folder->running()));
    };
    run("first", true);
    EXPECT_EQ(read(folder_ / "report.json"), "first");
    run("second", false);
    EXPECT_EQ(read(folder_ / "report.json"), "first");
    EXPECT_EQ(read(folder_ / "failed" / "report.json"), "second");
    run("third", false);
    EXPECT_EQ(read(folder_ / "failed" / "report.json"), "third");
    run("fourth", true);
    EXPECT_EQ(read(folder_ / "report.json"), "fourth");
}

TEST_F(DemoFolder, ForgetsADemoThatWasKilledAndRefusesASecondOne) {
    fs::create_directories(folder_ / "running");
    write(folder_ / "running" / "old.log", "of a killed demo");
    const auto folder = ResultFolder::create(folder_);
    ASSERT_TRUE(folder);
    EXPECT_FALSE(fs::exists(folder->running() / "old.log"));
    const auto second = ResultFolder::create(folder_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(second.error().message, HasSubstr("another demo is writing there"));
}

TEST_F(DemoFolder, ReadsTheSitesAndNamesWhatIsMissing) {
    fs::create_directories(folder_ / "sites");
    write(folder_ / "sites" / "alice.toml", "[site]\nname = \"studio\"\n");
    write(folder_ / "sites" / "bob.toml", "");
    DemoConfig config;
    config.deploy = folder_;
    config.sites = " alice, bob";
    config.motions = "walk,wave";
    config.world = config.viewer = folder_ / "sites" / "bob.toml";
    config.programs = folder_;
    for (const char* program : {"site_node", "world_server", "viewer"}) {
        write(folder_ / program, "");
        fs::permissions(folder_ / program, fs::perms::owner_all);
    }
    const auto sites = check_start(config);
    ASSERT_TRUE(sites) << sites.error().message;
    EXPECT_EQ((*sites)[0].name, "studio") << "as it announces itself";
    EXPECT_EQ((*sites)[1].name, "bob");
    EXPECT_EQ((*sites)[1].motion, "wave");

    const auto error_of = [&](auto change) {
        DemoConfig changed = config;
        change(changed);
        const auto result = check_start(changed);
        return result ? std::string() : result.error().message;
    };
    EXPECT_THAT(error_of([](DemoConfig& c) { c.sites = "alcie"; }),
                AllOf(HasSubstr("did you mean alice?"), HasSubstr("available: alice, bob")));
    EXPECT_THAT(error_of([](DemoConfig& c) { c.sites = "bob,bob"; }), HasSubstr("called 'bob'"));
    EXPECT_THAT(error_of([](DemoConfig& c) { c.motions = "walk"; }), HasSubstr("got 1"));
    EXPECT_THAT(error_of([](DemoConfig& c) { c.deploy = "/no/such"; }), HasSubstr("--deploy"));
    EXPECT_THAT(error_of([](DemoConfig& c) { c.world = "no.toml"; }), HasSubstr("--world"));
    EXPECT_THAT(error_of([](DemoConfig& c) { c.programs = "/no"; }), HasSubstr("make programs"));
}

TEST_F(DemoFolder, FindsTheFilesOfAnInstallation) {
    const fs::path before = fs::current_path();
    fs::create_directories(folder_ / "here");
    fs::create_directories(folder_ / "installed" / "deploy");
    fs::current_path(folder_ / "here");
    const auto completed = [&](DemoConfig config) {
        use_installed(config, folder_ / "installed" / "bin");
        return config;
    };
    const DemoConfig found = completed({});
    EXPECT_EQ(found.programs, folder_ / "installed" / "bin");
    EXPECT_EQ(found.world, folder_ / "installed" / "deploy" / "worlds" / "demo.toml");
    EXPECT_EQ(found.viewer, folder_ / "installed" / "deploy" / "viewer.toml");
    EXPECT_EQ(found.deploy / "sites", folder_ / "installed" / "deploy" / "sites");
    DemoConfig own;
    own.world = "own.toml";
    EXPECT_EQ(completed(own).world, "own.toml");
    fs::create_directories(folder_ / "here" / "deploy");
    EXPECT_EQ(completed({}).deploy, "deploy") << "the repository's files go first";
    fs::remove_all(folder_ / "installed" / "deploy");
    EXPECT_EQ(completed({}).viewer, "deploy/viewer.toml") << "not installed";
    fs::current_path(before);
}

TEST_F(DemoFolder, GivesTheViewerTheModelsOfTheWorld) {
    fs::create_directories(folder_ / "own");
    DemoConfig config;
    config.world = folder_ / "own" / "world.toml";
    config.viewer = folder_ / "viewer.toml";
    EXPECT_EQ(models_for_viewer(config), "") << "neither file is there";
    write(config.world, "");
    write(config.viewer, "");
    EXPECT_EQ(models_for_viewer(config), folder_ / "own");
    write(config.world, "[world]\nmodels = \"parts\"\n");
    EXPECT_EQ(models_for_viewer(config), folder_ / "own" / "parts");
    write(config.viewer, "[viewer]\nmodels = \"mine\"\n");
    EXPECT_EQ(models_for_viewer(config), "") << "the viewer's file says more";
}

TEST(DemoLogs, FindsDoubtsAboutFiles) {
    const auto warning = [](const std::string& text) { return log_line("warning", text); };
    EXPECT_THAT(doubts(warning("object_looks_wrong name=b") + warning("late 3") +
                       warning("texture_missing t.png") + warning("object_looks_wrong name=b")),
                ElementsAre("texture_missing t.png", "object_looks_wrong name=b"));
    EXPECT_THAT(doubts(log_line("info", "model_missing m")), IsEmpty());
}

}  // namespace
}  // namespace atrium::demo
