#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tools/visual_hull/tool.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

// Real people: silhouettes with segmentation noise, imperfect calibration and distorted lenses.
namespace atrium::hull_tool {
namespace {

struct Recording {
    const char* name;
    int frame;
    double min_litres;
    double max_litres;
    double mean_coverage;   // minimum
    double worst_coverage;  // minimum
};

class RealPeople : public testing::TestWithParam<Recording> {};

TEST_P(RealPeople, HaveTheVolumeAndCoverTheirSilhouettes) {
    const Recording& expected = GetParam();
    ToolOptions options;
    options.recording =
        std::filesystem::path(atrium::test::source_dir() + "/../shared/data/recordings") /
        expected.name;
    options.frame = expected.frame;
    options.no_bounds = true;  // people reach a little beyond those of horseman
    if (!std::filesystem::exists(options.recording))
        GTEST_SKIP() << atrium::test::skip::kNoSharedData << options.recording;
    const auto text = run(options);
    ASSERT_TRUE(text) << text.error().message;
    const auto report = nlohmann::json::parse(*text);
    EXPECT_TRUE(report.at("closed").get<bool>());
    EXPECT_TRUE(report.at("manifold").get<bool>());
    const double litres = 1e3 * report.at("volume_m3").get<double>();
    EXPECT_GE(litres, expected.min_litres);
    EXPECT_LE(litres, expected.max_litres);
    double sum = 0.0;
    for (const auto& view : report.at("views")) {
        const double coverage = view.at("coverage");
        EXPECT_GE(coverage, expected.worst_coverage) << view.at("name");
        EXPECT_EQ(view.at("excess_px").get<int>(), 0) << view.at("name");
        sum += coverage;
    }
    EXPECT_GE(sum / static_cast<double>(report.at("views").size()), expected.mean_coverage);
}

// ring20: a voxel carve gives 73 to 74 litres. dancer: 99 litres. horseman is segmented with its
// learned background. One of its four views shows a board that is not in the empty room, so the
// hull cannot cover that view completely.
INSTANTIATE_TEST_SUITE_P(Recordings,
                         RealPeople,
                         testing::Values(Recording{"ring20", 0, 60, 80, 0.94, 0.90},
                                         Recording{"dancer", 0, 94, 104, 0.95, 0.90},
                                         Recording{"horseman", 100, 150, 260, 0.94, 0.88}),
                         [](const auto& recording) { return std::string(recording.param.name); });

}  // namespace
}  // namespace atrium::hull_tool
