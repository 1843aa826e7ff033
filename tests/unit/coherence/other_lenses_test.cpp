#include "site_node/coherence/other_lenses.hpp"

#include "site_node/coherence/coherence_watch.hpp"
#include "site_node/coherence/fault_text.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace atrium::coherence {
namespace {

using test::Filming;
using test::WalkFilm;

constexpr std::uint64_t kLensSeeds = test::kSanitized ? 1 : 2;

std::vector<geometry::CalibratedCamera> lens_rig() {
    test::RingRigOptions options;
    options.focal_px = 800.0;
    return test::make_ring_rig(options);
}

Filming filmed_with(double factor, double noise_px = 0.3) {
    Filming filming{lens_rig(), 0, 0, noise_px};
    for (geometry::CalibratedCamera& camera : filming.truth) {
        camera.intrinsics.fx *= factor;
        camera.intrinsics.fy *= factor;
    }
    return filming;
}

std::optional<OtherLenses> lenses_of(const WalkFilm& film, const Filming& filming) {
    std::vector<Sight> sights;
    for (std::size_t i = 0; i < film.num_looks(); ++i) sights.push_back(film.sight(i, filming));
    return find_other_lenses(lens_rig(), sights);
}

TEST(OtherLenses, AreNamedWithTheirFactor) {
    for (std::uint64_t seed = 1; seed <= kLensSeeds; ++seed) {
        // outlines as ragged as those of real pictures
        const double noise_px = seed % 2 == 0 ? 0.3 : 1.0;
        const WalkFilm film(seed, seed % 4 < 2 ? 1 : 2);
        for (const double factor : {0.75, 0.9, 1.05, 1.1, 1.25}) {
            const auto lenses = lenses_of(film, filmed_with(factor, noise_px));
            ASSERT_TRUE(lenses) << seed << ": " << factor;
            EXPECT_NEAR(lenses->factor, factor, 0.01) << seed;
            EXPECT_LT(lenses->after_px, noise_px);
            EXPECT_GT(lenses->before_px, lenses->after_px);
        }
    }
}

// True rigs, and what else makes silhouettes contradict a rig.
TEST(OtherLenses, AreNotNamedForOtherFaults) {
    using Camera = geometry::CalibratedCamera;
    const auto turn = [](Camera& camera, double degrees, test::Random& random) {
        camera = test::bumped(camera,
                              degrees * std::numbers::pi / 180.0 * test::random_direction(random),
                              Eigen::Vector3d::Zero());
    };
    const auto move = [](Camera& camera, double metres, test::Random& random) {
        camera =
            test::bumped(camera, Eigen::Vector3d::Zero(), metres * test::random_direction(random));
    };
    const std::vector<std::function<void(Filming&, test::Random&)>> faults{
        [](Filming&, test::Random&) {},
        [&](Filming& filming, test::Random& random) { turn(filming.truth[2], 1.0, random); },
        [&](Filming& filming, test::Random& random) { turn(filming.truth[3], 5.0, random); },
        [&](Filming& filming, test::Random& random) { move(filming.truth[2], 0.05, random); },
        [&](Filming& filming, test::Random& random) { move(filming.truth[5], 0.3, random); },
        [&](Filming& filming, test::Random& random) {
            for (Camera& camera : filming.truth) turn(camera, 0.4, random);
        },
        [&](Filming& filming, test::Random& random) {
            for (Camera& camera : filming.truth) move(camera, 0.03, random);
        },
        [](Filming& filming, test::Random&) { std::swap(filming.truth[1], filming.truth[4]); },
        [](Filming& filming, test::Random&) { filming.late_instants = 1; },
    };
    for (std::uint64_t seed = 1; seed <= kLensSeeds; ++seed) {
        const WalkFilm film(seed, seed % 4 < 2 ? 1 : 2);
        for (const double noise_px : {0.3, 3.0}) {
            for (std::size_t i = 0; i < faults.size(); ++i) {
                test::Random random(seed);
                Filming filming{lens_rig(), 0, 0, noise_px};
                faults[i](filming, random);
                EXPECT_FALSE(lenses_of(film, filming)) << seed << ": fault " << i;
            }
        }
    }
}

// One number fits two pairs of cameras in any case.
TEST(OtherLenses, NeedThreePairsOfCameras) {
    const WalkFilm film(1);
    for (const std::size_t num_cameras : {2, 3}) {
        auto cameras = lens_rig();
        Filming filming = filmed_with(1.1);
        cameras.resize(num_cameras);
        filming.truth.resize(num_cameras);
        std::vector<Sight> sights;
        for (std::size_t i = 0; i < film.num_looks(); ++i) sights.push_back(film.sight(i, filming));
        EXPECT_EQ(find_other_lenses(cameras, sights).has_value(), num_cameras == 3);
    }
}

TEST(OtherLenses, NeedSilhouettes) {
    EXPECT_FALSE(find_other_lenses(lens_rig(), {}));
    std::vector<Sight> sights(12);
    EXPECT_FALSE(find_other_lenses(lens_rig(), sights));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (Sight& sight : sights) {
        sight.now.resize(8);
        for (SilhouetteHull& hull : sight.now)
            hull = hull_of(std::vector<std::vector<Eigen::Vector2d>>{{{nan, 1.0}, {5.0, 5.0}}},
                           lens_rig()[0].intrinsics);
    }
    EXPECT_FALSE(find_other_lenses(lens_rig(), sights));
}

class LensesOfAWalk : public ::testing::Test {
protected:
    // Looks on for a time. Returns how often the lenses were told.
    std::size_t looks_on(std::size_t num_looks) {
        std::size_t num_told = 0;
        for (std::size_t i = 0; i < num_looks; ++i) {
            now_ += std::chrono::milliseconds(500);
            const auto judgement =
                watch_.look(film_.sight(num_looks_++ % film_.num_looks(), filming_), now_);
            if (!judgement) continue;
            last_ = judgement->report;
            num_told += judgement->is_told && last_.verdict == Verdict::kLenses ? 1 : 0;
            EXPECT_EQ(last_.lenses.has_value(), last_.verdict == Verdict::kLenses);
            EXPECT_FALSE(judgement->is_told && last_.verdict != Verdict::kLenses);
            EXPECT_FALSE(judgement->recovered) << "no camera is to blame";
        }
        return num_told;
    }

    WalkFilm film_{3};
    Filming filming_ = filmed_with(1.0);
    CoherenceWatch watch_{lens_rig()};
    CoherenceWatch::Clock::time_point now_{};
    std::size_t num_looks_ = 0;
    Report last_;
};

TEST_F(LensesOfAWalk, AreToldOnceUntilTheyAreTheRigsAgain) {
    EXPECT_EQ(looks_on(60), 0u);
    filming_ = filmed_with(1.07);
    EXPECT_EQ(looks_on(96), 1u);
    ASSERT_TRUE(last_.lenses);
    EXPECT_NEAR(last_.lenses->factor, 1.07, 0.01);
    EXPECT_EQ(lenses_text(last_.lenses->factor), "lenses 1.07 times as long as the rig says");
    EXPECT_EQ(looks_on(240), 0u) << "two more minutes";
    now_ += CoherenceWatch::kRepeat;
    EXPECT_EQ(looks_on(20), 1u);
    filming_ = filmed_with(1.0);
    EXPECT_EQ(looks_on(96), 0u);
    EXPECT_EQ(last_.verdict, Verdict::kCoherent);
}

TEST_F(LensesOfAWalk, AreToldInsteadOfARigThatNoCameraExplains) {
    filming_ = filmed_with(1.2);
    EXPECT_EQ(looks_on(96), 1u);
    EXPECT_GT(last_.rms_px, 3.0);
    EXPECT_EQ(last_.verdict, Verdict::kLenses);
}

TEST_F(LensesOfAWalk, AreToldAtTheEndOfAShortRun) {
    filming_ = filmed_with(1.1);
    EXPECT_EQ(looks_on(19), 0u);
    const CoherenceWatch::Judgement last = watch_.finish();
    EXPECT_TRUE(last.is_told);
    EXPECT_EQ(last.report.verdict, Verdict::kLenses);
    EXPECT_NEAR(last.report.lenses.value_or(OtherLenses{}).factor, 1.1, 0.01);
}

}  // namespace
}  // namespace atrium::coherence
