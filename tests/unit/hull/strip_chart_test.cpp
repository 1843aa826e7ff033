#include "site_node/hull/strip_chart.hpp"

#include "core/base/executor.hpp"
#include "site_node/hull/outlines.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

// Compares StripChart with a test of every ray of every camera against every strip.
namespace atrium::hull {
namespace {

constexpr std::uint64_t kMaxSteps = 100'000'000;
constexpr double kClear = 1e-6;  // relative; nearer to a border, this test's doubles cannot decide

enum class Answer : std::uint8_t { kNo, kYes, kUnclear };

// The outlines of one camera as polygons at depth 1.
struct FlatView {
    Eigen::Vector3d centre;
    Eigen::Matrix3d camera_from_grid;
    std::vector<std::vector<Eigen::Vector2d>> loops;
};

std::vector<FlatView> flatten(const Cones& cones) {
    std::vector<FlatView> out;
    for (const Cones::View& view : cones.views)
        out.push_back({view.centre, view.camera_from_grid, {}});
    for (const Cones::Chain& chain : cones.chains) {
        FlatView& view = out[cones.strips[chain.first_strip].view];
        auto& loop = view.loops.emplace_back();
        for (std::uint32_t s = chain.first_strip; s < chain.last_strip; ++s) {
            const Eigen::Vector3d ray = view.camera_from_grid * cones.ray[cones.strips[s].from];
            loop.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
        }
    }
    return out;
}

double distance_to_segment(const Eigen::Vector2d& p,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
    const double along = (p - a).dot(b - a) / (b - a).squaredNorm();
    return (a + std::clamp(along, 0.0, 1.0) * (b - a) - p).norm();
}

Answer is_inside(const FlatView& view, const Eigen::Vector3d& p_grid) {
    const Eigen::Vector3d p = view.camera_from_grid * (p_grid - view.centre);
    if (p.z() < kClear) return p.z() < -kClear ? Answer::kNo : Answer::kUnclear;
    const Eigen::Vector2d flat(p.x() / p.z(), p.y() / p.z());
    bool inside = false;
    for (const auto& loop : view.loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (distance_to_segment(flat, loop[i], loop[(i + 1) % loop.size()]) < kClear)
                return Answer::kUnclear;
        }
        inside ^= contains(loop, flat);
    }
    return inside ? Answer::kYes : Answer::kNo;
}

// Whether a viewing edge ends where `ray` pierces `strip`.
Answer is_end_of_viewing_edge(const Cones& cones,
                              const std::vector<FlatView>& views,
                              std::uint32_t strip,
                              std::size_t ray_view,
                              std::uint32_t ray) {
    const Cones::Strip& own = cones.strips[strip];
    const Eigen::Vector3d& centre = cones.views[own.view].centre;
    // other centre + depth ray = own centre + (w_from first + w_to second), all positive
    Eigen::Matrix3d m;
    m << cones.ray[own.from], cones.ray[own.to], -cones.ray[ray];
    const Eigen::Vector3d w = m.partialPivLu().solve(cones.views[ray_view].centre - centre);
    if (!w.allFinite()) return Answer::kUnclear;
    const double scale = w.cwiseAbs().maxCoeff();
    if (w.minCoeff() < kClear * scale)
        return w.minCoeff() < -kClear * scale ? Answer::kNo : Answer::kUnclear;
    const Eigen::Vector3d p = cones.views[ray_view].centre + w.z() * cones.ray[ray];
    Answer answer = Answer::kYes;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (v == own.view || v == ray_view) continue;
        const Answer inside = is_inside(views[v], p);
        if (inside == Answer::kNo) return Answer::kNo;
        if (inside == Answer::kUnclear) answer = Answer::kUnclear;
    }
    return answer;
}

class StripChartOfScenes : public testing::TestWithParam<std::uint64_t> {};

TEST_P(StripChartOfScenes, KeepsEveryEndOfAViewingEdge) {
    test::SceneOptions scene = test::random_scene_options(GetParam());
    scene.segments_per_view = std::min(scene.segments_per_view, 60);
    scene.num_views = std::min(scene.num_views, 8);
    scene.cropped = false;
    HullScratch scratch;
    const VisualHull hull = compute_visual_hull(test::make_scene(scene, GetParam()), {}, scratch);
    ASSERT_EQ(hull.status, HullStatus::kOk);
    const Cones& cones = intersected_cones(scratch);
    SerialExecutor executor;
    Pencils pencils;
    ASSERT_TRUE(build_pencils(cones, executor, pencils));
    const std::vector<FlatView> views = flatten(cones);
    std::size_t num_ends = 0;
    std::size_t num_events = 0;
    StripChart chart;
    for (const Cones::Chain& chain : cones.chains) {
        for (std::uint32_t s = chain.first_strip; s < chain.last_strip; ++s) {
            if (s == chain.first_strip) {
                chart.start(cones, pencils, s, kMaxSteps);
            } else {
                chart.go_on(s);
            }
            ASSERT_TRUE(chart.collect());
            std::set<std::uint32_t> visible;
            if (chart.may_have_faces()) {
                for (const std::uint32_t e : chart.order()) visible.insert(chart.event(e).ray);
            }
            num_events += visible.size();
            for (std::size_t k = 0; k < cones.num_views(); ++k) {
                if (k == cones.strips[s].view) continue;
                for (std::uint32_t r = cones.views[k].first_ray; r < cones.views[k].last_ray; ++r) {
                    if (is_end_of_viewing_edge(cones, views, s, k, r) != Answer::kYes) continue;
                    ++num_ends;
                    EXPECT_TRUE(visible.contains(r)) << "ray " << r << ", strip " << s;
                }
            }
        }
    }
    EXPECT_GT(num_ends, 0u);
    EXPECT_GE(num_events, num_ends);
}

// Integer keys decide most of the order of a pencil's rays. Integers without rounding decide all of
// it.
TEST_P(StripChartOfScenes, ReadsPencilsInTheirExactOrder) {
    const test::SceneOptions scene = test::random_scene_options(GetParam());
    HullScratch scratch;
    const VisualHull hull = compute_visual_hull(test::make_scene(scene, GetParam()), {}, scratch);
    ASSERT_EQ(hull.status, HullStatus::kOk);
    Cones cones = intersected_cones(scratch);
    SerialExecutor executor;
    Pencils pencils;
    Pencils exact;
    ASSERT_TRUE(build_pencils(cones, executor, pencils));
    cones.only_exact = true;
    ASSERT_TRUE(build_pencils(cones, executor, exact));
    for (std::size_t i = 0; i < cones.num_views(); ++i) {
        for (std::size_t k = 0; k < cones.num_views(); ++k) {
            if (i == k) continue;
            const PencilSide& side = pencils.side(i, k);
            EXPECT_EQ(side.sorted, exact.side(i, k).sorted);
            EXPECT_EQ(side.rank, exact.side(i, k).rank);
            for (std::size_t at = 0; at < side.sorted.size(); ++at) {
                const std::uint32_t local = side.sorted[at];
                const std::uint32_t ray = cones.views[i].first_ray + local;
                EXPECT_EQ(side.position[local], at);
                EXPECT_EQ(side.in_order[at].local, local);
                EXPECT_EQ(side.in_order[at].across_y, side.across[local].y());
                EXPECT_EQ(side.in_order[at].z, cones.ray[ray].z());
                EXPECT_EQ(side.in_order[at].length, cones.ray_length[ray]);
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Seeds, StripChartOfScenes, testing::Range<std::uint64_t>(0, 40));

}  // namespace
}  // namespace atrium::hull
