#include "site_node/coherence/coherence.hpp"

#include "site_node/coherence/coherence_watch.hpp"
#include "site_node/coherence/fault_text.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace atrium::coherence {
namespace {

using test::Filming;
using test::WalkFilm;

constexpr std::uint64_t kSeeds = test::kSanitized ? 1 : 20;
constexpr std::uint64_t kFewSeeds = test::kSanitized ? 1 : 8;

std::vector<geometry::CalibratedCamera> rig() {
    test::RingRigOptions options;
    options.focal_px = 800.0;
    return test::make_ring_rig(options);
}

Report judge(const WalkFilm& film, const Filming& filming) {
    Coherence coherence(rig());
    for (std::size_t i = 0; i < film.num_looks(); ++i) coherence.add(film.sight(i, filming));
    return coherence.judge();
}

Eigen::Vector3d turn_of(test::Random& random, double degrees) {
    return degrees * std::numbers::pi / 180.0 * test::random_direction(random);
}

TEST(Coherence, NamesACameraThatTurnedAFifthOfADegree) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        test::Random random(seed);
        const std::size_t camera = seed % 8;
        Filming filming{rig()};
        filming.truth[camera] =
            test::bumped(filming.truth[camera], turn_of(random, 0.2), Eigen::Vector3d::Zero());
        const Report report = judge(WalkFilm(seed), filming);
        ASSERT_EQ(report.verdict, Verdict::kMoved) << seed;
        EXPECT_EQ(report.fault->camera, camera) << seed;
        ASSERT_TRUE(report.fault->turned_deg) << seed;
        EXPECT_NEAR(*report.fault->turned_deg, 0.2, 0.02) << seed;
        EXPECT_FALSE(report.fault->moved_mm) << seed;
    }
}

TEST(Coherence, NamesACameraThatMovedTenMillimetres) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        test::Random random(seed);
        const std::size_t camera = seed % 8;
        Filming filming{rig()};
        filming.truth[camera] = test::bumped(
            filming.truth[camera], Eigen::Vector3d::Zero(), 0.010 * test::random_direction(random));
        const Report report = judge(WalkFilm(seed), filming);
        ASSERT_EQ(report.verdict, Verdict::kMoved) << seed;
        EXPECT_EQ(report.fault->camera, camera) << seed;
        ASSERT_TRUE(report.fault->moved_mm) << seed;
        EXPECT_NEAR(*report.fault->moved_mm, 10.0, 1.5) << seed;
        EXPECT_FALSE(report.fault->turned_deg) << seed;
    }
}

TEST(Coherence, FindsWhereAMovedCameraIs) {
    test::Random random(5);
    Filming filming{rig()};
    geometry::CalibratedCamera& camera = filming.truth[2];
    camera = test::bumped(camera, turn_of(random, 0.5), 0.02 * test::random_direction(random));
    const Report report = judge(WalkFilm(5), filming);
    ASSERT_EQ(report.verdict, Verdict::kMoved);
    ASSERT_EQ(report.fault->camera, 2u);
    EXPECT_NEAR(report.fault->turned_deg.value_or(0.0), 0.5, 0.05);
    EXPECT_NEAR(report.fault->moved_mm.value_or(0.0), 20.0, 3.0);
    const geometry::RigidTransform& found = report.fault->camera_from_site;
    EXPECT_LT((found.inverse().translation - camera.centre_site()).norm(), 0.003);
    EXPECT_LT(found.rotation.angularDistance(camera.camera_from_site.rotation),
              0.05 * std::numbers::pi / 180.0);
}

TEST(Coherence, NamesLatePicturesAsLate) {
    for (std::uint64_t seed = 1; seed <= kFewSeeds; ++seed) {
        const WalkFilm film(seed);
        for (const int late : {1, -1}) {
            const Filming filming{rig(), seed % 8, late};
            const Report report = judge(film, filming);
            ASSERT_EQ(report.verdict, Verdict::kLate) << seed;
            EXPECT_EQ(report.fault->camera, seed % 8) << seed;
            EXPECT_NEAR(report.fault->late_instants, late, 0.15) << seed;
            EXPECT_FALSE(report.fault->turned_deg) << seed;
            EXPECT_FALSE(report.fault->moved_mm) << seed;
        }
    }
}

// Silhouettes that are wrong in all ways at once, or in one.
TEST(Coherence, IsSilentAboutATrueRig) {
    const auto dilate = [](std::size_t camera,
                           std::size_t,
                           test::Random&,
                           std::vector<std::vector<Eigen::Vector2d>>& contours) {
        if (camera != 3) return;
        std::vector<Eigen::Vector2d> wider;
        for (const Eigen::Vector2d& p : contours[0]) {
            for (int k = 0; k < 8; ++k)
                wider.push_back(p + 1.5 * Eigen::Vector2d(std::cos(k * std::numbers::pi / 4.0),
                                                          std::sin(k * std::numbers::pi / 4.0)));
        }
        contours[0] = wider;
    };
    // seven seconds of a lamp on the floor
    const auto light = [](std::size_t camera,
                          std::size_t look,
                          test::Random&,
                          std::vector<std::vector<Eigen::Vector2d>>& contours) {
        if (camera == 5 && look >= 15 && look < 29)
            contours.push_back({{100, 700}, {300, 720}, {250, 900}, {120, 880}});
    };
    // heads and raised arms that look like the wall
    const auto holes = [](std::size_t,
                          std::size_t,
                          test::Random& random,
                          std::vector<std::vector<Eigen::Vector2d>>& contours) {
        if (test::between(random, 0, 8) > 0) return;
        std::erase_if(contours[0], [](const Eigen::Vector2d& p) { return p.y() < 350.0; });
    };
    const auto all = [&](std::size_t camera,
                         std::size_t look,
                         test::Random& random,
                         std::vector<std::vector<Eigen::Vector2d>>& contours) {
        holes(camera, look, random, contours);
        if (!contours[0].empty()) dilate(camera, look, random, contours);
        light(camera, look, random, contours);
    };
    const std::vector<test::Spoil> spoils{{}, dilate, light, holes, all};
    for (std::uint64_t seed = 1; seed <= kFewSeeds; ++seed) {
        const int num_people = seed % 4 < 2 ? 1 : 2;
        const double noise_px = seed % 2 == 0 ? 0.3 : 1.0;
        const WalkFilm film(seed, num_people);
        for (std::size_t i = 0; i < spoils.size(); ++i) {
            const Report report = judge(film, {rig(), 0, 0, noise_px, spoils[i]});
            EXPECT_EQ(report.verdict, Verdict::kCoherent)
                << seed << ": " << num_people << " people, spoil " << i << ", " << noise_px;
            EXPECT_LT(report.rms_px, 1.0);
        }
    }
}

TEST(Coherence, NamesAMovedCameraAmongPeopleWithRaggedOutlines) {
    for (std::uint64_t seed = 1; seed <= kFewSeeds; ++seed) {
        test::Random random(seed);
        const std::size_t camera = seed % 8;
        Filming filming{rig(), 0, 0, 1.0};
        filming.truth[camera] =
            test::bumped(filming.truth[camera], turn_of(random, 0.5), Eigen::Vector3d::Zero());
        const Report report = judge(WalkFilm(seed, 2), filming);
        ASSERT_EQ(report.verdict, Verdict::kMoved) << seed;
        EXPECT_EQ(report.fault->camera, camera) << seed;
    }
}

TEST(Coherence, NamesNobodyIfTwoCamerasMoved) {
    Filming filming{rig()};
    for (const std::size_t camera : {1, 4})
        filming.truth[camera] = test::bumped(
            filming.truth[camera], Eigen::Vector3d(0.0, 0.0, 0.01), Eigen::Vector3d::Zero());
    const Report report = judge(WalkFilm(1), filming);
    EXPECT_NE(report.verdict, Verdict::kMoved);
    EXPECT_NE(report.verdict, Verdict::kLate);
    EXPECT_GT(report.cameras[1].rms_px, 2.0 * report.cameras[6].rms_px);
}

TEST(Coherence, NeedsSomebodyWhoMoves) {
    const WalkFilm film(1);
    Coherence coherence(rig());
    EXPECT_EQ(coherence.judge().verdict, Verdict::kTooLittle);
    for (int i = 0; i < 60; ++i) coherence.add(film.sight(7, {rig()}));
    const Report report = coherence.judge();
    EXPECT_EQ(report.verdict, Verdict::kTooLittle);
    EXPECT_EQ(report.num_sights, 1u);
}

class CoherenceWatchOfAWalk : public ::testing::Test {
protected:
    // Looks at the next instant of the walk. Returns a judgement if one was due.
    std::optional<CoherenceWatch::Judgement> look() {
        now_ += std::chrono::milliseconds(500);
        return watch_.look(film_.sight(num_looks_++ % film_.num_looks(), filming_), now_);
    }
    void bump(std::size_t camera, double degrees = 0.2) {
        filming_.truth[camera] =
            test::bumped(filming_.truth[camera],
                         Eigen::Vector3d(0.0, 0.0, degrees * std::numbers::pi / 180.0),
                         Eigen::Vector3d::Zero());
    }
    // Number of looks until a fault is told.
    std::size_t looks_until_told() {
        for (std::size_t i = 1; i <= 120; ++i) {
            const auto judgement = look();
            if (judgement && judgement->is_told) return i;
        }
        return kNever;
    }

    static constexpr std::size_t kNever = 1000;
    WalkFilm film_{3};
    Filming filming_{rig()};
    CoherenceWatch watch_{rig()};
    CoherenceWatch::Clock::time_point now_{};
    std::size_t num_looks_ = 0;
};

TEST_F(CoherenceWatchOfAWalk, TellsOfABumpWithinHalfAMinuteAndOnce) {
    for (std::size_t i = 0; i < 60; ++i) {
        const auto judgement = look();
        EXPECT_FALSE(judgement && judgement->report.fault);
    }
    bump(6);
    std::size_t num_told = 0;
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        const Report& report = judgement->report;
        num_found += watch_.judge().fault ? 1 : 0;
        EXPECT_EQ(report.fault.has_value(), num_found >= CoherenceWatch::kInARow)
            << "not often enough";
        EXPECT_FALSE(judgement->recovered);
        if (!report.fault) continue;
        EXPECT_EQ(report.verdict, Verdict::kMoved);
        EXPECT_EQ(report.fault->camera, 6u);
        EXPECT_EQ(motion_text(*report.fault).substr(0, 11), "turned by 0");
        if (!judgement->is_told) continue;
        EXPECT_LE(i, 60u);
        EXPECT_EQ(num_found, CoherenceWatch::kInARow);
        ++num_told;
    }
    EXPECT_EQ(num_told, 1u);
    // and again after ten minutes
    now_ += CoherenceWatch::kRepeat;
    EXPECT_NE(looks_until_told(), kNever);
}

TEST_F(CoherenceWatchOfAWalk, EndsAFaultIfTheCameraIsBack) {
    bump(6);
    ASSERT_NE(looks_until_told(), kNever);
    filming_.truth = rig();
    std::vector<std::size_t> recovered;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        if (judgement->recovered) {
            EXPECT_EQ(*judgement->recovered, 6u);
            recovered.push_back(i);
        }
        EXPECT_FALSE(judgement->is_told);
        EXPECT_EQ(judgement->report.fault.has_value(), recovered.empty());
        EXPECT_EQ(judgement->report.verdict,
                  recovered.empty() ? Verdict::kMoved : Verdict::kCoherent);
    }
    ASSERT_EQ(recovered.size(), 1u);
    EXPECT_LE(recovered.front(), 60u);
    // a new bump is news at once
    bump(6);
    EXPECT_LE(looks_until_told(), 60u);
}

// No single camera explains the errors then, so the verdict alone would be that all is well.
TEST_F(CoherenceWatchOfAWalk, HoldsAFaultIfAnotherCameraMovesToo) {
    bump(6);
    ASSERT_NE(looks_until_told(), kNever);
    bump(2);
    std::size_t num_coherent = 0;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        num_coherent += watch_.judge().verdict == Verdict::kCoherent ? 1 : 0;
        EXPECT_FALSE(judgement->recovered);
        ASSERT_TRUE(judgement->report.fault);
        EXPECT_EQ(judgement->report.fault->camera, 6u);
    }
    EXPECT_GE(num_coherent, 2u);
}

TEST_F(CoherenceWatchOfAWalk, HoldsAFaultIfItsCameraSeesNobodyAnyMore) {
    bump(6);
    ASSERT_NE(looks_until_told(), kNever);
    filming_.spoil = [](std::size_t camera,
                        std::size_t,
                        test::Random&,
                        std::vector<std::vector<Eigen::Vector2d>>& contours) {
        if (camera == 6) contours.clear();
    };
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        EXPECT_FALSE(judgement && judgement->recovered);
    }
    EXPECT_EQ(watch_.judge().verdict, Verdict::kCoherent);
    EXPECT_EQ(watch_.judge().cameras[6].num_tangencies, 0u);
}

TEST_F(CoherenceWatchOfAWalk, TellsOnceThatNoSingleCameraExplainsTheErrors) {
    for (const std::size_t camera : {1, 3, 4, 6}) bump(camera, camera % 2 == 0 ? 3.0 : -3.0);
    std::size_t num_told = 0, num_found = 0;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        num_found += watch_.judge().verdict == Verdict::kIncoherent ? 1 : 0;
        EXPECT_EQ(judgement->report.verdict == Verdict::kIncoherent,
                  num_found >= CoherenceWatch::kInARow);
        EXPECT_FALSE(judgement->report.fault);
        num_told += judgement->is_told ? 1 : 0;
    }
    EXPECT_EQ(num_told, 1u);
    filming_.truth = rig();
    bool is_over = false;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        EXPECT_FALSE(judgement->is_told || judgement->recovered) << "no camera was to blame";
        EXPECT_FALSE(is_over && judgement->report.verdict == Verdict::kIncoherent);
        is_over = judgement->report.verdict == Verdict::kCoherent;
    }
    EXPECT_TRUE(is_over);
    bump(6);
    EXPECT_LE(looks_until_told(), 60u);
}

TEST_F(CoherenceWatchOfAWalk, StillBlamesACameraIfOthersMoveFarToo) {
    bump(6, 3.0);
    ASSERT_NE(looks_until_told(), kNever);
    for (const std::size_t camera : {1, 3, 4}) bump(camera, camera % 2 == 0 ? 3.0 : -3.0);
    std::size_t num_incoherent = 0;
    for (std::size_t i = 0; i < 120; ++i) {
        const auto judgement = look();
        if (!judgement) continue;
        num_incoherent += watch_.judge().verdict == Verdict::kIncoherent ? 1 : 0;
        EXPECT_FALSE(judgement->recovered);
        ASSERT_TRUE(judgement->report.fault);
        EXPECT_EQ(judgement->report.fault->camera, 6u);
    }
    EXPECT_GE(num_incoherent, 2u);
}

TEST(FaultText, SaysWhatIsCertain) {
    NamedFault fault;
    EXPECT_EQ(motion_text(fault), "turned or moved a little");
    fault.turned_deg = 0.2;
    EXPECT_EQ(motion_text(fault), "turned by 0.20 degrees");
    fault.moved_mm = 10.0;
    EXPECT_EQ(motion_text(fault), "turned by 0.20 degrees and moved by 10 mm");
    fault.is_either = true;
    EXPECT_EQ(motion_text(fault), "turned by 0.20 degrees or moved by 10 mm");
    fault.late_instants = -0.4;
    EXPECT_NE(late_text(fault, "north", 20.0).find("'north' is early by 0.4 instants (20 ms)"),
              std::string::npos);
    EXPECT_NE(late_text(fault, "north", 0.0).find("'north' is early by 0.4 instants: "),
              std::string::npos);
}

TEST(Coherence, TakesAnything) {
    Coherence coherence(rig());
    coherence.add({});
    Sight sight;
    sight.now.resize(3);
    coherence.add(sight);
    sight.now.resize(8);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<std::vector<Eigen::Vector2d>> contours{
        {{nan, 1.0}, {5.0, 5.0}}, {{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}}, {}};
    for (SilhouetteHull& hull : sight.now) hull = hull_of(contours, rig()[0].intrinsics);
    coherence.add(sight);
    EXPECT_EQ(coherence.judge().verdict, Verdict::kTooLittle);
}

}  // namespace
}  // namespace atrium::coherence
