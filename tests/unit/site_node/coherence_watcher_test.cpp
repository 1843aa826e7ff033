#include "site_node/coherence_watcher.hpp"

#include "core/bus/checks.hpp"
#include "core/bus/messages.hpp"
#include "site_node/views/views_file.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/people/walk_film.hpp"
#include "tests/support/people/walking_people.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

namespace atrium::site_node {
namespace {

std::vector<geometry::CalibratedCamera> watched_rig() {
    test::RingRigOptions options;
    options.focal_px = 800.0;
    auto rig = test::make_ring_rig(options);
    for (std::size_t i = 0; i < rig.size(); ++i) rig[i].name = "cam" + std::to_string(i);
    return rig;
}

bool is_sendable(const bus::RigCoherence& coherence) {
    bus::SiteStatus status;
    status.site = "lab";
    status.coherence = coherence;
    return bus::check(status).has_value();
}

std::size_t num_of(const std::string& part, const std::string& text) {
    std::size_t num = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++num;
    return num;
}

// Made once: people take a while.
const test::WalkFilm& film() {
    static const test::WalkFilm walk(3);
    return walk;
}

// A site whose watcher sees a walk twice a second, on a clock of the test.
class WatchedWalk {
public:
    explicit WatchedWalk(std::vector<geometry::CalibratedCamera> rig,
                         const std::string& rig_name = "lab.toml",
                         const std::filesystem::path& kept = {})
        : rig_(rig), filming_{rig}, watcher_(rig, 30.0, rig_name, kept, [this] {
              return is_explained_.load();
          }) {}

    // Shows it two metaframes in a row, and waits until it has looked at them.
    void look() {
        now_ += std::chrono::milliseconds(500);
        const coherence::Sight sight = film().sight(num_looks_++ % film().num_looks(), filming_);
        ASSERT_TRUE(watcher_.wants(++frame_id_, now_));
        watcher_.put(frame_id_, views(sight.before));
        ASSERT_TRUE(watcher_.wants(++frame_id_, now_));
        watcher_.put(frame_id_, views(sight.now));
        const auto later = now_ + std::chrono::milliseconds(499);
        ASSERT_FALSE(watcher_.wants(frame_id_ + 1, later)) << "not before half a second is over";
        ASSERT_TRUE(test_support::comes_true([&] {
            EXPECT_LE(watcher_.newest().cameras.size(), rig_.size());  // a status meanwhile
            return !watcher_.is_looking();
        }));
    }
    // Looks on for a minute at most, until a fault holds or does not.
    bool comes_to_hold(bool holds) {
        for (int i = 0; i < 120 && watcher_.newest().has_fault() != holds; ++i) look();
        return watcher_.newest().has_fault() == holds;
    }
    CoherenceWatcher& watcher() { return watcher_; }
    test::Filming& filming() { return filming_; }
    void set_explained(bool is_explained) { is_explained_ = is_explained; }

private:
    std::vector<views::NamedView> views(const std::vector<coherence::SilhouetteHull>& hulls) const {
        std::vector<views::NamedView> out;
        for (std::size_t i = 0; i < hulls.size(); ++i) {
            views::NamedView& view = out.emplace_back();
            view.name = rig_[i].name;
            view.view = {rig_[i].intrinsics, rig_[i].camera_from_site, {hulls[i].points}, {}};
        }
        return out;
    }

    std::vector<geometry::CalibratedCamera> rig_;
    std::uint64_t frame_id_ = 0;
    std::size_t num_looks_ = 0;
    CoherenceWatcher::Clock::time_point now_{std::chrono::hours(1)};
    test::Filming filming_;
    std::atomic<bool> is_explained_ = false;
    CoherenceWatcher watcher_;
};

TEST(CoherenceWatcher, HasACameraThatTurnedInTheStatusUntilItIsBack) {
    testing::internal::CaptureStderr();
    WatchedWalk walk(watched_rig());
    EXPECT_EQ(walk.watcher().newest(), bus::RigCoherence{});
    geometry::CalibratedCamera& camera = walk.filming().truth[5];
    camera = test::bumped(
        camera, Eigen::Vector3d(0.0, 0.0, std::numbers::pi / 180.0), Eigen::Vector3d::Zero());
    ASSERT_TRUE(walk.comes_to_hold(true));
    const bus::RigCoherence moved = walk.watcher().newest();
    EXPECT_TRUE(is_sendable(moved));
    EXPECT_EQ(moved.verdict, bus::RigVerdict::kMoved);
    ASSERT_EQ(moved.cameras.size(), 8u);
    EXPECT_EQ(moved.cameras[moved.fault.camera].name, "cam5");
    EXPECT_NEAR(moved.fault.turned_deg, 1.0, 0.1);
    EXPECT_EQ(moved.fault.moved_mm, -1.0);
    EXPECT_EQ(moved.fault.cure,
              "calibrate refine lab.toml --camera cam5 --recording DIR -o mended.toml");
    EXPECT_LT(moved.cameras[5].share, moved.cameras[1].share);
    EXPECT_GT(moved.cameras[5].rms_px, moved.cameras[1].rms_px);

    walk.filming().truth = watched_rig();
    ASSERT_TRUE(walk.comes_to_hold(false));
    const bus::RigCoherence back = walk.watcher().newest();
    EXPECT_EQ(back.verdict, bus::RigVerdict::kCoherent);
    EXPECT_LT(back.rms_px, 1.0);
    EXPECT_GT(back.num_instants, 20u);
    EXPECT_EQ(back.fault, bus::RigFault{});
    EXPECT_TRUE(is_sendable(back));
    for (int i = 0; i < 24; ++i) walk.look();
    walk.watcher().finish();
    EXPECT_FALSE(walk.watcher().doubts_rig());
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(num_of("camera_moved camera=cam5 ", log), 1u) << log;
    EXPECT_EQ(num_of("camera_coherent camera=cam5 ", log), 1u) << log;
}

// Swapped cameras, for example: poses that fit better would hide them.
TEST(CoherenceWatcher, IsSilentWhileAMistakeExplainsAll) {
    testing::internal::CaptureStderr();
    WatchedWalk walk(watched_rig());
    geometry::CalibratedCamera& camera = walk.filming().truth[5];
    camera = test::bumped(
        camera, Eigen::Vector3d(0.0, 0.0, std::numbers::pi / 180.0), Eigen::Vector3d::Zero());
    walk.set_explained(true);
    for (int i = 0; i < 60; ++i) walk.look();
    EXPECT_EQ(walk.watcher().newest(), bus::RigCoherence{});
    walk.set_explained(false);
    ASSERT_TRUE(walk.comes_to_hold(true)) << "the mistake is mended";
    walk.set_explained(true);
    walk.look();
    EXPECT_EQ(walk.watcher().newest(), bus::RigCoherence{});
    walk.watcher().finish();
    EXPECT_EQ(num_of("camera_moved", testing::internal::GetCapturedStderr()), 1U);
}

TEST(CoherenceWatcher, SaysHowToMendALateCamera) {
    WatchedWalk walk(watched_rig());
    walk.filming().late_camera = 2;
    walk.filming().late_instants = 1;
    ASSERT_TRUE(walk.comes_to_hold(true));
    const bus::RigCoherence late = walk.watcher().newest();
    EXPECT_EQ(late.verdict, bus::RigVerdict::kLate);
    EXPECT_EQ(late.fault.camera, 2u);
    EXPECT_NEAR(late.fault.late_instants, 1.0, 0.15);
    EXPECT_EQ(late.fault.cure, "check its trigger, or shift its pictures by -1");
}

TEST(CoherenceWatcher, NamesARigWhosePathNoStatusCanCarry) {
    for (const std::string& path : {std::string(300, 'a'), std::string("b\xc3\xbcro.toml")}) {
        WatchedWalk walk(watched_rig(), path);
        geometry::CalibratedCamera& camera = walk.filming().truth[0];
        camera = test::bumped(camera, Eigen::Vector3d(0.0, 0.0, 0.02), Eigen::Vector3d::Zero());
        ASSERT_TRUE(walk.comes_to_hold(true));
        const bus::RigCoherence moved = walk.watcher().newest();
        EXPECT_TRUE(is_sendable(moved));
        EXPECT_EQ(moved.fault.cure,
                  "calibrate refine RIG.toml --camera cam0 --recording DIR -o mended.toml");
    }
}

class KeptWalk : public testing::Test {
protected:
    void SetUp() override { std::filesystem::remove_all(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("atrium-kept-" + std::to_string(getpid()));
};

std::set<std::uint64_t> kept_ids(const std::filesystem::path& folder) {
    std::set<std::uint64_t> ids;
    for (const auto& file : std::filesystem::directory_iterator(folder / "views")) {
        const auto views = views::load_views_file(file.path());
        EXPECT_EQ(views ? views->size() : 0, 8u) << file.path();
        ids.insert(std::stoull(file.path().stem()));
    }
    return ids;
}

TEST_F(KeptWalk, KeepsTheSilhouettesThatShowAFault) {
    const std::filesystem::path kept = folder_ / "lab";
    WatchedWalk walk(watched_rig(), "lab.toml", kept);
    for (int i = 0; i < 24; ++i) walk.look();
    EXPECT_FALSE(std::filesystem::exists(kept)) << "the rig is true";
    geometry::CalibratedCamera& camera = walk.filming().truth[5];
    camera = test::bumped(camera, Eigen::Vector3d(0.0, 0.02, 0.0), Eigen::Vector3d::Zero());
    ASSERT_TRUE(walk.comes_to_hold(true));
    EXPECT_EQ(
        walk.watcher().newest().fault.cure,
        "calibrate refine lab.toml --camera cam5 --recording " + kept.string() + " -o mended.toml");
    const auto first = kept_ids(kept);
    ASSERT_GT(first.size(), 36u);
    for (const std::uint64_t id : first)  // two metaframes in a row each
        EXPECT_TRUE(first.contains(id % 2 == 1 ? id + 1 : id - 1)) << id;
    // somebody mends the camera meanwhile: the newest count
    for (int i = 0; i < 140; ++i) walk.look();
    const auto later = kept_ids(kept);
    EXPECT_GT(*later.begin(), *first.begin());
    EXPECT_GT(*later.rbegin(), *first.rbegin() + 100);
    EXPECT_FALSE(std::filesystem::exists(kept / "views.new"));
    EXPECT_FALSE(std::filesystem::exists(kept / "views.old"));
}

TEST_F(KeptWalk, MendsAllCamerasIfNoneIsToBlame) {
    testing::internal::CaptureStderr();
    {
        WatchedWalk walk(watched_rig(), "lab.toml", folder_);
        for (const std::size_t i : {1, 3, 4, 6}) {
            geometry::CalibratedCamera& camera = walk.filming().truth[i];
            camera = test::bumped(camera,
                                  Eigen::Vector3d(0.0, 0.0, 0.02 + 0.01 * static_cast<double>(i)),
                                  Eigen::Vector3d::Zero());
        }
        for (int i = 0; i < 60; ++i) walk.look();
        const bus::RigCoherence newest = walk.watcher().newest();
        EXPECT_EQ(newest.verdict, bus::RigVerdict::kIncoherent);
        EXPECT_TRUE(is_sendable(newest));
        EXPECT_EQ(newest.fault.cure,
                  "calibrate refine lab.toml --recording " + folder_.string() + " -o mended.toml");
    }
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(num_of("rig_incoherent coherence_px=", log), 1u) << log;
    EXPECT_GT(kept_ids(folder_).size(), 36u);
}

TEST_F(KeptWalk, NamesOtherLensesWithTheCommandThatMendsThem) {
    testing::internal::CaptureStderr();
    {
        WatchedWalk walk(watched_rig(), "lab.toml", folder_);
        for (geometry::CalibratedCamera& camera : walk.filming().truth) {
            camera.intrinsics.fx *= 1.1;
            camera.intrinsics.fy *= 1.1;
        }
        for (int i = 0; i < 60; ++i) walk.look();
        const bus::RigCoherence newest = walk.watcher().newest();
        EXPECT_EQ(newest.verdict, bus::RigVerdict::kLenses);
        EXPECT_TRUE(is_sendable(newest));
        EXPECT_EQ(newest.fault.cure,
                  "calibrate refine lab.toml --focal --recording " + folder_.string() +
                      " -o mended.toml");
        walk.watcher().finish();
        EXPECT_TRUE(walk.watcher().doubts_rig());
    }
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_EQ(num_of("other_lenses factor=1.10 coherence_px=", log), 1u) << log;
    EXPECT_EQ(num_of("lenses 1.10 times as long as the rig says", log), 1u) << log;
    EXPECT_EQ(num_of("let somebody walk through the room", log), 1u) << log;
    EXPECT_EQ(num_of("rig_incoherent", log), 0u) << log;
    EXPECT_GT(kept_ids(folder_).size(), 36u);
}

TEST_F(KeptWalk, LeavesFilesOfOthersAlone) {
    std::filesystem::create_directories(folder_ / "views");
    const auto mine = folder_ / "views" / "holiday.json";
    std::ofstream(mine) << "{}";
    testing::internal::CaptureStderr();
    {
        WatchedWalk walk(watched_rig(), "lab.toml", folder_);
        geometry::CalibratedCamera& camera = walk.filming().truth[5];
        camera = test::bumped(camera, Eigen::Vector3d(0.0, 0.02, 0.0), Eigen::Vector3d::Zero());
        EXPECT_TRUE(walk.comes_to_hold(true));
        EXPECT_EQ(walk.watcher().newest().fault.cure,
                  "calibrate refine lab.toml --camera cam5 --recording DIR -o mended.toml");
    }
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_TRUE(std::filesystem::exists(mine));
    EXPECT_EQ(num_of("silhouettes_not_kept reason=\"" + (folder_ / "views").string(), log), 1u)
        << log;
    EXPECT_EQ(num_of("record a person who walks", log), 1u) << log;
}

TEST(CoherenceWatcher, KnowsNothingOfFewerThanThreeCameras) {
    auto rig = watched_rig();
    rig.resize(2);
    CoherenceWatcher watcher(rig, 30.0, "lab.toml");
    EXPECT_FALSE(watcher.wants(1, CoherenceWatcher::Clock::time_point{std::chrono::hours(1)}));
    watcher.finish();
    EXPECT_EQ(watcher.newest().verdict, bus::RigVerdict::kUnknown);
}

}  // namespace
}  // namespace atrium::site_node
