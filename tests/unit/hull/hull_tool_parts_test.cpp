// Tests the parts of the tool that need no views file.
#include "tools/visual_hull/coverage.hpp"
#include "tools/visual_hull/limits.hpp"
#include "tools/visual_hull/tool.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace atrium::hull_tool {
namespace {

TEST(HullToolCommandLine, ReportsUsageErrorsBeforeAnyWork) {
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
    EXPECT_EQ(exit_code_of({"views.json", "-o", ""}), 2);
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

TEST(HullToolCommandLine, ReadsTheHullOptions) {
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

// A square plate of 1 m at 8 m from a camera, where 1 m is 80 px.
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

class Limits : public testing::Test {
protected:
    // Returns the tool's error, or "". Checks that the hull agrees with the tool.
    static std::string error_of(const std::vector<views::NamedView>& views,
                                bool has_bounds = false) {
        hull::HullOptions options;
        if (has_bounds) options.bounds = geometry::Aabb{{-1, -1, -1}, {1, 1, 1}};
        std::vector<hull::SilhouetteView> silhouettes;
        for (const views::NamedView& view : views) silhouettes.push_back(view.view);
        hull::HullScratch scratch;
        const hull::HullStatus status =
            hull::compute_visual_hull(silhouettes, options, scratch).status;
        const auto within = check_limits(views, has_bounds);
        EXPECT_EQ(
            within.has_value(),
            status != hull::HullStatus::kInvalidInput && status != hull::HullStatus::kTooComplex)
            << hull::to_string(status);
        return within ? "" : within.error().message;
    }

    // Contours that repeat one point. The hull counts the points, then sees nothing and returns
    // immediately.
    static std::vector<views::NamedView> views_of(std::size_t num_views, std::size_t num_points) {
        std::vector<views::NamedView> views(num_views);
        for (std::size_t i = 0; i < num_views; ++i) {
            views[i].name = "v" + std::to_string(i);
            views[i].view.intrinsics = {64, 48, 60.0, 60.0, 31.5, 23.5};
            views[i].view.camera_from_site.translation = {0.0, 0.0, 3.0 + static_cast<double>(i)};
            views[i].view.contours = {{num_points, Eigen::Vector2d(20.0, 20.0)}};
        }
        return views;
    }
};

TEST_F(Limits, OfViews) {
    EXPECT_EQ(error_of(views_of(64, 3)), "");
    EXPECT_EQ(error_of(views_of(65, 3)), "65 views; at most 64 are possible");
    EXPECT_EQ(error_of(views_of(62, 3), true), "");
    EXPECT_THAT(
        error_of(views_of(63, 3), true),
        testing::AllOf(testing::HasSubstr("63 views; at most 62"), testing::HasSubstr("--bounds")));
}

TEST_F(Limits, OfFocalLengths) {
    std::vector<views::NamedView> views = views_of(3, 3);
    views[1].view.intrinsics.fx = 1e-3;
    views[2].view.intrinsics.fy = 1e6;
    EXPECT_EQ(error_of(views), "");
    views[1].view.intrinsics.fx = 1e-5;
    EXPECT_EQ(error_of(views), "view \"v1\".fx: must be in [0.001, 1000000] px, got 1e-05");
    views = views_of(3, 3);
    views[2].view.intrinsics.fy = 1.1e6;
    EXPECT_THAT(error_of(views), testing::HasSubstr("view \"v2\".fy"));
}

TEST_F(Limits, OfPoints) {
    std::vector<views::NamedView> few = views_of(4, 50'000);
    EXPECT_EQ(error_of(few), "");
    few[2].view.contours[0].emplace_back(20.0, 20.0);
    EXPECT_THAT(error_of(few),
                testing::AllOf(testing::HasSubstr("200001 points"),
                               testing::HasSubstr("4 views may have at most 200000"),
                               testing::HasSubstr("\"v2\": 50001")));
    std::vector<views::NamedView> many = views_of(40, 2'500);
    EXPECT_EQ(error_of(many), "");
    many[39].view.contours[0].emplace_back(20.0, 20.0);
    EXPECT_THAT(error_of(many), testing::HasSubstr("40 views may have at most 100000"));
}

TEST_F(Limits, OfContoursAreExplainedAfterwards) {
    std::vector<views::NamedView> views = views_of(2, 3);
    EXPECT_THAT(explain_too_complex(views), testing::HasSubstr("steps"));
    views[1].view.contours.resize(2001);
    EXPECT_EQ(explain_too_complex(views),
              "; view \"v1\" has 2001 contours, at most 2000 are possible");
}

}  // namespace
}  // namespace atrium::hull_tool
