// Calibration from a swept wand, in simulated rooms with known cameras.
#include "swept_room.hpp"
#include "tests/support/sanitized.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"
#include "tools/calibrate/wand/label_lights.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace atrium::calibrate {
namespace {

using calibrate_test::centres_rms_m;
using calibrate_test::sweep;
using calibrate_test::SweepOptions;
using calibrate_test::SweptRoom;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Expected<WandSolution> solve(const Wand& wand, const SweptRoom& room) {
    WandOptions options;
    options.num_threads = 2;
    return solve_wand(wand, room.nominal, room.points, options);
}

std::vector<std::string> problems_of(const Wand& wand, const SweptRoom& room) {
    const auto solution = solve(wand, room);
    if (!solution) return {solution.error().message};
    return judge_wand(*solution, 30.0).problems;
}

class SweptWand : public testing::TestWithParam<std::uint32_t> {};

// 300 instants, noise of 0.2 px, 3 % outliers, 10 % reflections.
TEST_P(SweptWand, GivesTheCamerasWithoutAGuess) {
    SweepOptions options;
    options.seed = GetParam();
    const SweptRoom room = sweep(default_wand(), options);
    const auto solution = solve(default_wand(), room);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_LT(centres_rms_m(room, *solution), 0.002);
    EXPECT_LT(solution->held_out_px, options.noise_px + 0.05);
    EXPECT_GT(solution->rms_px, options.noise_px - 0.05) << "outliers must not be all that is left";
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        const BundleCamera& camera = solution->bundle.cameras[c];
        const geometry::PinholeCamera& truth = room.cameras[c].intrinsics;
        EXPECT_NEAR(camera.lens[0], truth.fx, 0.002 * truth.fx) << c;
        EXPECT_NEAR(camera.lens[1], truth.cx, 4.0) << c;
        EXPECT_NEAR(camera.lens[2], truth.cy, 4.0) << c;
        EXPECT_GT(solution->cameras[c].num_used, 1000U) << "also of wands with a missing light";
    }
    EXPECT_THAT(judge_wand(*solution, 30.0).problems, IsEmpty());
}
// Under sanitizers one room takes as long as ten.
INSTANTIATE_TEST_SUITE_P(Rooms, SweptWand, testing::Range(1U, test::kSanitized ? 2U : 4U));

TEST(SweptWands, MayHaveAnyNumberOfLights) {
    const Wand flat{{{0, 0, 0}, {0.4, 0, 0}, {0, 0.25, 0}, {0.1, 0.4, 0}, {0.25, 0.05, 0}}};
    const Wand three{{{0, 0, 0}, {0.15, 0, 0}, {0.5, 0, 0}}};
    SweepOptions options;
    options.num_cameras = 6;
    for (const Wand& wand : {flat, three}) {
        if (test::kSanitized && wand.size() > 3) continue;
        const SweptRoom room = sweep(wand, options);
        const auto solution = solve(wand, room);
        ASSERT_TRUE(solution) << solution.error().message;
        EXPECT_LT(centres_rms_m(room, *solution), 0.002) << wand.size();
    }
    const Wand one{{{0, 0, 0}}};
    const SweptRoom room = sweep(one, {});
    const auto solution = solve(one, room);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_LT(centres_rms_m(room, *solution, /*may_scale=*/true), 0.006);
}

TEST(SweptWands, TakeLabelsOfTheFile) {
    SweepOptions options;
    options.has_labels = true;
    const Wand pair{{{0, 0, 0}, {0.5, 0, 0}}};  // which no picture tells apart
    const SweptRoom room = sweep(pair, options);
    const auto solution = solve(pair, room);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_LT(centres_rms_m(room, *solution), 0.003);
    options.has_labels = false;
    EXPECT_THAT(problems_of(pair, sweep(pair, options)), ElementsAre(HasSubstr("look alike")));
}

TEST(SweptWands, NeedOnlyARoughFocalLength) {
    SweepOptions options;
    options.nominal_error = 0.35;
    options.num_cameras = 5;
    SweptRoom room = sweep(default_wand(), options);
    for (const bool is_told : {true, false}) {
        if (!is_told)
            for (NominalCamera& camera : room.nominal) camera.focal_px = 0.0;
        const auto solution = solve(default_wand(), room);
        ASSERT_TRUE(solution) << solution.error().message;
        EXPECT_LT(centres_rms_m(room, *solution), 0.002);
    }
}

TEST(SweptWands, NameACameraThatIsLate) {
    for (const double late : {1.0, -1.0}) {
        SweepOptions options;
        options.num_cameras = 5;
        options.num_instants = 200;
        options.late_instants = {0, 0, 0, late, 0};
        EXPECT_THAT(problems_of(default_wand(), sweep(default_wand(), options)),
                    ElementsAre(HasSubstr(late > 0.0 ? "camera 'cam3' is late by 1.0 instants"
                                                     : "camera 'cam3' is early by 1.0 instants")));
    }
}

TEST(SweptWands, NameAWandWhoseFileIsWrong) {
    const SweptRoom room = sweep(default_wand(), {});
    Wand wrong = default_wand();
    wrong.lights_m[1].x() += 0.02;
    EXPECT_THAT(problems_of(wrong, room),
                ElementsAre(HasSubstr("is --wand the file of this wand")));
    wrong = default_wand();
    wrong.lights_m[2].x() += 0.003;
    EXPECT_THAT(problems_of(wrong, room), testing::Contains(HasSubstr("measure the distances")));
    // nearly every fourth light of every camera is an outlier then, and no camera is to blame
    wrong.lights_m[2].x() += 0.002;
    const std::vector<std::string> problems = problems_of(wrong, room);
    ASSERT_FALSE(problems.empty());
    EXPECT_THAT(problems.front(), HasSubstr("light 2 of the wand is seen"));
    EXPECT_THAT(problems, testing::Not(testing::Contains(HasSubstr("contradicts"))));
}

TEST(SweptWands, NameCamerasThatAreNoneOfTheSweep) {
    SweptRoom room = sweep(default_wand(), {});
    SweepOptions other;
    other.seed = 9;
    room.points[5].points = sweep(default_wand(), other).points[5].points;
    EXPECT_THAT(problems_of(default_wand(), room), ElementsAre(HasSubstr("'cam5'")));
    room.points[5].points.clear();
    EXPECT_THAT(problems_of(default_wand(), room),
                ElementsAre(HasSubstr("no place found for 'cam5': the wand was not seen")));
    room.points[5].points = room.points[2].points;
    EXPECT_THAT(same_pictures(room.points), HasSubstr("'cam2' and 'cam5' have the same pictures"));
    room.points.resize(1);
    EXPECT_THAT(problems_of(default_wand(), room), ElementsAre(HasSubstr("no two cameras")));
}

// Pictures of the wand from anywhere, with points that are no lights.
TEST(LightLabeller, LabelsRightlyOrNotAtAll) {
    const auto labeller = LightLabeller::make(default_wand());
    ASSERT_TRUE(labeller);
    std::mt19937 rng(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    std::normal_distribution<double> noise(0.0, 0.2);
    int num_labelled = 0, num_pictures = 0;
    for (int i = 0; i < 3000; ++i) {
        const Eigen::Vector3d start(any(rng), any(rng), 3.0 + any(rng));
        const Eigen::Vector3d along = Eigen::Vector3d(any(rng), any(rng), any(rng)).normalized();
        std::vector<Eigen::Vector2d> points;
        for (const Eigen::Vector3d& light : default_wand().lights_m) {
            const Eigen::Vector3d p = start + along * light.x();
            points.emplace_back(1000.0 * p.x() / p.z() + noise(rng),
                                1000.0 * p.y() / p.z() + noise(rng));
        }
        if ((points.front() - points.back()).norm() < 40.0) continue;
        for (int k = 0; k < 3; ++k) points.emplace_back(500.0 * any(rng), 500.0 * any(rng));
        std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6};
        std::shuffle(order.begin(), order.end(), rng);
        std::vector<Eigen::Vector2d> shuffled;
        for (const std::size_t k : order) shuffled.push_back(points[k]);
        const auto labels = labeller->label(shuffled);
        ++num_pictures;
        if (!labels) continue;
        ++num_labelled;
        for (std::size_t light = 0; light < 4; ++light)
            EXPECT_EQ(order[(*labels)[light]], light) << i;
    }
    EXPECT_GT(num_labelled, num_pictures * 95 / 100);
}

TEST(LightLabeller, RefusesWandsThatLookTheSameFromBothEnds) {
    EXPECT_FALSE(LightLabeller::make({{{0, 0, 0}, {0.5, 0, 0}}}));
    EXPECT_FALSE(LightLabeller::make({{{0, 0, 0}, {0.25, 0, 0}, {0.5, 0, 0}}}));
    EXPECT_FALSE(LightLabeller::make({{{0, 0, 0}, {0.1, 0, 0}, {0.4, 0, 0}, {0.5, 0, 0}}}));
    EXPECT_FALSE(LightLabeller::make({{{0, 0, 0}, {0.4, 0, 0}, {0, 0.4, 0}, {0.4, 0.4, 0}}}));
    EXPECT_TRUE(LightLabeller::make({{{0, 0, 0}}}));
}

}  // namespace
}  // namespace atrium::calibrate
