#include "site_node/region_work.hpp"

#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/shapes/silhouette_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::site_node {
namespace {

using bus::RegionOutcome;
using testing::HasSubstr;

constexpr std::uint64_t kSettings = 7;

// A ball on either side; this host computes two of three regions.
class RegionWorkTest : public testing::Test {
protected:
    RegionWorkTest() {
        HullStageOptions options;
        options.min_component_l = 30.0;  // nobody is where cones past both bodies meet
        options.regions = {{"left", {{-2, -0.6, 0.2}, {-1, 0.6, 1.6}}, {"cam0", "cam2", "cam4"}},
                           {"middle", {{-0.4, -0.6, 0.2}, {0.4, 0.6, 1.6}}, {}, true},
                           {"right", {{1, -0.6, 0.2}, {2, 0.6, 1.6}}, {}}};
        auto stage = HullStage::create(rig_, options, 0.75);
        EXPECT_TRUE(stage) << stage.error().message;
        work_.emplace(
            rig_, std::move(*stage), codec::MeshCodecOptions{.position_bits = 0}, kSettings);
    }
    bus::RegionOrder order_of(const std::vector<double>& places, std::uint32_t num_cameras = 8) {
        bus::RegionOrder order;
        order.settings = kSettings;
        for (std::uint32_t camera = 0; camera < num_cameras; ++camera) {
            order.cameras.push_back(camera);
            order.contour_counts.push_back(static_cast<std::uint32_t>(places.size()));
            for (const double x : places) {
                const auto contour = atrium::test::outline_of(
                    atrium::test::Sphere{{x, 0.0, 0.9}, 0.3}, rig_[camera], 30);
                order.contour_sizes.push_back(static_cast<std::uint32_t>(contour.size()));
                for (const Eigen::Vector2d& vertex : contour)
                    order.vertices_px.push_back({vertex.x(), vertex.y()});
            }
        }
        return order;
    }

    std::vector<geometry::CalibratedCamera> rig_ =
        atrium::test::make_ring_rig({.num_cameras = 8, .first_angle_rad = 0.4});
    std::optional<RegionWork> work_;
    SerialExecutor executor_;
    bus::RegionMeshes answer_;
};

TEST_F(RegionWorkTest, AnswersWithTheMeshesOfItsRegions) {
    EXPECT_EQ(work_->num_regions(), 2u);
    ASSERT_TRUE(work_->compute(order_of({-1.5, 1.5}), executor_, answer_));
    ASSERT_EQ(answer_.regions.size(), 2u);
    EXPECT_EQ(answer_.regions[0].region, 0u);
    EXPECT_EQ(answer_.regions[1].region, 2u);
    EXPECT_EQ(answer_.reason, "");
    std::span<const std::uint8_t> left(answer_.draco);
    for (const auto& hull : answer_.regions) {
        EXPECT_EQ(hull.outcome, RegionOutcome::kMesh);
        const auto mesh = atrium::test::decode_mesh(left.first(hull.num_bytes));
        ASSERT_TRUE(mesh);
        const geometry::Aabb box = geometry::bounds(*mesh);
        EXPECT_NEAR(0.5 * (box.min.x() + box.max.x()), hull.region == 0 ? -1.5 : 1.5, 0.2);
        left = left.subspan(hull.num_bytes);
    }
    EXPECT_TRUE(left.empty());
}

TEST_F(RegionWorkTest, ARegionMayBeEmpty) {
    ASSERT_TRUE(work_->compute(order_of({1.5}), executor_, answer_));
    EXPECT_EQ(answer_.regions[0], (bus::RegionHull{0, RegionOutcome::kNobody, 0}));
    EXPECT_EQ(answer_.regions[1].outcome, RegionOutcome::kMesh);
    ASSERT_TRUE(work_->compute(order_of({}), executor_, answer_));
    EXPECT_TRUE(answer_.draco.empty());
    EXPECT_EQ(answer_.reason, "");
}

TEST_F(RegionWorkTest, ARegionWithTooFewCamerasFailsAloneAndSaysWhy) {
    bus::RegionOrder order = order_of({-1.5, 1.5}, 2);  // cam0 and cam1: one of the three
    ASSERT_TRUE(work_->compute(order, executor_, answer_));
    EXPECT_EQ(answer_.regions[0], (bus::RegionHull{0, RegionOutcome::kFailed, 0}));
    EXPECT_EQ(answer_.regions[1].outcome, RegionOutcome::kMesh);
    EXPECT_EQ(answer_.left_out.num_regions_failed, 1u);
    EXPECT_THAT(answer_.reason, HasSubstr("left: "));
    // and nothing is left of it later
    ASSERT_TRUE(work_->compute(order_of({-1.5, 1.5}), executor_, answer_));
    EXPECT_EQ(answer_.regions[0].outcome, RegionOutcome::kMesh);
    EXPECT_EQ(answer_.left_out.num_regions_failed, 0u);
    EXPECT_EQ(answer_.reason, "");
}

TEST_F(RegionWorkTest, FailsForOtherSettings) {
    bus::RegionOrder order = order_of({-1.5, 1.5});
    ++order.settings;
    ASSERT_TRUE(work_->compute(order, executor_, answer_));
    EXPECT_EQ(answer_.left_out.num_regions_failed, 2u);
    EXPECT_TRUE(answer_.draco.empty());
    for (const auto& hull : answer_.regions) EXPECT_EQ(hull.outcome, RegionOutcome::kOtherRig);
    EXPECT_THAT(answer_.reason, HasSubstr("its rig or [hull] differs"));
}

TEST_F(RegionWorkTest, RefusesTheOrderOfAnotherRig) {
    bus::RegionOrder order = order_of({1.5});
    order.cameras.back() = 8;
    const auto done = work_->compute(order, executor_, answer_);
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().message, HasSubstr("use one rig on all hosts"));
}

}  // namespace
}  // namespace atrium::site_node
