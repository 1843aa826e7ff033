#include "core/config/option_set.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace atrium::config {
namespace {

using testing::HasSubstr;

struct Options {
    double rate_hz = 30.0;
    int threads = 1;
    bool loop = false;
    std::string mode = "live";
    std::filesystem::path file = "a.toml";
};

OptionSet declare(Options& o) {
    OptionSet set;
    set.add("capture.rate_hz", o.rate_hz, "pictures per second [Hz]", {1, 240});
    set.add("hull.threads", o.threads, "worker threads", {1, 64});
    set.add("capture.loop", o.loop, "start again at the end");
    set.add("capture.mode", o.mode, "where pictures come from", {"live", "recording"});
    set.add("capture.file", o.file, "description");
    return set;
}

TEST(OptionSet, CommandLineOverridesTheFile) {
    Options options;
    const OptionSet set = declare(options);
    auto reader =
        TableReader::parse("[capture]\nrate_hz = 25\nloop = true\nmode = \"recording\"\n", "f");
    ASSERT_TRUE(reader);
    set.read_file(*reader);
    ASSERT_TRUE(reader->finish()) << reader->finish().error().message;
    ASSERT_TRUE(set.set("capture.rate_hz", "50", "--capture.rate_hz"));
    EXPECT_EQ(options.rate_hz, 50);
    EXPECT_TRUE(options.loop);
    EXPECT_EQ(options.mode, "recording");
    EXPECT_EQ(options.threads, 1);
}

TEST(OptionSet, RefusesBadTypeOrRangeAndKeepsTheValue) {
    Options options;
    const OptionSet set = declare(options);
    for (const char* text : {"fast", "0", "nan", "1e9", "", "3 4", "3\nx=1"}) {
        const auto result = set.set("capture.rate_hz", text, "--capture.rate_hz");
        ASSERT_FALSE(result) << text;
        EXPECT_THAT(result.error().message,
                    HasSubstr("--capture.rate_hz: must be a number in [1, 240]"));
    }
    EXPECT_FALSE(set.set("hull.threads", "1.5", "x"));
    EXPECT_FALSE(set.set("capture.mode", "dead", "x"));
    EXPECT_FALSE(set.set("nonsense", "1", "x"));
    EXPECT_EQ(options.rate_hz, 30);
}

TEST(OptionSet, KeepsQuotesAndBackslashes) {
    Options options;
    const OptionSet set = declare(options);
    ASSERT_TRUE(set.set("capture.file", "/a \"b\"\\c", "x"));
    EXPECT_EQ(options.file, "/a \"b\"\\c");
}

TEST(OptionSet, KeepsWordsAndResolvesPathsFromTheFolderOfTheFile) {
    std::string network = "near";
    OptionSet set;
    set.add_word_or_path("bus.network", network, "where", {"near", "far"});
    set.add_alias("network");
    EXPECT_EQ(set.entries().back().alias, "network");
    const auto folder = std::filesystem::temp_directory_path() / "atrium_option_set";
    std::filesystem::create_directories(folder);
    const auto read = [&](const std::string& text) {
        std::ofstream(folder / "c.toml") << "[bus]\n" << text << "\n";
        auto reader = TableReader::load(folder / "c.toml");
        ASSERT_TRUE(reader);
        set.read_file(*reader);
        EXPECT_TRUE(reader->finish());
    };
    read("");
    EXPECT_EQ(network, "near");
    read("network = \"far\"");
    EXPECT_EQ(network, "far");
    read("network = \"nets/own.xml\"");
    EXPECT_EQ(network, (folder / "nets/own.xml").string());
    ASSERT_TRUE(set.set("bus.network", "own.xml", "--network"));
    EXPECT_EQ(network, "own.xml")
        << "a path on the command line is relative to the working directory";
    std::filesystem::remove_all(folder);
}

TEST(OptionSet, RefusesEmptyTextsWhereTheyAreMarked) {
    std::string keys = "before";
    OptionSet set;
    set.add_word_or_path("bus.keys", keys, "which", {"none"});
    set.refuse_empty("give a file");
    const auto given = set.set("bus.keys", "", "--bus.keys");
    ASSERT_FALSE(given);
    EXPECT_EQ(given.error().message, "--bus.keys: is empty: give a file");
    const auto read = [&](const std::string& text) {
        auto reader = TableReader::parse(text, "c.toml");
        set.read_file(*reader);
        const auto finished = reader->finish();
        return finished ? std::string() : finished.error().message;
    };
    EXPECT_THAT(read("[bus]\nkeys = \"\""), HasSubstr("c.toml:2: bus.keys: is empty: give a file"));
    EXPECT_THAT(read("[bus]\nkeys = 5"), HasSubstr("must be a string"));
    EXPECT_EQ(read(""), "");
    EXPECT_EQ(keys, "before");
    EXPECT_EQ(read("[bus]\nkeys = \"none\""), "");
    EXPECT_EQ(keys, "none");
}

TEST(OptionSet, ListsTheEffectiveValues) {
    Options options;
    const OptionSet set = declare(options);
    options.threads = 3;
    EXPECT_THAT(set.effective(), HasSubstr("hull.threads = 3\n"));
    EXPECT_THAT(set.effective(), HasSubstr("capture.rate_hz = 30\n"));
}

TEST(OptionSet, ListsValuesThatDifferFromTheirDefaults) {
    Options options;
    OptionSet set = declare(options);
    std::string area = "none";
    set.show("hull.area", [&area] { return area; });
    EXPECT_EQ(set.changed(), "");
    options.threads = 3;
    area = "[0, 1]";
    EXPECT_EQ(set.changed(), "hull.threads = 3\nhull.area = [0, 1]\n");
}

}  // namespace
}  // namespace atrium::config
