#include "site_node/rig_check/diagnosis.hpp"

#include "site_node/rig_check/rig_geometry.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/shapes/scene_maker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

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

TEST(Diagnosis, FindsPicturesOfOneCameraThatWereTurned) {
    const Score score = score_of(Cause::kTurned, [](Random& random, auto& views) {
        auto& turned = views[static_cast<std::size_t>(
                                 test::between(random, 0, static_cast<int>(views.size()) - 1))]
                           .view;
        const geometry::PinholeCamera& lens = turned.intrinsics;
        for (auto& contour : turned.contours)
            for (Eigen::Vector2d& pixel : contour)
                pixel = Eigen::Vector2d(lens.width - 1, lens.height - 1) - pixel;
    });
    EXPECT_GE(score.right, of_seeds(6));
    EXPECT_EQ(score.wrong, 0);
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

}  // namespace
}  // namespace atrium::rig_check
