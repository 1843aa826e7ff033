#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"
#include "tools/export/formats/usd_writer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <stack>
#include <string>

namespace atrium::exporting {
namespace {

std::string usd_text(const std::filesystem::path& file) {
    const auto bytes = testing::bytes_of(file);
    return {bytes.begin(), bytes.end()};
}

// Brackets close in order, outside of texts in quotes.
bool is_balanced(const std::string& text) {
    std::stack<char> open;
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_quoted && c == '\\') {
            ++i;
        } else if (c == '"') {
            is_quoted = !is_quoted;
        } else if (!is_quoted && std::string("([{").find(c) != std::string::npos) {
            open.push(c);
        } else if (!is_quoted && std::string(")]}").find(c) != std::string::npos) {
            const char expected = c == ')' ? '(' : c == ']' ? '[' : '{';
            if (open.empty() || open.top() != expected) return false;
            open.pop();
        }
    }
    return open.empty() && !is_quoted;
}

// The text of an array property, between its brackets; `from` moves behind it.
std::string array_after(const std::string& text, const std::string& name, std::size_t& from) {
    const std::size_t at = text.find(name + " = [", from);
    EXPECT_NE(at, std::string::npos) << name;
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 4;
    from = text.find(']', begin);
    return text.substr(begin, from - begin);
}
std::size_t num_values(const std::string& list, char separator = ',') {
    return list.empty() ? 0 : static_cast<std::size_t>(std::ranges::count(list, separator)) + 1;
}

TEST(UsdWriter, WritesAPrimPerFrame) {
    const test::TemporaryFolder folder;
    ExportFacts facts = testing::facts();
    facts.site = "ball-1.x";  // no name of a prim
    auto writer = make_usd_writer({folder / "a.usda", 95, 0.05}, facts);
    const renderer::PersonModel model = testing::ball_model(8);
    for (std::size_t number : {1U, 2U}) {
        auto frame = writer->encode({model, {}, {}}, testing::frame_time(number));
        ASSERT_TRUE(frame) << frame.error().message;
        ASSERT_TRUE(writer->add(std::move(*frame)));
    }
    EXPECT_EQ(testing::names_in(folder / ""),
              (std::vector<std::string>{"a.usda.part", "a_textures"}))
        << "no half file under the final name";
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(testing::names_in(folder / "a_textures"),
              (std::vector<std::string>{"a_000001.jpg", "a_000002.jpg"}));
    const std::string text = usd_text(folder / "a.usda");
    EXPECT_TRUE(text.starts_with("#usda 1.0\n"));
    EXPECT_TRUE(is_balanced(text));
    for (const char* fact : {"upAxis = \"Z\"",
                             "metersPerUnit = 1\n",
                             "timeCodesPerSecond = 20\n",
                             "startTimeCode = 0\n",
                             "endTimeCode = 1.0000\n",
                             "defaultPrim = \"ball_1_x\"",
                             "string frame_of_reference = \"site ball\"",
                             "string source = \"a \\\"b\\\".mcap\"",
                             "@./a_textures/a_000001.jpg@"})
        EXPECT_NE(text.find(fact), std::string::npos) << fact;
    std::size_t at = text.find("\"frame_000002\"");
    ASSERT_NE(at, std::string::npos);
    const std::size_t num_triangles = model.triangles.size();
    EXPECT_EQ(num_values(array_after(text, "faceVertexCounts", at)), num_triangles);
    EXPECT_EQ(num_values(array_after(text, "faceVertexIndices", at)), 3 * num_triangles);
    EXPECT_EQ(num_values(array_after(text, "points", at), '('), model.vertices_site.size() + 1);
    const std::size_t num_uvs = num_values(array_after(text, "primvars:st", at), '(') - 1;
    const std::string uv_indices = array_after(text, "primvars:st:indices", at);
    EXPECT_EQ(num_values(uv_indices), 3 * num_triangles);
    std::size_t largest = 0;
    const std::regex number("[0-9]+");
    for (std::sregex_iterator it(uv_indices.begin(), uv_indices.end(), number), end; it != end;
         ++it)
        largest = std::max<std::size_t>(largest, std::stoul(it->str()));
    EXPECT_EQ(largest + 1, num_uvs);
    // paths of connections lead to prims of this file
    EXPECT_NE(text.find("</ball_1_x/frame_000002/material/picture.outputs:rgb>"),
              std::string::npos);
}

TEST(UsdWriter, ShowsEachFrameUntilTheNext) {
    const test::TemporaryFolder folder;
    auto writer = make_usd_writer({folder / "a.usda", 95, 0.1}, testing::facts());
    for (std::size_t number = 1; number <= 3; ++number) {
        // nobody is there in the second one
        auto frame =
            writer->encode({number == 2 ? renderer::PersonModel{} : testing::ball_model(6), {}, {}},
                           testing::frame_time(number));
        ASSERT_TRUE(frame);
        ASSERT_TRUE(writer->add(std::move(*frame)));
    }
    ASSERT_TRUE(writer->finish());
    const std::string text = usd_text(folder / "a.usda");
    EXPECT_NE(text.find("timeSamples = {\n            0.0000: \"inherited\",\n"
                        "            1.0000: \"invisible\",\n        }"),
              std::string::npos);
    EXPECT_NE(text.find("timeSamples = {\n            0: \"invisible\",\n"
                        "            2.0000: \"inherited\",\n        }"),
              std::string::npos);
    EXPECT_EQ(text.find("frame_000002"), std::string::npos);
}

TEST(UsdWriter, LeavesNoFileWithoutItsEnd) {
    const test::TemporaryFolder folder;
    auto writer = make_usd_writer({folder / "a.usda", 95, 0.1}, testing::facts());
    auto frame = writer->encode({testing::ball_model(6), {}, {}}, testing::frame_time(1));
    ASSERT_TRUE(frame);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(writer->add(*frame));
    EXPECT_EQ(testing::names_in(folder / "a_textures").size(), 1u);
    writer.reset();
    EXPECT_TRUE(testing::names_in(folder / "").empty());
}

}  // namespace
}  // namespace atrium::exporting
