// Parts of the tool that need no views file.
#include "site_node/hull_tool/coverage.hpp"
#include "site_node/hull_tool/tool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace atrium::hull_tool {
namespace {

TEST(HullToolCommandLine, EndsWithUsageErrorsBeforeAnyWork) {
    const auto exit_code_of = [](std::vector<std::string> words) {
        words.insert(words.begin(), "visual_hull");
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        ToolOptions options;
        const Start start = parse_command_line(static_cast<int>(argv.size()), argv.data(), options);
        return start.go_on ? -1 : start.exit_code;
    };
    EXPECT_EQ(
        exit_code_of(
            {"views.json", "-o", "x.ply", "--threads", "2", "--repeat", "9", "--keep-phantoms"}),
        -1);
    EXPECT_EQ(exit_code_of({"--recording", "room", "--frame", "3"}), -1);
    EXPECT_EQ(exit_code_of({"views.json", "--decimate", "5", "--normals"}), -1);
    EXPECT_EQ(exit_code_of({"views.json", "--decimate", "0"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--decimate", "-2"}), 2);
    const std::string box = "-1,-1.5,0,1,1.5,2.25";
    EXPECT_EQ(exit_code_of({"--bounds", box, "views.json", "--partial", "--min-views", "3"}), -1);
    EXPECT_EQ(exit_code_of({"--without", "a", "views.json", "--without", "b"}), -1);
    EXPECT_EQ(exit_code_of({"views.json", "--min-litres", "0"}), -1);
    EXPECT_EQ(exit_code_of({"views.json", "--partial"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--min-views", "65"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--min-views", "-1"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--min-litres", "-1"}), 2);
    for (const char* option : {"--min-litres", "--decimate"}) {
        for (const char* wrong : {"nan", "-nan", "inf", "1e7", "x", ""})
            EXPECT_EQ(exit_code_of({"views.json", option, wrong}), 2) << option << " " << wrong;
    }
    EXPECT_EQ(exit_code_of({"views.json", "--without"}), 2);
    for (const std::string wrong : {"",
                                    "0,0,0,1,1",
                                    "0,0,0,1,1,1,1",
                                    "0 0 0 1 1 1",
                                    "0,0,0,1,1,0",
                                    "0,0,x,1,1,1",
                                    "0,0,0,1,1,1e9",
                                    "0,0,0,1,1,nan"}) {
        EXPECT_EQ(exit_code_of({"views.json", "--bounds", wrong}), 2) << wrong;
    }
    EXPECT_EQ(exit_code_of({"--help"}), 0);
    EXPECT_EQ(exit_code_of({"--version"}), 0);
    EXPECT_EQ(exit_code_of({}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--recording", "room"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--threads", "0"}), 2);
    EXPECT_EQ(exit_code_of({"views.json", "--frame", "3"}), 2);
    EXPECT_EQ(exit_code_of({"--colour"}), 2);
}

TEST(HullToolCommandLine, ReadsWhatDecidesTheHull) {
    std::vector<std::string> words{"visual_hull",
                                   "--without",
                                   "a",
                                   "views.json",
                                   "--without",
                                   "b",
                                   "--bounds",
                                   "-1,-1.5, 0,1,1.5,2.25",
                                   "--partial",
                                   "--min-views",
                                   "3",
                                   "--min-litres",
                                   "0.25"};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    ToolOptions options;
    ASSERT_TRUE(parse_command_line(static_cast<int>(argv.size()), argv.data(), options).go_on);
    EXPECT_EQ(options.views_file, "views.json");
    EXPECT_THAT(options.without, testing::ElementsAre("a", "b"));
    ASSERT_TRUE(options.bounds);
    EXPECT_EQ(options.bounds->min, Eigen::Vector3d(-1, -1.5, 0));
    EXPECT_EQ(options.bounds->max, Eigen::Vector3d(1, 1.5, 2.25));
    EXPECT_TRUE(options.partial);
    EXPECT_EQ(options.min_views, 3u);
    EXPECT_EQ(options.min_litres, 0.25);
}

// A square plate of 1 m, 8 m in front of a camera with 80 px per metre there.
TEST(Coverage, CountsPixelCentres) {
    geometry::TriangleMesh plate;
    plate.vertices = {{-0.5, -0.5, 8.0}, {0.5, -0.5, 8.0}, {0.5, 0.5, 8.0}, {-0.5, 0.5, 8.0}};
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    hull::SilhouetteView view;
    view.intrinsics = {
        200, 150, 640.0, 640.0, 100.5, 75.5};  // covers columns 61..140 and rows 36..115
    CoverageScratch scratch;
    view.contours = {{{60.5, 35.5}, {140.5, 35.5}, {140.5, 115.5}, {60.5, 115.5}}};
    Coverage exact = measure_coverage(plate, view, scratch);
    EXPECT_EQ(exact.silhouette_px, 6400u);
    EXPECT_EQ(exact.covered_px, 6400u);
    EXPECT_EQ(exact.excess_px, 0u);
    view.contours = {{{80.5, 35.5}, {160.5, 35.5}, {160.5, 115.5}, {80.5, 115.5}}};
    const Coverage shifted = measure_coverage(plate, view, scratch);
    EXPECT_EQ(shifted.covered_px, 4800u);
    EXPECT_EQ(shifted.excess_px, 1600u);
    view.field = {{100.5, 35.5}, {190.5, 35.5}, {190.5, 95.5}, {100.5, 95.5}};
    const Coverage seen = measure_coverage(plate, view, scratch);
    EXPECT_EQ(seen.silhouette_px, 3600u);
    EXPECT_EQ(seen.covered_px, 2400u);
    EXPECT_EQ(seen.excess_px, 0u);
}

}  // namespace
}  // namespace atrium::hull_tool
