#include "tools/calibrate/refine/refine.hpp"

#include "site_node/coherence/coherence.hpp"
#include "tests/support/people/masked_walk.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tools/calibrate/refine/check_rig.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::vector<geometry::CalibratedCamera> true_rig(int num_cameras = 8) {
    test::RingRigOptions options;
    options.focal_px = 800.0;
    options.num_cameras = num_cameras;
    return test::make_ring_rig(options);
}

std::vector<coherence::Sight> film(std::uint64_t seed,
                                   const std::vector<geometry::CalibratedCamera>& truth) {
    const test::WalkFilm walk(seed);
    std::vector<coherence::Sight> sights;
    for (std::size_t i = 0; i < walk.num_looks(); ++i) sights.push_back(walk.sight(i, {truth}));
    return sights;
}

geometry::CalibratedCamera off(test::Random& random,
                               const geometry::CalibratedCamera& camera,
                               double degrees,
                               double metres) {
    return test::bumped(camera,
                        degrees * std::numbers::pi / 180.0 * test::random_direction(random),
                        metres * test::random_direction(random));
}

struct Distance {
    double most_mm = 0.0, most_deg = 0.0;
};

Distance distance_of(const std::vector<geometry::CalibratedCamera>& cameras,
                     const std::vector<geometry::CalibratedCamera>& truth) {
    Distance most;
    for (std::size_t c = 0; c < truth.size(); ++c) {
        most.most_mm = std::max(
            most.most_mm, 1000.0 * (cameras[c].centre_site() - truth[c].centre_site()).norm());
        most.most_deg = std::max(most.most_deg,
                                 180.0 / std::numbers::pi *
                                     cameras[c].camera_from_site.rotation.angularDistance(
                                         truth[c].camera_from_site.rotation));
    }
    return most;
}

TEST(LaidOn, FindsTheSimilarity) {
    const auto truth = true_rig();
    auto other = truth;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()));
    for (auto& camera : other) {
        geometry::RigidTransform pose = camera.camera_from_site.inverse();
        pose.translation = 1.02 * (turn * pose.translation) + Eigen::Vector3d(0.1, 0.0, -0.05);
        pose.rotation = turn * pose.rotation;
        camera.camera_from_site = pose.inverse();
    }
    // one camera is elsewhere
    other[3] = test::bumped(other[3], Eigen::Vector3d(0, 0, 0.3), Eigen::Vector3d(0.4, 0, 0));
    auto laid = laid_on(other, truth);
    EXPECT_GT((laid[3].centre_site() - truth[3].centre_site()).norm(), 0.3);
    laid[3] = truth[3];
    const Distance distance = distance_of(laid, truth);
    EXPECT_LT(distance.most_mm, 0.2);
    EXPECT_LT(distance.most_deg, 0.01);
}

TEST(Refine, MendsAWholeRigThatIsOneDegreeAndThreeCentimetresOff) {
    for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 1 : 6); ++seed) {
        test::Random random(seed);
        const auto truth = true_rig();
        auto start = truth;
        for (auto& camera : start) camera = off(random, camera, 1.0, 0.03);
        const auto refined = refine(start, film(seed, truth), {});
        ASSERT_TRUE(refined) << refined.error().message;
        EXPECT_GT(refined->before.held_out, 3.0);
        EXPECT_LT(refined->after.held_out, 0.5) << seed;
        const Distance distance = distance_of(laid_on(refined->cameras, truth), truth);
        EXPECT_LT(distance.most_mm, 3.0) << seed;
        EXPECT_LT(distance.most_deg, 0.1) << seed;
        // the frame stays where most cameras say it is
        const Distance frame = distance_of(refined->cameras, truth);
        EXPECT_LT(frame.most_mm, 60.0) << seed;
        EXPECT_LT(refined->weakest_mm, 5.0);
        EXPECT_LT(refined->weakest_deg, 0.1);
    }
}

// Masks of whole pixels, and the outlines that a site makes of them.
TEST(Refine, MendsARigFromMasks) {
    test::Random random(1);
    const auto truth = true_rig();
    auto start = truth;
    for (auto& camera : start) camera = off(random, camera, 1.0, 0.03);
    const test::WalkingPeople people({.seed = 4});
    std::vector<coherence::Sight> sights;
    for (int i = 0; i < (test::kSanitized ? 20 : 50); ++i)
        sights.push_back(test::masked_sight(people, 0.5 * i, truth));
    const auto refined = refine(start, sights, {});
    ASSERT_TRUE(refined) << refined.error().message;
    EXPECT_LT(refined->after.held_out, 0.5);
    const Distance distance = distance_of(laid_on(refined->cameras, truth), truth);
    EXPECT_LT(distance.most_mm, 3.0);
    EXPECT_LT(distance.most_deg, 0.1);
    RecordProperty("most_um", static_cast<int>(1000.0 * distance.most_mm));
}

TEST(Refine, LeavesTheOtherCamerasIfOneMoved) {
    for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 1 : 4); ++seed) {
        test::Random random(seed);
        const auto truth = true_rig();
        auto start = truth;
        start[5] = off(random, truth[5], 1.0, 0.03);
        const auto sights = film(seed, truth);
        for (const bool is_alone : {true, false}) {
            RefineOptions options;
            if (is_alone) options.cameras = {5};
            const auto refined = refine(start, sights, options);
            ASSERT_TRUE(refined) << refined.error().message;
            const Distance distance = distance_of(refined->cameras, truth);
            EXPECT_LT(distance.most_mm, is_alone ? 1.5 : 3.0) << seed;
            EXPECT_LT(distance.most_deg, 0.05) << seed;
        }
    }
}

TEST(Refine, SaysThatAPersonWhoStandsDoesNotDetermineTheCameras) {
    const auto truth = true_rig();
    const test::WalkFilm walk(1);
    std::vector<coherence::Sight> sights;
    for (std::size_t i = 0; i < 20; ++i) sights.push_back(walk.sight(7, {truth}));
    const auto refined = refine(truth, sights, {});
    ASSERT_TRUE(refined) << refined.error().message;
    EXPECT_GT(refined->weakest_mm, 20.0);
}

// One instant holds twenty cameras so weakly that other poses fit the errors of its outlines.
TEST(Refine, LeavesATrueRigWhereItIsIfThereIsOneInstant) {
    const auto truth = true_rig(20);
    for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 6); ++seed) {
        const test::WalkFilm walk(seed);
        test::Filming filming{truth};
        filming.noise_px = 1.5;
        const auto refined = refine(truth, std::vector{walk.sight(9, filming)}, {});
        ASSERT_TRUE(refined) << refined.error().message;
        const Distance distance = distance_of(refined->cameras, truth);
        EXPECT_LT(distance.most_deg, 0.3) << seed;
        EXPECT_LT(distance.most_mm, 8.0) << seed;
        EXPECT_GT(refined->weakest_mm, 20.0) << "it is known to be uncertain";
    }
}

TEST(Refine, FindsFocalLengths) {
    const auto truth = true_rig();
    auto start = truth;
    for (std::size_t c = 0; c < start.size(); ++c)
        start[c].intrinsics.fx = start[c].intrinsics.fy = 800.0 * (c % 2 == 0 ? 1.01 : 0.99);
    // outlines are undistorted pixels: without distortion they do not depend on the focal length
    RefineOptions options;
    options.has_free_focal = true;
    const auto refined = refine(start, film(2, truth), options);
    ASSERT_TRUE(refined) << refined.error().message;
    double mean = 0.0;
    for (const auto& camera : refined->cameras) mean += camera.intrinsics.fx / 8.0;
    for (const auto& camera : refined->cameras)
        EXPECT_NEAR(camera.intrinsics.fx / mean, 1.0, 0.003);
    EXPECT_LT(refined->after.held_out, 0.5);
}

// Sights without silhouettes of the hull: only what the tangents say counts here.
RigCheck check_of(const std::vector<geometry::CalibratedCamera>& cameras,
                  std::vector<coherence::Sight> sights) {
    config::Rig rig;
    rig.cameras = cameras;
    Take take;
    take.views.resize(sights.size());
    take.sights = std::move(sights);
    take.rate_hz = 30.0;
    RigCheck check;
    check_silhouettes(rig, take, "rig.toml", "walk", check);
    return check;
}

TEST(CheckSilhouettes, NamesALensThatAllCamerasHaveInsteadOfTheirs) {
    const auto truth = true_rig();
    auto zoomed = truth;
    for (auto& camera : zoomed) camera.intrinsics.fx = camera.intrinsics.fy = 800.0 / 1.1;
    EXPECT_THAT(check_of(zoomed, film(2, truth)).problems,
                Contains(AllOf(HasSubstr("with lenses 1.10 times as long as the rig says"),
                               HasSubstr("`calibrate refine rig.toml --focal --recording walk"))));
    const RigCheck good = check_of(truth, film(2, truth));
    EXPECT_THAT(good.problems, Not(Contains(HasSubstr("lenses"))));
    EXPECT_THAT(good.checks, IsEmpty());
}

// Refined poses would hide that.
TEST(CheckSilhouettes, NamesSwappedCamerasAlone) {
    config::Rig rig;
    rig.cameras = true_rig();
    Take take;
    take.sights = film(2, rig.cameras);
    for (coherence::Sight& sight : take.sights) {
        std::swap(sight.now[1], sight.now[4]);
        auto& views = take.views.emplace_back();
        for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
            const geometry::CalibratedCamera& camera = rig.cameras[c];
            const hull::SilhouetteView view{
                camera.intrinsics, camera.camera_from_site, {sight.now[c].points}, {}};
            views.push_back({camera.name, view});
        }
    }
    RigCheck check;
    check_silhouettes(rig, take, "rig.toml", "walk", check);
    EXPECT_THAT(check.problems, ElementsAre(HasSubstr("cam1 and cam4 look swapped")));
    EXPECT_THAT(check.checks, IsEmpty());
}

// Every camera began a little later than the one before: 0 to 0.35 s.
TEST(CheckSilhouettes, AsksWhetherAllVideosBeginAtOneInstant) {
    const auto truth = true_rig();
    const test::WalkingPeople people({.seed = 4});
    std::vector<coherence::Sight> sights;
    for (int i = 0; i < 26; ++i) {
        sights.push_back(test::masked_sight(people, 0.5 * i, truth));
        for (std::size_t c = 1; c < truth.size(); ++c) {
            const double late_s = 0.05 * static_cast<double>(c * 3 % truth.size());
            sights.back().now[c] = test::masked_sight(people, 0.5 * i + late_s, truth).now[c];
        }
    }
    const RigCheck check = check_of(truth, sights);
    std::vector<std::string> said = check.problems;
    said.insert(said.end(), check.checks.begin(), check.checks.end());
    EXPECT_THAT(said, Contains(HasSubstr("do all videos begin at the same instant?")));
}

TEST(Refine, NamesACameraThatSeesNobody) {
    const auto truth = true_rig();
    auto sights = film(1, truth);
    for (auto& sight : sights) sight.now[2].points.clear();
    const auto refined = refine(truth, sights, {});
    ASSERT_FALSE(refined);
    EXPECT_NE(refined.error().message.find("camera 'cam2' sees too little"), std::string::npos);
}

}  // namespace
}  // namespace atrium::calibrate
