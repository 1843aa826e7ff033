#include "site_node/rig_check/diagnosis.hpp"

#include "site_node/rig_check/flips.hpp"
#include "site_node/rig_check/rig_geometry.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

// Seeded scenes of people: each mistake is found, and no good rig is blamed.
namespace atrium::rig_check {
namespace {

using test::Random;
using test::SceneOptions;

std::vector<views::NamedView> named(const std::vector<hull::SilhouetteView>& views) {
    std::vector<views::NamedView> result;
    for (const hull::SilhouetteView& view : views)
        result.push_back({"cam" + std::to_string(result.size()), view});
    return result;
}

// People in front of cameras around them, with the noise of real silhouettes.
std::vector<views::NamedView> good_scene(std::uint64_t seed, int num_views) {
    SceneOptions options;
    options.rig = seed % 3 == 0 ? test::RigKind::kAnywhere : test::RigKind::kRing;
    options.num_views = num_views;
    options.noise_px = 1.0;
    options.shift_px = 1.5;
    return named(test::make_scene(options, seed));
}

constexpr std::uint64_t kNumSeeds = test::kSanitized ? 3 : 10;

// `num_of_ten`, as a share of the seeds, rounded down.
constexpr int of_seeds(int num_of_ten) { return num_of_ten * static_cast<int>(kNumSeeds) / 10; }

int num_views_of(std::uint64_t seed) { return 4 + static_cast<int>(seed % 7); }

TEST(Diagnosis, BlamesNoGoodRig) {
    for (std::uint64_t seed = 1; seed <= 2 * kNumSeeds; ++seed) {
        const auto views = good_scene(seed, num_views_of(seed));
        const auto diagnosis = diagnose(views, {});
        EXPECT_FALSE(diagnosis) << seed << ": " << diagnosis->text << " " << diagnosis->share;
    }
}

// How often `spoil` is diagnosed as `cause`, as another certain cause, or not at all.
struct Score {
    int right = 0;
    int wrong = 0;
    int silent = 0;
    std::string text;  // of the last right diagnosis
};
template <typename Spoil>
Score score_of(Cause cause, const Spoil& spoil) {
    Score score;
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
        Random random(seed);
        auto views = good_scene(seed, num_views_of(seed));
        spoil(random, views);
        const auto diagnosis = diagnose(views, {});
        const bool is_right = diagnosis && diagnosis->cause == cause;
        const bool is_certain = diagnosis && diagnosis->cause != Cause::kUnknown;
        if (is_right) score.text = diagnosis->text;
        ++(is_right ? score.right : is_certain ? score.wrong : score.silent);
    }
    return score;
}

TEST(Diagnosis, BlamesNoGoodRigForPeopleWhoReachOutOfThePictures) {
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
        SceneOptions options;
        options.num_views = num_views_of(seed);
        options.cropped = true;
        const auto views = named(test::make_scene(options, seed));
        const auto diagnosis = diagnose(views, {});
        EXPECT_FALSE(diagnosis) << seed << ": " << diagnosis->text << " " << diagnosis->share;
    }
}

TEST(Diagnosis, FindsInvertedExtrinsics) {
    const Score score = score_of(Cause::kInverted, [](Random&, auto& views) {
        for (auto& view : views) view.view.camera_from_site = view.view.camera_from_site.inverse();
    });
    EXPECT_GE(score.right, of_seeds(9));
    EXPECT_EQ(score.wrong, 0);
}

TEST(Diagnosis, FindsTheAxesOfOpenGl) {
    const Score score = score_of(Cause::kAxes, [](Random&, auto& views) {
        for (auto& view : views)
            view.view.camera_from_site = corrected(view.view.camera_from_site, Misreading::kOpenGl);
    });
    EXPECT_GE(score.right, of_seeds(9));
    EXPECT_EQ(score.wrong, 0);
}

// A lens as wide as those of action cameras, that does not look at the people: near the middle of a
// picture distortion is a change of the focal length, which silhouettes hardly tell.
void set_wide_lens(Random& random, views::NamedView& view) {
    geometry::PinholeCamera& lens = view.view.intrinsics;
    const geometry::PinholeCamera narrow = lens;
    lens.fx *= 0.5;
    lens.fy *= 0.5;
    lens.distortion = {-0.28, 0.07, 0.0, 0.0, 0.0};
    const Eigen::Vector2d aside = test::random_direction(random).head<2>().normalized();
    const geometry::RigidTransform turned{
        Eigen::Quaterniond(Eigen::AngleAxisd(0.25, Eigen::Vector3d(aside.x(), aside.y(), 0.0))),
        Eigen::Vector3d::Zero()};
    view.view.camera_from_site = turned * view.view.camera_from_site;
    for (auto& contour : view.view.contours)
        for (Eigen::Vector2d& pixel : contour)
            pixel = lens.project(turned * narrow.ray_camera(pixel));
}

TEST(Diagnosis, FindsPicturesThatWereUndistortedBefore) {
    const Score score = score_of(Cause::kUndistorted, [](Random& random, auto& views) {
        for (auto& view : views) {
            set_wide_lens(random, view);
            for (auto& contour : view.view.contours)
                for (Eigen::Vector2d& pixel : contour)
                    if (const auto moved = view.view.intrinsics.undistort(pixel)) pixel = *moved;
        }
    });
    EXPECT_GE(score.right, of_seeds(8));
    EXPECT_EQ(score.wrong, 0);
}

TEST(Diagnosis, BlamesNoWideLens) {
    for (std::uint64_t seed = 1; seed <= 2 * kNumSeeds; ++seed) {
        auto views = good_scene(seed, num_views_of(seed));
        Random random(seed);
        for (auto& view : views) set_wide_lens(random, view);
        const auto diagnosis = diagnose(views, {});
        EXPECT_FALSE(diagnosis) << seed << ": " << diagnosis->text << " " << diagnosis->share;
    }
}

TEST(Diagnosis, FindsTwoSwappedCameras) {
    int named_right = 0;
    const Score score = score_of(Cause::kSwapped, [&](Random& random, auto& views) {
        const auto last = static_cast<int>(views.size()) - 1;
        const auto a = static_cast<std::size_t>(test::between(random, 0, last));
        const auto b =
            (a + static_cast<std::size_t>(test::between(random, 1, last))) % views.size();
        std::swap(views[a].view.contours, views[b].view.contours);
        const auto diagnosis = diagnose(views, {});
        if (diagnosis && diagnosis->cameras.size() == 2) {
            named_right += std::is_permutation(diagnosis->cameras.begin(),
                                               diagnosis->cameras.end(),
                                               std::vector{views[a].name, views[b].name}.begin());
        }
    });
    EXPECT_GE(score.right, of_seeds(8));
    EXPECT_LE(score.wrong, 1);
    EXPECT_GE(named_right, of_seeds(8));
}

// The lenses of these scenes have no distortion; see FlipsTheStoredPicture.
void flip(bool is_x, bool is_y, hull::SilhouetteView& view) {
    for (auto& contour : view.contours)
        for (Eigen::Vector2d& pixel : contour) {
            if (is_x) pixel.x() = view.intrinsics.width - 1 - pixel.x();
            if (is_y) pixel.y() = view.intrinsics.height - 1 - pixel.y();
        }
}

struct FlipCase {
    bool is_x, is_y;
    Cause cause;
    const char* filter;
};
constexpr FlipCase kFlipCases[] = {{true, true, Cause::kTurned, "-vf hflip,vflip OUT"},
                                   {true, false, Cause::kMirrored, "-vf hflip OUT"},
                                   {false, true, Cause::kFlipped, "-vf vflip OUT"}};

TEST(Diagnosis, FindsPicturesOfOneCameraThatWereTurnedOrMirrored) {
    for (const FlipCase& one : kFlipCases) {
        const Score score = score_of(one.cause, [&](Random& random, auto& views) {
            flip(one.is_x,
                 one.is_y,
                 views[static_cast<std::size_t>(
                           test::between(random, 0, static_cast<int>(views.size()) - 1))]
                     .view);
        });
        EXPECT_GE(score.right, of_seeds(6)) << one.filter;
        EXPECT_EQ(score.wrong, 0) << one.filter;
        EXPECT_NE(score.text.find(one.filter), std::string::npos) << score.text;
        EXPECT_NE(score.text.find("contradicts all others, but not if its pictures are"),
                  std::string::npos)
            << score.text;
    }
}

TEST(Diagnosis, FindsPicturesOfAllCamerasThatWereTurnedOrMirrored) {
    for (const FlipCase& all : kFlipCases) {
        const Score score = score_of(all.cause, [&](Random&, auto& views) {
            for (auto& view : views) flip(all.is_x, all.is_y, view.view);
        });
        EXPECT_GE(score.right, of_seeds(9)) << all.filter;
        EXPECT_EQ(score.wrong, 0) << all.filter;
        EXPECT_NE(score.text.find(all.filter), std::string::npos) << score.text;
        EXPECT_NE(score.text.find("the pictures of all cameras look"), std::string::npos)
            << score.text;
    }
}

// A person in a ring whose cameras, all at one height, stand and look symmetrically. It stands
// away from the middle.
std::vector<views::NamedView> symmetric_scene(std::uint64_t seed, int num_views) {
    Random random(seed);
    test::Bodies bodies;
    bodies.radius_m = 2.0;
    bodies.parts = test::make_person(
        random, {test::between(random, 0.2, 0.6), test::between(random, -0.6, -0.2), 0.0});
    const double height_m = test::between(random, 1.2, 2.4);
    std::vector<geometry::CalibratedCamera> rig;
    for (int i = 0; i < num_views; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / num_views;
        const Eigen::Vector3d centre(3.0 * std::cos(angle), 3.0 * std::sin(angle), height_m);
        Eigen::Matrix3d rows;
        rows.row(2) = (Eigen::Vector3d(0.0, 0.0, 0.9) - centre).normalized();
        rows.row(0) = rows.row(2).cross(Eigen::RowVector3d::UnitZ()).normalized();
        rows.row(1) = rows.row(2).cross(rows.row(0));
        geometry::CalibratedCamera camera;
        camera.intrinsics = {
            .width = 800, .height = 600, .fx = 560, .fy = 560, .cx = 399.5, .cy = 299.5};
        camera.camera_from_site = {Eigen::Quaterniond(rows), -rows * centre};
        rig.push_back(camera);
    }
    return named(test::views_of(bodies, rig, {.noise_px = 0.7, .shift_px = 0.7}, random));
}

// There, mirrored pictures of all cameras are those of cameras exchanged in pairs, of a mirrored
// person.
TEST(Diagnosis, OfAMirroredSymmetricRingNamesNotOnlySwappedCameras) {
    for (const int num_views : {4, 5, 6, 8}) {
        int num_told = 0;
        for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
            auto views = symmetric_scene(seed, num_views);
            const auto good = diagnose(views, {});
            EXPECT_FALSE(good) << num_views << " " << seed << ": " << good->text;
            for (auto& view : views) flip(true, false, view.view);
            const auto diagnosis = diagnose(views, {});
            num_told += diagnosis && diagnosis->text.find(
                                         "the pictures of all cameras look "
                                         "mirrored left-right") != std::string::npos;
            if (diagnosis && num_views > 4) {
                EXPECT_NE(diagnosis->cause, Cause::kSwapped) << seed;
            }
        }
        EXPECT_GE(num_told, of_seeds(9)) << num_views;
    }
}

TEST(Diagnosis, OfASymmetricRingStillNamesSwappedCameras) {
    for (const int num_views : {4, 6, 8}) {
        int num_told = 0;
        for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
            auto views = symmetric_scene(seed, num_views);
            std::swap(views[0].view.contours,
                      views[static_cast<std::size_t>(num_views) / 2].view.contours);
            const auto diagnosis = diagnose(views, {});
            num_told += diagnosis && diagnosis->cause == Cause::kSwapped;
        }
        EXPECT_GE(num_told, of_seeds(9)) << num_views;
    }
}

TEST(Flips, ApplyToTheStoredPictureAndKeepForegroundLeft) {
    hull::SilhouetteView view;
    view.intrinsics = {.width = 800, .height = 600, .fx = 560, .fy = 550, .cx = 390.0, .cy = 310.0};
    view.intrinsics.distortion = {-0.12, 0.03, 0.001, -0.002, 0.0};
    view.contours = {{{100.0, 80.0}, {90.0, 400.0}, {700.0, 420.0}}};
    const auto before = view.contours.front();
    for (const Flip& one : kFlips) {
        hull::SilhouetteView flipped = view;
        flip_contours(flipped, one);
        const bool is_mirror = one.is_x != one.is_y;
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::Vector2d was = view.intrinsics.distort(before[i]);
            const Eigen::Vector2d is =
                view.intrinsics.distort(flipped.contours.front()[is_mirror ? 2 - i : i]);
            EXPECT_NEAR(is.x(), one.is_x ? 799.0 - was.x() : was.x(), 1e-6);
            EXPECT_NEAR(is.y(), one.is_y ? 599.0 - was.y() : was.y(), 1e-6);
        }
        flip_contours(flipped, one);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_LT((flipped.contours.front()[i] - before[i]).norm(), 1e-6);
    }
}

TEST(Diagnosis, FindsTheOneCameraThatMoved) {
    const Score score = score_of(Cause::kOneCamera, [](Random& random, auto& views) {
        auto& moved = views[static_cast<std::size_t>(
                                test::between(random, 0, static_cast<int>(views.size()) - 1))]
                          .view.camera_from_site;
        moved.translation += 0.6 * test::random_direction(random);
    });
    EXPECT_GE(score.right, of_seeds(6));
    EXPECT_LE(score.wrong, 2);
    EXPECT_NE(score.text.find("its pictures are of another instant"), std::string::npos)
        << score.text;
}

TEST(Diagnosis, FindsTwoCamerasOfAnOlderCalibration) {
    int num_named = 0;
    for (std::uint64_t seed = 1; seed <= kNumSeeds; ++seed) {
        auto views = symmetric_scene(seed, 6 + static_cast<int>(seed % 3));
        Random random(seed);
        const auto first =
            static_cast<std::size_t>(test::between(random, 0, static_cast<int>(views.size()) - 2));
        const auto second = static_cast<std::size_t>(
            test::between(random, static_cast<int>(first) + 1, static_cast<int>(views.size()) - 1));
        for (const std::size_t i : {first, second}) {
            auto& pose = views[i].view.camera_from_site;
            pose.translation += 0.5 * test::random_direction(random);
        }
        const auto diagnosis = diagnose(views, {});
        if (!diagnosis || diagnosis->cause != Cause::kTwoCameras) continue;
        ++num_named;
        EXPECT_THAT(diagnosis->cameras, testing::ElementsAre(views[first].name, views[second].name))
            << seed;
        EXPECT_NE(diagnosis->text.find("contradict all others, which agree"), std::string::npos);
    }
    EXPECT_GE(num_named, of_seeds(6));
}

}  // namespace
}  // namespace atrium::rig_check
