#include "tools/calibrate/refine/take_polygons.hpp"

#include "core/config/rig.hpp"
#include "site_node/kept_silhouettes.hpp"
#include "site_node/rig_check/flips.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tools/calibrate/refine/check_rig.hpp"
#include "tools/calibrate/refine/judge_refined.hpp"
#include "tools/calibrate/refine/refine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// The silhouettes that a site keeps of a walk, while its rig says that camera 5 is elsewhere.
class KeptTake : public testing::Test {
protected:
    void SetUp() override {
        fs::remove_all(folder_);
        test::RingRigOptions options;
        options.focal_px = 800.0;
        truth_ = test::make_ring_rig(options);
        rig_ = truth_;
        rig_[5] = test::bumped(truth_[5],
                               Eigen::Vector3d(0.0, std::numbers::pi / 180.0, 0.0),
                               Eigen::Vector3d(0.03, 0.0, 0.0));
        static const test::WalkFilm walk(3);  // people take a while
        site_node::KeptSilhouettes kept(folder_, walk.num_looks());
        for (std::size_t i = 0; i < walk.num_looks(); ++i) {
            const coherence::Sight sight = walk.sight(i, {truth_});
            sights_.push_back(sight);
            kept.add({15 * i + 7, views_of(sight.now), views_of(sight.before)});
        }
        const auto written = kept.write();
        ASSERT_TRUE(written) << written.error().message;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::vector<views::NamedView> views_of(const std::vector<coherence::SilhouetteHull>& hulls) {
        std::vector<views::NamedView> views;
        for (std::size_t c = 0; c < hulls.size(); ++c)
            views.push_back(
                {rig_[c].name,
                 {rig_[c].intrinsics, rig_[c].camera_from_site, {hulls[c].points}, {}}});
        return views;
    }

    std::string error_of(const std::vector<geometry::CalibratedCamera>& rig) {
        const auto take = read_take(folder_, rig, {});
        return take ? "" : take.error().message;
    }

    const fs::path folder_ =
        fs::temp_directory_path() / ("atrium-kept-take-" + std::to_string(getpid()));
    std::vector<geometry::CalibratedCamera> truth_, rig_;
    std::vector<coherence::Sight> sights_;
};

TEST_F(KeptTake, IsTheSameAsWhatTheSiteSaw) {
    const auto take = read_take(folder_, rig_, {});
    ASSERT_TRUE(take) << take.error().message;
    ASSERT_EQ(take->sights.size(), sights_.size());
    ASSERT_EQ(take->views.size(), sights_.size());
    EXPECT_EQ(take->num_instants, 2 * sights_.size());
    for (std::size_t i = 0; i < sights_.size(); ++i) {
        std::vector<coherence::Tangency> seen, read;
        coherence::find_tangencies(rig_, sights_[i], 0, {}, seen);
        coherence::find_tangencies(rig_, take->sights[i], 0, {}, read);
        ASSERT_EQ(seen.size(), read.size());
        for (std::size_t k = 0; k < seen.size(); ++k) {
            EXPECT_NEAR(seen[k].error_px, read[k].error_px, 1e-9);
            EXPECT_EQ(std::isnan(seen[k].motion_px), std::isnan(read[k].motion_px));
            if (!std::isnan(seen[k].motion_px)) {
                EXPECT_NEAR(seen[k].motion_px, read[k].motion_px, 1e-9);
            }
        }
    }
}

// Poses are not judged by mirrored pictures: no refinement mends those.
TEST_F(KeptTake, NamesMirroredPicturesAlone) {
    auto take = read_take(folder_, rig_, {});
    ASSERT_TRUE(take) << take.error().message;
    for (auto& views : take->views)
        for (auto& view : views) rig_check::flip_contours(view.view, rig_check::kFlips[1]);
    RigCheck check;
    config::Rig rig;
    rig.cameras = rig_;
    check_silhouettes(rig, *take, "lab.toml", "kept/lab", check);
    ASSERT_EQ(check.problems.size(), 1u);
    EXPECT_THAT(check.problems.front(),
                HasSubstr("the pictures of all cameras look mirrored left-right"));
}

TEST_F(KeptTake, NamesAndMendsTheCamera) {
    const auto take = read_take(folder_, rig_, {});
    ASSERT_TRUE(take) << take.error().message;
    RigCheck check;
    config::Rig rig;
    rig.cameras = rig_;
    check_silhouettes(rig, *take, "lab.toml", "kept/lab", check);
    ASSERT_EQ(check.problems.size(), 1u);
    EXPECT_THAT(check.problems.front(), HasSubstr("camera 'cam5' turned by"));
    RefineOptions options;
    options.cameras = {5};
    const auto refined = refine(rig_, take->sights, options);
    ASSERT_TRUE(refined) << refined.error().message;
    EXPECT_TRUE(judge_refined(*refined, rig_, *take, false).problems.empty());
    EXPECT_LT((refined->cameras[5].centre_site() - truth_[5].centre_site()).norm(), 0.003);
    EXPECT_LT(refined->cameras[5].camera_from_site.rotation.angularDistance(
                  truth_[5].camera_from_site.rotation),
              0.05 * std::numbers::pi / 180.0);
}

TEST_F(KeptTake, HasAsManyInstantsAsAsked) {
    TakeOptions options;
    options.most_sights = 11;
    const auto take = read_take(folder_, rig_, options);
    ASSERT_TRUE(take) << take.error().message;
    EXPECT_EQ(take->sights.size(), 11u);
    for (const coherence::Sight& sight : take->sights) EXPECT_EQ(sight.before.size(), 8u);
}

TEST_F(KeptTake, LacksACameraAtSomeInstants) {
    const fs::path file = folder_ / "views" / "000007.json";
    auto views = views::load_views_file(file);
    ASSERT_TRUE(views);
    views->erase(views->begin() + 2);
    ASSERT_TRUE(views::save_views_file(*views, file));
    const auto take = read_take(folder_, rig_, {});
    ASSERT_TRUE(take) << take.error().message;
    EXPECT_FALSE(take->sights[0].now[2].has_picture);
    EXPECT_TRUE(take->sights[0].before[2].has_picture);
    EXPECT_EQ(take->views[0].size(), 7u);
}

TEST_F(KeptTake, SaysWhichFileIsDamaged) {
    std::ofstream(folder_ / "views" / "000022.json") << "{\"views\": [";
    EXPECT_THAT(error_of(rig_), HasSubstr("000022.json: "));
}

TEST_F(KeptTake, RefusesOtherLenses) {
    auto rig = rig_;
    rig[1].intrinsics.fx += 3.0;
    EXPECT_THAT(error_of(rig), HasSubstr("silhouettes of 'cam1' through another lens"));
    rig = rig_;
    rig[1].intrinsics.width *= 2;
    EXPECT_THAT(error_of(rig), HasSubstr("silhouettes of 'cam1' through another lens"));
}

TEST_F(KeptTake, NamesACameraThatNoFileHas) {
    auto rig = rig_;
    rig[3].name = "roof";
    EXPECT_THAT(error_of(rig), HasSubstr("has no silhouettes of camera 'roof'"));
}

TEST_F(KeptTake, SaysWhatAnEmptyFolderLacks) {
    for (const auto& file : fs::directory_iterator(folder_ / "views")) fs::remove(file);
    EXPECT_THAT(error_of(rig_), HasSubstr("has no files such as 000001.json"));
}

TEST_F(KeptTake, IsReplacedByANewerOne) {
    site_node::KeptSilhouettes kept(folder_, 2);
    for (std::uint64_t i = 1; i <= 3; ++i) kept.add({1000 * i, views_of(sights_[i].now), {}});
    ASSERT_TRUE(kept.write());
    const auto take = read_take(folder_, rig_, {});
    ASSERT_TRUE(take) << take.error().message;
    EXPECT_EQ(take->num_instants, 2u);
    EXPECT_TRUE(take->sights.front().before.empty());
}

}  // namespace
}  // namespace atrium::calibrate
