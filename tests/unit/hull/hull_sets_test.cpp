#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tools/visual_hull/coverage.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::hull {
namespace {

const std::filesystem::path kFolder = atrium::test::source_dir() + "/../shared/data/hulls";

class HullSet : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kFolder / "expected.json"))
            GTEST_SKIP() << atrium::test::skip::kNoSharedData << kFolder;
        expected_ = nlohmann::json::parse(std::ifstream(kFolder / "expected.json")).at(GetParam());
        auto views = views::load_views_file(kFolder / (GetParam() + ".json"));
        ASSERT_TRUE(views) << views.error().message;
        for (const auto& view : *views) views_.push_back(view.view);
        HullOptions options;
        options.keep_phantoms = true;
        HullScratch scratch;
        hull_ = compute_visual_hull(views_, options, scratch);
        ASSERT_EQ(hull_.status, HullStatus::kOk) << to_string(hull_.status);
        report_ = geometry::inspect(hull_.mesh);
    }
    nlohmann::json expected_;
    std::vector<SilhouetteView> views_;
    VisualHull hull_;
    geometry::MeshReport report_;
};

TEST_P(HullSet, IsAClosedManifold) {
    EXPECT_TRUE(report_.closed);
    EXPECT_TRUE(report_.manifold);
}

TEST_P(HullSet, HasTheVolumeAndTopologyOfTheExactIntersection) {
    const bool is_degenerate = GetParam().find("degenerate") != std::string::npos;
    const double volume = expected_.at("volume_m3");
    // the jitter of degenerate sets may have to grow until all planes are in general position
    EXPECT_NEAR(report_.volume_m3, volume, volume * (is_degenerate ? 1e-6 : 1e-8));
    EXPECT_EQ(report_.num_components, expected_.at("components").get<std::size_t>());
    EXPECT_EQ(report_.euler_characteristic,
              expected_.at("euler_characteristic").get<std::int64_t>());
    if (!expected_.at("vertices").is_null()) {
        EXPECT_EQ(hull_.mesh.vertices.size(), expected_.at("vertices").get<std::size_t>());
    }
}

TEST_P(HullSet, ProjectsIntoEverySilhouetteAndFillsIt) {
    hull_tool::CoverageScratch scratch;
    for (const SilhouetteView& view : views_) {
        const hull_tool::Coverage coverage = hull_tool::measure_coverage(hull_.mesh, view, scratch);
        EXPECT_EQ(coverage.excess_px, 0u);
        EXPECT_GT(coverage.share(), 0.99);
    }
}

INSTANTIATE_TEST_SUITE_P(All,
                         HullSet,
                         testing::Values("person_1px",
                                         "person_10k",
                                         "person_24views",
                                         "sphere",
                                         "torus",
                                         "spheres",
                                         "cube_degenerate",
                                         "icosahedron_degenerate"),
                         [](const auto& set) { return set.param; });

}  // namespace
}  // namespace atrium::hull
