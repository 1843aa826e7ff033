#include "core/app/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace atrium::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Options {
    double rate_hz = 30.0;
    bool loop = false;
    std::string name = "site";
    std::filesystem::path picture;
};

class ProgramStart : public testing::Test {
protected:
    Start start_with(std::vector<std::string> arguments, const ReadMore& read_more = {}) {
        arguments.insert(arguments.begin(), "program");
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        config::OptionSet set;
        set.add("rate_hz", options_.rate_hz, "pictures per second [Hz]", {1, 240});
        set.add("loop", options_.loop, "start again");
        set.add("name", options_.name, "of the site");
        set.add("picture", options_.picture, "to be written", "here.png");
        testing::internal::CaptureStdout();
        testing::internal::CaptureStderr();
        const Start start = app::start({.name = "program",
                                        .summary = "Does things.",
                                        .examples = "",
                                        .only_prints = [&] { return options_.loop; },
                                        .check = check_},
                                       set,
                                       static_cast<int>(argv.size()),
                                       argv.data(),
                                       read_more);
        output_ = testing::internal::GetCapturedStdout();
        errors_ = testing::internal::GetCapturedStderr();
        return start;
    }
    std::string file(const std::string& text) {
        const std::string path = testing::TempDir() + "atrium_program_test.toml";
        std::ofstream(path) << text;
        return path;
    }

    Options options_;
    std::function<Expected<void>()> check_;
    std::string output_;
    std::string errors_;
};

TEST_F(ProgramStart, ContinuesWithDefaults) {
    EXPECT_TRUE(start_with({}).go_on);
    EXPECT_EQ(options_.rate_hz, 30.0);
}

TEST_F(ProgramStart, LogsItsSettingsUnlessItOnlyPrints) {
    EXPECT_TRUE(start_with({"--name", "hall"}).go_on);
    EXPECT_THAT(output_ + errors_, HasSubstr("name = hall"));
    EXPECT_TRUE(start_with({"--name", "hall", "--loop", "true"}).go_on);
    EXPECT_EQ(output_ + errors_, "");
}

TEST_F(ProgramStart, HidesOptionsAndKeysOfAddresses) {
    start_with({"--name", "srt://studio:9000?mode=caller&passphrase=geheim", "--rate_hz", "7"});
    EXPECT_THAT(errors_, HasSubstr("name = srt://studio:9000?...\""));
    EXPECT_THAT(errors_, HasSubstr("rate_hz = 7"));
    EXPECT_THAT(errors_, testing::Not(HasSubstr("geheim")));
    start_with({"--name", "rtmp://live.example.org/app/geheim"});
    EXPECT_THAT(errors_, HasSubstr("name = rtmp://live.example.org/app/...\""));
    EXPECT_THAT(errors_, testing::Not(HasSubstr("geheim")));
}

TEST_F(ProgramStart, CommandLineOverridesTheFile) {
    const std::string config = file("rate_hz = 10\nname = \"file\"\n");
    EXPECT_TRUE(start_with({"--name", "line", "--config", config}).go_on);
    EXPECT_EQ(options_.rate_hz, 10.0);
    EXPECT_EQ(options_.name, "line");
}

TEST_F(ProgramStart, FlagWithoutValueIsTrueAndCanBeSetFalse) {
    EXPECT_TRUE(start_with({"--loop", "--name", "x"}).go_on);
    EXPECT_TRUE(options_.loop);
    EXPECT_TRUE(start_with({"--loop", "false"}).go_on);
    EXPECT_FALSE(options_.loop);
    EXPECT_EQ(start_with({"--loop", "maybe"}).exit_code, 2);
}

TEST_F(ProgramStart, OptionWithoutValueTakesItsImplicitValue) {
    EXPECT_TRUE(start_with({}).go_on);
    EXPECT_EQ(options_.picture, "");
    EXPECT_TRUE(start_with({"--picture", "--loop"}).go_on);
    EXPECT_EQ(options_.picture, "here.png");
    EXPECT_TRUE(start_with({"--picture", "there.png"}).go_on);
    EXPECT_EQ(options_.picture, "there.png");
    EXPECT_EQ(start_with({"--name"}).exit_code, 2);
}

TEST_F(ProgramStart, HelpListsEveryOptionWithUnitRangeAndDefault) {
    const Start start = start_with({"--help"});
    EXPECT_FALSE(start.go_on);
    EXPECT_EQ(start.exit_code, 0);
    EXPECT_THAT(output_, HasSubstr("--rate_hz (number in [1, 240]; default 30)"));
    EXPECT_THAT(output_, HasSubstr("pictures per second [Hz]"));
    EXPECT_THAT(output_, HasSubstr("Exit codes: 0 done, 1 failed while running, 2 "));
}

TEST_F(ProgramStart, ErrorsExitWithTheRightCode) {
    EXPECT_EQ(start_with({"--rate_hz", "0"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("--rate_hz: must be a number in [1, 240], got '0'"));
    EXPECT_EQ(start_with({"--config", "/nonexistent.toml"}).exit_code, 3);
    EXPECT_EQ(start_with({"--config", file("rat_hz = 3\n")}).exit_code, 2);
    EXPECT_EQ(start_with({"--log-level", "loud"}).exit_code, 2);
}

TEST_F(ProgramStart, UnknownOptionIsNamedWithASuggestion) {
    EXPECT_EQ(start_with({"--rat_hz", "3"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("unexpected: --rat_hz 3; did you mean --rate_hz?"));
    EXPECT_EQ(start_with({"--confg=x.toml"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("did you mean --config?"));
    EXPECT_EQ(start_with({"--elephant"}).exit_code, 2);
    EXPECT_THAT(errors_, AllOf(HasSubstr("--elephant"), Not(HasSubstr("did you mean"))));
    EXPECT_EQ(start_with({"file.toml"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("unexpected: file.toml;"));
}

TEST_F(ProgramStart, NamesWithDashesAndUnderscoresAreTheSame) {
    EXPECT_TRUE(start_with({"--rate-hz", "50", "--log_level=error"}).go_on);
    EXPECT_EQ(options_.rate_hz, 50.0);
    EXPECT_TRUE(start_with({"--rate-hz=60"}).go_on);
    EXPECT_EQ(options_.rate_hz, 60.0);
    // values keep theirs
    EXPECT_TRUE(start_with({"--name", "rate-hz"}).go_on);
    EXPECT_EQ(options_.name, "rate-hz");
}

TEST_F(ProgramStart, LooseAndMissingValuesAreExplained) {
    EXPECT_EQ(start_with({"file.toml"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("a file is given as --config file.toml"));
    EXPECT_EQ(start_with({"--rate_hz"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("--rate_hz: needs one value"));
    EXPECT_EQ(start_with({"--rate_hz", "1", "--rate_hz", "2"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("may be given once"));
    EXPECT_EQ(start_with({"-config", "x"}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("did you mean --config?"));
}

TEST_F(ProgramStart, NamesTheProgramOfAFileForAnother) {
    EXPECT_EQ(start_with({"--config", file("[capture]\nsource = \"cameras\"\n")}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("this looks like a file for site_node --config "));
    EXPECT_EQ(start_with({"--config", file("[[tile]]\nname = \"left\"\n")}).exit_code, 2);
    EXPECT_THAT(errors_, HasSubstr("this looks like a file for viewer --display.wall "));
    EXPECT_EQ(start_with({"--config", file("raet_hz = 3\n")}).exit_code, 2);
    EXPECT_THAT(errors_, Not(HasSubstr("this looks like")));
}

TEST_F(ProgramStart, LogsGivenValuesThatEqualTheirDefaults) {
    EXPECT_TRUE(start_with({"--name", "site", "--config", file("rate_hz = 30\n")}).go_on);
    EXPECT_THAT(errors_, AllOf(HasSubstr("name = site"), HasSubstr("rate_hz = 30")));
}

TEST_F(ProgramStart, ProgramCanReadMoreKeysOfItsFile) {
    int extra = 0;
    const auto more = [&](config::TableReader& reader) { reader.read("extra", extra, {0, 5}); };
    EXPECT_TRUE(start_with({"--config", file("extra = 3\n")}, more).go_on);
    EXPECT_EQ(extra, 3);
    EXPECT_EQ(start_with({"--config", file("extra = 9\n")}, more).exit_code, 2);
}

TEST_F(ProgramStart, EndsWithTheErrorOfItsCheck) {
    check_ = [&]() -> Expected<void> {
        if (options_.rate_hz < 100.0) return {};
        return make_error(ErrorKind::kConfiguration, "rate_hz: too fast");
    };
    EXPECT_TRUE(start_with({"--rate_hz", "99"}).go_on);
    const Start refused = start_with({"--rate_hz", "100"});
    EXPECT_FALSE(refused.go_on);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(errors_, "program: error: rate_hz: too fast\n");
}

}  // namespace
}  // namespace atrium::app
