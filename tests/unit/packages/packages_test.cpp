#include "tests/support/run_program.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace atrium {
namespace {

namespace fs = std::filesystem;
using test_support::Outcome;
using test_support::run_program;
using testing::AnyOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kLimit_s = 60;

std::string read(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<fs::path> files(const fs::path& folder, const std::string& extension) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == extension) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
}

// The names in "-o,--output FILE ...", if they are names of options.
std::vector<std::string> option_names(const std::string& head) {
    std::vector<std::string> names;
    std::istringstream list(head.substr(0, head.find(' ')));
    for (std::string name; std::getline(list, name, ',');)
        if (name.starts_with("-")) names.push_back(name);
    return names;
}

std::multiset<std::string> options_of_help(const std::string& help) {
    std::multiset<std::string> options;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("  -")) continue;
        for (const std::string& name : option_names(line.substr(2))) options.insert(name);
    }
    return options;
}

std::vector<std::string> subcommands_of_help(const std::string& help) {
    std::vector<std::string> names;
    std::istringstream lines(help);
    bool is_list = false;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("  ")) is_list = line == "Subcommands:";
        if (is_list && line.starts_with("  ") && line[2] != ' ')
            names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
    return names;
}

// Of a page's source: "\fB\-o\fR, \fB\-\-output\fR FILE" after .TP.
std::multiset<std::string> options_of_page(const std::string& page) {
    std::multiset<std::string> options;
    std::istringstream lines(page);
    std::string before;
    for (std::string line; std::getline(lines, line); before = line) {
        if (before != ".TP") continue;
        static const std::regex kName(R"(\\fB((?:\\-|[^\\])+)\\fR)");
        for (std::sregex_iterator at(line.begin(), line.end(), kName), end; at != end; ++at) {
            const std::string name = std::regex_replace((*at)[1].str(), std::regex(R"(\\-)"), "-");
            if (name.starts_with("-")) options.insert(name);
        }
    }
    return options;
}

std::string help_of(const std::string& words) {
    const Outcome outcome = run_program(ATRIUM_BIN_DIR "/" + words + " --help", kLimit_s);
    EXPECT_EQ(outcome.exit_code, 0) << words << ": " << outcome.output;
    return outcome.output;
}

// What bash offers for the last of `words` with the completion in `file`.
std::set<std::string> completed(const fs::path& file, const std::string& words) {
    const Outcome outcome = run_program(
        "bash -c '. " + file.string() + "; COMP_WORDS=(" + words +
            "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); "
            "f=$(complete -p \"${COMP_WORDS[0]}\" | sed \"s/.*-F \\([^ ]*\\).*/\\1/\"); "
            "\"$f\"; printf \"%s\\n\" \"${COMPREPLY[@]}\"'",
        kLimit_s);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    std::set<std::string> found;
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);)
        if (!line.empty()) found.insert(line);
    return found;
}

class Manual : public testing::TestWithParam<std::string> {
protected:
    static fs::path file(const std::string& extension) {
        return fs::path(ATRIUM_MANUALS_DIR) / (GetParam() + extension);
    }
};

TEST_P(Manual, HasExactlyTheOptionsOfHelp) {
    const std::string help = help_of(GetParam());
    std::multiset<std::string> expected = options_of_help(help);
    for (const std::string& name : subcommands_of_help(help))
        expected.merge(options_of_help(help_of(GetParam() + " " + name)));
    const std::string page = read(file(".1"));
    EXPECT_THAT(expected, Contains("--help"));
    EXPECT_EQ(options_of_page(page), expected);
    EXPECT_THAT(page, AnyOf(HasSubstr(".SH EXIT STATUS"), HasSubstr("\nExit codes:")));
    EXPECT_THAT(page, Not(HasSubstr(test::source_dir()))) << "where it was built is no default";
    EXPECT_THAT(page, HasSubstr(".SH SYNOPSIS\n.B atrium")) << "as it is installed";
}

TEST_P(Manual, CompletesExactlyTheOptionsOfHelp) {
    if (GetParam() == "atrium") return;  // CompletesNamesOfCommandsAndTheirOptions
    const std::string help = help_of(GetParam());
    const auto as_set = [](const std::multiset<std::string>& all) {
        return std::set<std::string>(all.begin(), all.end());
    };
    const fs::path script = file(".bash");
    EXPECT_EQ(completed(script, GetParam() + " -"), as_set(options_of_help(help)));
    for (const std::string& name : subcommands_of_help(help)) {
        EXPECT_EQ(completed(script, GetParam() + " " + name + " -"),
                  as_set(options_of_help(help_of(GetParam() + " " + name))))
            << name;
    }
}

std::vector<std::string> names_of_pages() {
    std::vector<std::string> names;
    for (const fs::path& page : files(ATRIUM_MANUALS_DIR, ".1")) names.push_back(page.stem());
    return names;
}

INSTANTIATE_TEST_SUITE_P(Pages,
                         Manual,
                         testing::ValuesIn(names_of_pages()),
                         [](const testing::TestParamInfo<std::string>& page) {
                             std::string name = page.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(Manuals, EveryCommandHasAPage) {
    for (const auto& entry : fs::directory_iterator(ATRIUM_BIN_DIR)) {
        const std::string name = entry.path().filename();
        if (!name.starts_with("atrium-") || !entry.is_symlink()) continue;
        EXPECT_THAT(names_of_pages(), Contains(name));
    }
    EXPECT_THAT(names_of_pages(), Contains("atrium-site"));
}

TEST(Completion, CompletesNamesOfCommandsAndTheirOptions) {
    const std::string path = "PATH=" ATRIUM_BIN_DIR ":$PATH; . " ATRIUM_MANUALS_DIR;
    const fs::path front = test::source_dir() + "/deploy/packages/atrium.bash";
    const auto with_programs = [&](const std::string& words) {
        return completed(front.string() + "; " + path + "/atrium-monitor.bash", words);
    };
    EXPECT_EQ(with_programs("atrium mo"), std::set<std::string>{"monitor"});
    EXPECT_EQ(with_programs("atrium monitor --onc"), std::set<std::string>{"--once"});
    EXPECT_EQ(with_programs("atrium monitor --network l"),
              (std::set<std::string>{"lan", "loopback"}));
    EXPECT_THAT(with_programs("atrium no-such-command --x"), IsEmpty());
}

// Exposure as `systemd-analyze security` weighs it, 0 to 10: the limit is 4.
bool is_hardened(const fs::path& unit) {
    const Outcome outcome = run_program(
        "systemd-analyze security --offline=true --threshold=40 " + unit.string(), kLimit_s);
    EXPECT_THAT(outcome.output, HasSubstr("Overall exposure level")) << unit;
    return outcome.exit_code == 0;
}

TEST(Units, AreHardened) {
    if (run_program("systemd-analyze --version", kLimit_s).exit_code != 0)
        GTEST_SKIP() << test::skip::kNoSystemd << "systemd-analyze is not installed";
    const std::vector<fs::path> units = files(test::source_dir() + "/deploy/units", ".service");
    ASSERT_THAT(units, Not(IsEmpty()));
    for (const fs::path& unit : units) EXPECT_TRUE(is_hardened(unit)) << unit;
    const fs::path open = fs::path(testing::TempDir()) / "atrium-open.service";
    std::ofstream(open) << "[Service]\nExecStart=/bin/true\n";
    EXPECT_FALSE(is_hardened(open)) << "the limit finds a unit without a sandbox";
    fs::remove(open);
}

TEST(Units, RunAsTheirUserAndStayDownAfterAWrongConfiguration) {
    for (const fs::path& unit : files(test::source_dir() + "/deploy/units", ".service")) {
        const std::string text = read(unit);
        for (const char* line : {"\nUser=atrium\n",
                                 "\nRestartPreventExitStatus=2\n",
                                 "\nSlice=atrium.slice\n",
                                 "\nExecStart=/usr/lib/atrium/bin/"})
            EXPECT_THAT(text, HasSubstr(line)) << unit;
    }
}

// What debian/control needs for a build is what install_packages.sh installs.
TEST(Packages, NeedOnlyWhatTheScriptInstalls) {
    std::string control = read(test::source_dir() + "/debian/control");
    const std::string field = "Build-Depends:";
    const auto begin = control.find(field);
    ASSERT_NE(begin, std::string::npos);
    const auto end = control.find("\nStandards-Version", begin);
    std::istringstream needed(control.substr(begin + field.size(), end - begin - field.size()));
    const std::string script = read(test::source_dir() + "/deploy/install_packages.sh");
    int count = 0;
    for (std::string package; std::getline(needed, package, ',');) {
        std::istringstream words(package);
        words >> package;
        if (package == "debhelper-compat") package = "debhelper";
        EXPECT_TRUE(std::regex_search(script, std::regex("[ \"\n]" + package + "[ \"\n]")))
            << package;
        ++count;
    }
    EXPECT_GT(count, 10);
}

}  // namespace
}  // namespace atrium
