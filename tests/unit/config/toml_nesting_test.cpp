#include "core/config/toml_nesting.hpp"

#include "core/config/table_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace atrium::config {
namespace {

std::string times(std::size_t count, const std::string& text) {
    std::string all;
    for (std::size_t i = 0; i < count; ++i) all += text;
    return all;
}

TEST(TomlNesting, CountsListsTablesAndPartsOfKeys) {
    constexpr std::size_t kMost = kMaxTomlNesting;
    EXPECT_EQ(line_nested_too_deeply("a = " + times(kMost, "[") + times(kMost, "]")), 0U);
    EXPECT_EQ(line_nested_too_deeply("\na = " + times(kMost + 1, "[")), 2U);
    EXPECT_EQ(line_nested_too_deeply("a = " + times(kMost + 1, "{b=")), 1U);
    EXPECT_EQ(line_nested_too_deeply("a = 1\n\n" + times(kMost + 1, "[\n")), 3U + kMost);
    EXPECT_EQ(line_nested_too_deeply(times(kMost, "a.") + "b = 1"), 0U);
    EXPECT_EQ(line_nested_too_deeply(times(kMost + 1, "a.") + "b = 1"), 1U);
    EXPECT_EQ(line_nested_too_deeply(times(kMost + 1, "\"a\" . ") + "b = 1"), 1U);
    EXPECT_EQ(line_nested_too_deeply("[" + times(kMost, "a.") + "b]"), 1U);
    EXPECT_EQ(line_nested_too_deeply("a = [" + times(1000, "[1.5, 2.5],\n") + "]"), 0U);
}

TEST(TomlNesting, IgnoresStringsAndComments) {
    const std::string many = times(100, "[");
    for (const std::string& text : {"\"" + many + "\"",
                                    "'" + many + "'",
                                    "'\\' # " + many,
                                    "\"\\\"" + many + "\"",
                                    "\"\"\"\"\n" + many + "\n\"\"\"\"\"",
                                    "'''\n''" + many + "\n'''",
                                    "\"\" # " + many}) {
        EXPECT_EQ(line_nested_too_deeply("a = " + text), 0U) << text;
        const auto num_lines = std::count(text.begin(), text.end(), '\n');
        EXPECT_EQ(line_nested_too_deeply("a = " + text + "\nb = " + many),
                  2U + static_cast<std::size_t>(num_lines))
            << text;
    }
}

TEST(TomlNesting, IgnoresClosingBracketsInsideStringsAndComments) {
    for (const std::string closed : {"[\"]\",", "[']',", "[\"\"\"]\"\"\"\"\",", "[#]\n", "{\"}\"="})
        EXPECT_NE(line_nested_too_deeply("a = " + times(100, closed)), 0U) << closed;
    EXPECT_NE(line_nested_too_deeply("]]]]" + times(100, "[")), 0U);
}

// without this limit the parser would overflow the stack
TEST(TomlNesting, ExcessIsRefusedWithFileAndLine) {
    const auto reader = TableReader::parse("b = 1\na = " + times(100'000, "["), "room.toml");
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().kind, ErrorKind::kConfiguration);
    EXPECT_EQ(reader.error().message, "room.toml:2: more than 32 levels deep");
}

}  // namespace
}  // namespace atrium::config
