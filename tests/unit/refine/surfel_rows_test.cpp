#include "site_node/refine/surfel_rows.hpp"

#include "tests/support/random.hpp"
#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace atrium::refine {
namespace {

using image::RowCode;

constexpr std::uint32_t kNum = 203;
constexpr float kNear_m = 0.05F;
constexpr float kMost_m = 0.2F;

// Random surfels in a cube of 20 cm, and runs of them.
class Rows : public testing::Test {
protected:
    void make() {
        rows_.positions_site.resize(kNum + SurfelRows::kMargin);
        rows_.normals.resize(kNum + SurfelRows::kMargin);
        for (std::uint32_t i = 0; i < kNum; ++i) {
            image::set(rows_.positions_site, i, test::random_in_cube(random_, 0.1).cast<float>());
            image::set(rows_.normals, i, test::random_direction(random_).cast<float>());
        }
        runs_.clear();
        for (std::uint32_t at = 0; at < kNum;) {
            const auto begin = at + static_cast<std::uint32_t>(test::between(random_, 0, 9));
            const auto end = begin + static_cast<std::uint32_t>(test::between(random_, 1, 25));
            if (end > kNum) break;
            runs_.push_back({begin, end});
            at = end;
        }
        line_.from_site = test::random_in_cube(random_, 0.1).cast<float>();
        line_.normal = test::random_direction(random_).cast<float>();
        line_.radius_m = 0.03F;
    }
    Eigen::Vector3f position(std::uint32_t i) const {
        return {rows_.positions_site.x[i], rows_.positions_site.y[i], rows_.positions_site.z[i]};
    }
    Eigen::Vector3f normal(std::uint32_t i) const {
        return {rows_.normals.x[i], rows_.normals.y[i], rows_.normals.z[i]};
    }

    test::Random random_{7};
    SurfelRows rows_;
    std::vector<SurfelRun> runs_;
    InwardLine line_;
};

TEST_F(Rows, FindExactlyWhatIsNear) {
    for (int trial = 0; trial < 200; ++trial) {
        make();
        std::vector<NearSurfel> found;
        find_near(rows_, runs_, line_.from_site, kNear_m, found, RowCode::kBaseline);
        std::size_t num = 0;
        for (const SurfelRun& run : runs_) {
            for (std::uint32_t i = run.begin; i < run.end; ++i) {
                const float distance = (position(i) - line_.from_site).norm();
                if (std::abs(distance - kNear_m) < 1e-6F) continue;
                const auto there = std::ranges::find(found, i, &NearSurfel::surfel);
                ASSERT_EQ(there != found.end(), distance < kNear_m) << i;
                if (there == found.end()) continue;
                ++num;
                EXPECT_NEAR(there->distance_sq, distance * distance, 1e-6F);
            }
        }
        EXPECT_LE(num, found.size());
        EXPECT_TRUE(std::ranges::is_sorted(found, {}, &NearSurfel::surfel));
    }
}

TEST_F(Rows, FindTheFirstOppositeSurface) {
    int num_found = 0;
    for (int trial = 0; trial < 300; ++trial) {
        make();
        float nearest = kMost_m;
        bool is_clear = true;  // nothing on an edge of what counts
        for (const SurfelRun& run : runs_) {
            for (std::uint32_t i = run.begin; i < run.end; ++i) {
                const Eigen::Vector3f to = line_.from_site - position(i);
                const float inwards = to.dot(line_.normal);
                const float aside = (to - inwards * line_.normal).norm();
                const float cosine = normal(i).dot(line_.normal);
                is_clear = is_clear && std::abs(aside - line_.radius_m) > 1e-6F &&
                           std::abs(cosine + 0.2F) > 1e-6F && std::abs(inwards) > 1e-6F;
                if (cosine < -0.2F && aside < line_.radius_m && inwards > 0.0F)
                    nearest = std::min(nearest, inwards);
            }
        }
        if (!is_clear) continue;
        const float found = distance_to_opposite(rows_, runs_, line_, kMost_m, RowCode::kBaseline);
        EXPECT_NEAR(found, nearest, 1e-6F) << trial;
        if (found < kMost_m) ++num_found;
    }
    EXPECT_GT(num_found, 50);
}

TEST_F(Rows, AreTheSameForAllInstructionSets) {
    if (image::best_row_code() != RowCode::kAvx2) GTEST_SKIP() << test::skip::kNoAvx2;
    for (int trial = 0; trial < 300; ++trial) {
        make();
        std::vector<NearSurfel> baseline, fast;
        find_near(rows_, runs_, line_.from_site, kNear_m, baseline, RowCode::kBaseline);
        find_near(rows_, runs_, line_.from_site, kNear_m, fast, RowCode::kAvx2);
        ASSERT_EQ(baseline.size(), fast.size());
        for (std::size_t i = 0; i < baseline.size(); ++i) {
            ASSERT_EQ(baseline[i].surfel, fast[i].surfel);
            ASSERT_EQ(baseline[i].distance_sq, fast[i].distance_sq);
        }
        ASSERT_EQ(distance_to_opposite(rows_, runs_, line_, kMost_m, RowCode::kBaseline),
                  distance_to_opposite(rows_, runs_, line_, kMost_m, RowCode::kAvx2));
    }
}

}  // namespace
}  // namespace atrium::refine
