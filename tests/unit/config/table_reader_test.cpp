#include "core/config/table_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace atrium::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TableReader reader_of(const std::string& text) {
    auto reader = TableReader::parse(text, "room.toml");
    if (!reader) throw std::runtime_error(reader.error().message);
    return *reader;
}

TEST(TableReader, ReadsValuesAndKeepsDefaultsOfAbsentKeys) {
    TableReader reader =
        reader_of("rate = 25\n[hull]\nthreads = 2\nname = \"x\"\nsize = [1, 2.5, 3]\n");
    double rate = 30;
    int threads = 1;
    std::string name = "default";
    bool loop = true;
    double size[3] = {};
    reader.read("rate", rate, {1, 100});
    reader.read("hull.threads", threads, {1, 64});
    reader.read("hull.name", name);
    reader.read("hull.size", size, 3);
    reader.read("loop", loop);
    ASSERT_TRUE(reader.finish()) << reader.finish().error().message;
    EXPECT_EQ(rate, 25);
    EXPECT_EQ(threads, 2);
    EXPECT_EQ(name, "x");
    EXPECT_EQ(size[1], 2.5);
    EXPECT_TRUE(loop);
}

TEST(TableReader, ReadsListsOfStrings) {
    TableReader reader = reader_of("cameras = [\"north\", \"south\"]\n[a]\nnone = []\n");
    std::vector<std::string> cameras{"default"};
    std::vector<std::string> none{"default"};
    std::vector<std::string> absent{"default"};
    reader.read("cameras", cameras);
    reader.read("a.none", none);
    reader.read("a.absent", absent);
    ASSERT_TRUE(reader.finish()) << reader.finish().error().message;
    EXPECT_THAT(cameras, testing::ElementsAre("north", "south"));
    EXPECT_TRUE(none.empty());
    EXPECT_THAT(absent, testing::ElementsAre("default"));
    for (const char* wrong : {"cameras = \"north\"\n", "cameras = [1]\n"}) {
        TableReader other = reader_of(wrong);
        other.read("cameras", cameras);
        ASSERT_FALSE(other.finish());
        EXPECT_THAT(other.finish().error().message,
                    AllOf(HasSubstr("room.toml:1: cameras"), HasSubstr("array of strings")));
    }
}

TEST(TableReader, NamesFileLineAndKeyOfAnUnknownKey) {
    TableReader reader = reader_of("rate = 25\n[hull]\nthreads = 2\ntreads = 3\n");
    double rate = 0;
    int threads = 0;
    reader.read("rate", rate);
    reader.read("hull.threads", threads);
    const auto finished = reader.finish();
    ASSERT_FALSE(finished);
    EXPECT_EQ(finished.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(finished.error().message,
                AllOf(HasSubstr("room.toml:4"), HasSubstr("hull.treads"), HasSubstr("threads")));
}

TEST(TableReader, ReportsAnUnknownKeySimilarToAMissingOneAsATypo) {
    TableReader reader = reader_of("[hull]\nnr = 1\ntreads = 3\n");
    reader.table("hull").require("threads");
    EXPECT_THAT(reader.finish().error().message,
                AllOf(HasSubstr("room.toml:3"), HasSubstr("hull.treads: unknown key")));
    // a similar key that is known is no typo, whenever the code reads it
    TableReader joint = reader_of("[joint]\nb = 1\nmax_m = 2\n");
    joint.require("joint.a");
    joint.require("joint.min_m");
    double value = 0;
    joint.read("joint.b", value);
    joint.read("joint.max_m", value);
    EXPECT_THAT(joint.finish().error().message, HasSubstr("joint.a: is missing"));
    TableReader other = reader_of("[hull]\nstrands = 3\n");
    other.require("hull.threads");
    EXPECT_THAT(other.finish().error().message, HasSubstr("hull.threads: is missing"));
}

TEST(TableReader, KnowsKeysThatWereOnlyQueried) {
    TableReader reader = reader_of("[hull]\nbound = 1\n");
    EXPECT_FALSE(reader.has("hull.bounds"));
    EXPECT_THAT(reader.finish().error().message, HasSubstr("known here: bounds"));
}

TEST(TableReader, NamesAnUnknownTable) {
    TableReader reader = reader_of("[hul]\nthreads = 2\n");
    int threads = 1;
    reader.read("hull.threads", threads);
    const auto finished = reader.finish();
    ASSERT_FALSE(finished);
    EXPECT_THAT(finished.error().message, HasSubstr("hul: unknown key"));
}

TEST(TableReader, NamesAMisspeltTableBeforeWhatItsContentIsMissingFor) {
    TableReader reader = reader_of("[[objects]]\nname = \"door\"\n[[joint]]\na = \"door\"\n");
    EXPECT_TRUE(reader.tables("object").empty());
    reader.tables("joint").front().reject("a", "must be the name of an object");
    EXPECT_THAT(reader.finish().error().message,
                AllOf(HasSubstr("objects: unknown key"), HasSubstr("did you mean object?")));
    // an unknown table that resembles none explains nothing
    TableReader other = reader_of("[elephant]\nname = 1\n[[joint]]\na = \"door\"\n");
    other.tables("joint").front().reject("a", "must be the name of an object");
    EXPECT_THAT(other.finish().error().message, HasSubstr("joint[0].a: must be the name"));
}

TEST(TableReader, TakesAnyErrorThatCallsAKeyMissingForAHintAtATypo) {
    TableReader reader = reader_of("[box]\nmass_g = 2000\n");
    reader.reject("box.mass_kg", "is missing: set it, or a material");
    EXPECT_THAT(reader.finish().error().message,
                AllOf(HasSubstr("box.mass_g: unknown key"), HasSubstr("did you mean mass_kg")));
}

TEST(TableReader, NamesAFileThatMayBeMeant) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / "table_reader_meant";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "lab.toml") << "a = 1\n";
    EXPECT_THAT(TableReader::load(folder / "labb.toml").error().message,
                HasSubstr("No such file or directory; did you mean " + folder.string()));
    std::filesystem::remove_all(folder);
}

TEST(TableReader, NamesAllowedValuesForAWrongTypeOrRange) {
    TableReader wrong_type = reader_of("a = 1\nrate = \"fast\"\n");
    double rate = 30;
    wrong_type.read("rate", rate, {1, 100});
    EXPECT_THAT(wrong_type.finish().error().message,
                AllOf(HasSubstr("room.toml:2"),
                      HasSubstr("rate"),
                      HasSubstr("number in [1, 100]"),
                      HasSubstr("fast")));
    EXPECT_EQ(rate, 30);
    TableReader out_of_range = reader_of("rate = 0\n");
    out_of_range.read("rate", rate, {1, 100});
    EXPECT_FALSE(out_of_range.finish());
    TableReader not_finite = reader_of("rate = nan\n");
    not_finite.read("rate", rate);
    EXPECT_FALSE(not_finite.finish());
    TableReader choice = reader_of("mode = \"quick\"\n");
    std::string mode = "slow";
    choice.read("mode", mode, {"slow", "fast"});
    EXPECT_THAT(choice.finish().error().message, HasSubstr("one of slow, fast"));
}

TEST(TableReader, ShowsAListAsItIsWritten) {
    TableReader reader = reader_of("limits = [\n  0,\n  -100.5,\n]\n");
    std::array<double, 2> limits{};
    reader.read("limits", limits.data(), 2, {0, 100});
    EXPECT_THAT(reader.finish().error().message, testing::EndsWith(", got [0, -100.5]"));
    TableReader words = reader_of("pins = [\"upper\"]\n");
    words.reject("pins", "must be top");
    EXPECT_THAT(words.finish().error().message, testing::EndsWith(", got [\"upper\"]"));
}

TEST(TableReader, ShowsANumberWithAsManyDigitsAsItNeeds) {
    TableReader reader = reader_of("limits = [9.81, 1e300, 2.0]\n");
    std::array<double, 3> limits{};
    reader.read("limits", limits.data(), 3, {0, 1});
    EXPECT_THAT(reader.finish().error().message, testing::EndsWith(", got [9.81, 1e+300, 2.0]"));
}

TEST(TableReader, ForbidsAKeyWithAdvice) {
    TableReader reader = reader_of("[box]\nname = \"b\"\nfixed = true\n");
    TableReader box = reader.table("box");
    box.forbid("static", "mass = 0");
    box.forbid("fixed", "mass = 0");
    box.require("mass");
    EXPECT_EQ(reader.finish().error().message, "room.toml:3: box.fixed: unknown key; mass = 0");
}

TEST(TableReader, NamesAKeyThatLacksTheUnitOfAMissingOne) {
    TableReader reader = reader_of("[box]\nmass = 2\n");
    reader.table("box").require("mass_kg");
    EXPECT_THAT(reader.finish().error().message,
                HasSubstr("box.mass: unknown key; did you mean mass_kg, which is missing?"));
}

TEST(TableReader, ReadsArraysOfTablesAndNamesTheElement) {
    TableReader reader = reader_of("[[object]]\nmass = 1\n[[object]]\nmass = -2\n");
    const auto objects = reader.tables("object");
    ASSERT_EQ(objects.size(), 2u);
    for (TableReader object : objects) {
        double mass = 0;
        object.read("mass", mass, {0, 100});
    }
    EXPECT_THAT(reader.finish().error().message,
                AllOf(HasSubstr("room.toml:4"), HasSubstr("object[1].mass")));
}

TEST(TableReader, ReportsMissingFilesFoldersAndBrokenToml) {
    const auto missing = TableReader::load("/nonexistent/x.toml");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(missing.error().message, HasSubstr("/nonexistent/x.toml"));
    EXPECT_FALSE(TableReader::load("/tmp"));
    const auto broken = TableReader::parse("a = 1\nb = = 2\n", "room.toml");
    ASSERT_FALSE(broken);
    EXPECT_THAT(broken.error().message, HasSubstr("room.toml:2"));
}

TEST(TableReader, SaysHowToWriteANumberThatLacksDigits) {
    const auto error = [](const std::string& text) {
        return TableReader::parse(text, "room.toml").error().message;
    };
    EXPECT_THAT(error("a = 1\nb = .3\n"), AllOf(HasSubstr("room.toml:2"), HasSubstr("write 0.3")));
    EXPECT_THAT(error("b = -.25\n"), HasSubstr("write 0.25"));
    EXPECT_THAT(error("b = 3.\n"), HasSubstr("write 3.0"));
    EXPECT_THAT(error("b = [1, 0.5, .3]\n"), HasSubstr("write 0.3"));
    EXPECT_THAT(error("b = [\n  1.5,\n  .3]\n"), HasSubstr("write 0.3"));
    EXPECT_THAT(error("b = \"a .3\" x # .3\n"), Not(HasSubstr("write 0.3")));
}

TEST(TableReader, SaysThatAKeyIsWrittenTwiceAndNotHowToWriteValues) {
    const auto reader = TableReader::parse("a = 0.5\na = 0.6\n", "room.toml");
    ASSERT_FALSE(reader);
    EXPECT_THAT(reader.error().message,
                AllOf(HasSubstr("room.toml:2"),
                      HasSubstr("write each key once in its table"),
                      Not(HasSubstr("quotes"))));
}

TEST(TableReader, ShowsALineThatIsNotTomlAndSaysHowToWriteIt) {
    const auto error_of = [](const std::string& text) {
        const auto reader = TableReader::parse(text, "room.toml");
        return reader ? std::string() : reader.error().message;
    };
    EXPECT_THAT(error_of("[hull]\nthreads = two\n"),
                AllOf(HasSubstr("room.toml:2"), HasSubstr("'threads = two'"), HasSubstr("quotes")));
    EXPECT_THAT(error_of("[hull\nthreads = 2\n"),
                AllOf(HasSubstr("room.toml:1"), HasSubstr("a table is written [name]")));
    EXPECT_THAT(error_of("threads: 2\n"), HasSubstr("a value is written key = value"));
    EXPECT_THAT(error_of("model = \"models\\seat.obj\"\n"), HasSubstr("write / in paths"));
    EXPECT_THAT(error_of("name = \xE2\x80\x9Cseat\xE2\x80\x9D\n"),
                HasSubstr("straight double quotes"));
    EXPECT_THAT(error_of("[hull]\rthreads = 2\r"), HasSubstr("carriage return alone"));
    EXPECT_THAT(error_of(std::string("\xFF\xFE[\0h\0", 6)), HasSubstr("not a text file in UTF-8"));
    for (const char* text : {"a = 1\n# Gr\xFC\xDF"
                             "e\n",
                             "a = 1\n# \xC3",
                             "a = 1\nb = \"\xE2\x82\"\n",
                             // longer than needed, surrogates, beyond Unicode
                             "a = 1\nb = '''\xC0\x80'''\n",
                             "a = 1\nb = '''\xE0\x80\x80'''\n",
                             "a = 1\nb = '''\xED\xA0\x80'''\n",
                             "a = 1\nb = '''\xF0\x80\x80\x80'''\n",
                             "a = 1\nb = '''\xF4\x90\x80\x80'''\n",
                             "a = 1\nb = '''\xF5\x80\x80\x80'''\n"})
        EXPECT_THAT(error_of(text), HasSubstr(":2: a letter is not in UTF-8"));
    EXPECT_THAT(error_of("# Gr\u00FC\u00DFe \u20AC \uD7FF \uE000 \U0001F600 \U0010FFFF\n"),
                Not(HasSubstr("UTF-8")));
    EXPECT_LT(error_of("threads = \"" + std::string(1000, 'x')).size(), 300u);
}

TEST(TableReader, PassesOverWhatAnotherProgramReads) {
    const std::string text = "[capture]\nsource = 3\nrate = 2\n[hull]\nany = 1\n[[thing]]\nx = 1\n";
    auto reader = TableReader::parse(text, "site.toml");
    ASSERT_TRUE(reader);
    TableReader capture = reader->table("capture");
    double rate = 0.0;
    capture.read("rate", rate);
    reader->pass_over_others();
    const auto unknown = reader->finish();
    ASSERT_FALSE(unknown) << "unknown keys of tables that were read stay errors";
    EXPECT_THAT(unknown.error().message, HasSubstr("site.toml:2: capture.source: unknown key"));
    double source = 0.0;
    capture.read("source", source);
    EXPECT_TRUE(reader->finish());
}

}  // namespace
}  // namespace atrium::config
