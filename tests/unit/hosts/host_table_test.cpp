#include "site_node/hosts/host_table.hpp"

#include "core/bus/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atrium::hosts {
namespace {

using bus::HostState;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr nanoseconds kPeriod{33'333'333};

HostEntry host(const std::string& name, std::vector<std::string> cameras, bool takes_any = false) {
    return {name, std::move(cameras), takes_any, false, "site.toml:1"};
}

class HostTableTest : public testing::Test {
protected:
    // The clock of `name` is `offset` ahead; question and answer take 0.2 ms each.
    void ask(const std::string& name, nanoseconds offset, std::uint64_t epoch = 1) {
        bus::ClockAnswer answer;
        answer.host = name;
        answer.asked = now_;
        answer.received = answer.answered = now_ + nanoseconds(200'000) + offset;
        answer.clock_epoch = epoch;
        pass(nanoseconds(400'000));
        table_.add(answer, now_, steady_);
    }
    std::vector<capture::CameraFrame> see(const std::string& name,
                                          std::uint32_t camera,
                                          nanoseconds offset = nanoseconds(0),
                                          nanoseconds delay = milliseconds(4),
                                          std::uint64_t epoch = 1,
                                          bool has_picture = true) {
        bus::CameraSilhouette silhouette;
        silhouette.host = name;
        silhouette.camera = camera;
        silhouette.capture_time = now_ + -delay + offset;
        silhouette.clock_epoch = epoch;
        silhouette.has_picture = has_picture;
        silhouette.contour_sizes = {3};
        silhouette.vertices_px = {{1, 2}, {3, 4}, {5, 6.25}};
        std::vector<capture::CameraFrame> frames;
        table_.add(silhouette, now_, steady_, frames);
        return frames;
    }
    void pass(nanoseconds time) {
        now_ = now_ + time;
        steady_ += time;
    }
    HostState state(std::size_t index) { return table_.statuses()[index].state; }
    std::string events() {
        std::string lines;
        for (const auto& event : table_.take_events()) lines += event.line + "\n";
        return lines;
    }

    Timestamp now_{1'700'000'000'000'000'000};
    HostTable::Time steady_{std::chrono::hours(1)};
    HostTable table_{{"a", "b", "c", "d"},
                     {host("left", {"a", "b"}), host("right", {"c"}), host("hall", {}, true)},
                     {kPeriod, milliseconds(100)}};
};

TEST_F(HostTableTest, AHostWithAnotherRigIsLeftOut) {
    ask("left", nanoseconds(0));
    bus::CameraSilhouette silhouette;
    silhouette.host = "left";
    silhouette.capture_time = now_;
    silhouette.clock_epoch = 1;
    silhouette.has_picture = true;
    silhouette.rig = 5;
    std::vector<capture::CameraFrame> frames;
    table_.add(silhouette, now_, steady_, frames);
    EXPECT_TRUE(frames.empty());
    EXPECT_EQ(state(0), HostState::kOtherRig);
    EXPECT_THAT(events(),
                HasSubstr("host_left_out host=left cameras=\"a b\" reason=\"its rig, its"));
    EXPECT_FALSE(see("left", 0).empty());  // started anew, with ours
    EXPECT_EQ(state(0), HostState::kInUse);
}

// Both auto hosts see the cameras of the other one as lost.
TEST_F(HostTableTest, ACameraBelongsToTheAutoHostThatSendsItsPictures) {
    table_ = HostTable({"a", "b"},
                       {host("left", {}, true), host("right", {}, true)},
                       {kPeriod, milliseconds(100)});
    const auto is_seen = [&](const std::string& name, std::uint32_t camera, bool has_picture) {
        const auto frames = see(name, camera, {}, milliseconds(4), 1, has_picture);
        return !frames.empty() && frames[0].camera == camera && !frames[0].is_lost();
    };
    const auto round = [&](bool left_has_b) {
        pass(kPeriod);
        for (const std::string name : {"left", "right"}) ask(name, nanoseconds(0));
        EXPECT_TRUE(is_seen("left", 0, true));
        EXPECT_TRUE(see("right", 0, {}, milliseconds(4), 1, false).empty());
        EXPECT_EQ(is_seen("left", 1, left_has_b), left_has_b);
        return is_seen("right", 1, !left_has_b);
    };
    // what comes before its clock is known claims the camera, too
    for (const std::string name : {"left", "right"}) ask(name, nanoseconds(0));
    see("left", 0);
    see("right", 1);
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(round(false)) << i;
    EXPECT_THAT(events(),
                testing::AllOf(HasSubstr("camera_found host=left camera=a"),
                               HasSubstr("camera_found host=right camera=b")));
    EXPECT_EQ(table_.statuses()[0].num_cameras, 1u);
    // plugged over: after a quarter of a second it is the other host's
    int num_lost = 0;
    for (int i = 0; i < 30; ++i) {
        pass(kPeriod);
        for (const std::string name : {"left", "right"}) ask(name, nanoseconds(0));
        see("left", 0);
        if (!is_seen("left", 1, true)) ++num_lost;
        see("right", 1, {}, milliseconds(4), 1, false);
    }
    EXPECT_LE(num_lost, 8);
    EXPECT_GE(num_lost, 6);
    EXPECT_FALSE(round(true));
    EXPECT_THAT(events(), HasSubstr("camera_found host=left camera=b"));
    EXPECT_EQ(table_.statuses()[0].num_cameras, 2u);
    EXPECT_EQ(table_.statuses()[1].num_cameras, 0u);
}

TEST_F(HostTableTest, UsesAHostOnceItsClockIsKnownAndCorrectsItsTimes) {
    EXPECT_TRUE(see("left", 0).empty());
    EXPECT_EQ(state(0), HostState::kClockUnknown);
    EXPECT_EQ(events(), "");
    ask("left", milliseconds(5));
    const auto frames = see("left", 1, milliseconds(5));
    ASSERT_EQ(state(0), HostState::kInUse);
    EXPECT_THAT(events(), HasSubstr("host_in_use host=left cameras=\"a b\" clock_offset_ms=5.00"));
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames[0].camera, 1u);
    EXPECT_LE(std::chrono::abs(frames[0].capture_time - (now_ + -milliseconds(4))),
              nanoseconds(200'100));
    ASSERT_NE(frames[0].found, nullptr);
    ASSERT_EQ(frames[0].found->contours_px.size(), 1u);
    EXPECT_EQ(frames[0].found->contours_px[0][2], Eigen::Vector2d(5, 6.25));
    EXPECT_EQ(table_.statuses()[0].num_left_out, 1u);
}

TEST_F(HostTableTest, ReportsThePicturesOfMissingHostsAsLost) {
    ask("left", nanoseconds(0));
    const auto frames = see("left", 0);
    std::vector<std::size_t> lost;
    for (const auto& frame : frames) {
        if (!frame.is_lost()) continue;
        lost.push_back(frame.camera);
        EXPECT_EQ(frame.capture_time, frames[0].capture_time);
    }
    EXPECT_THAT(lost, ElementsAre(2u, 3u));
}

TEST_F(HostTableTest, NamesAWrongClockAndTakesTheHostBackWhenItIsRight) {
    ask("left", milliseconds(20));
    EXPECT_TRUE(see("left", 0, milliseconds(20)).empty());
    EXPECT_EQ(state(0), HostState::kClockWrong);
    EXPECT_THAT(events(),
                HasSubstr("host_left_out host=left cameras=\"a b\" reason=\"its clock is "
                          "20.0 ms ahead of this host's, more than a quarter of the "
                          "period, 8.3 ms\""));
    EXPECT_NEAR(table_.statuses()[0].clock_offset_ms, 20.0, 0.2);
    see("left", 0, milliseconds(20));
    EXPECT_EQ(events(), "") << "told once";
    // set right: another epoch, which is measured first
    EXPECT_TRUE(see("left", 0, nanoseconds(0), milliseconds(4), 2).empty());
    ask("left", nanoseconds(0), 2);
    EXPECT_FALSE(see("left", 0, nanoseconds(0), milliseconds(4), 2).empty());
    EXPECT_EQ(state(0), HostState::kInUse);
}

TEST_F(HostTableTest, AClockNearTheLimitDoesNotComeAndGo) {
    ask("left", nanoseconds(8'400'000));
    see("left", 0, nanoseconds(8'400'000));
    EXPECT_EQ(state(0), HostState::kClockWrong);
    pass(std::chrono::seconds(6));
    ask("left", nanoseconds(8'200'000));
    see("left", 0, nanoseconds(8'200'000));
    EXPECT_EQ(state(0), HostState::kClockWrong);
}

TEST_F(HostTableTest, ASilentHostIsMissingAfterAQuarterSecond) {
    ask("left", nanoseconds(0));
    see("left", 0);
    events();
    pass(milliseconds(240));
    table_.look(steady_);
    EXPECT_EQ(state(0), HostState::kInUse);
    pass(milliseconds(20));
    table_.look(steady_);
    EXPECT_EQ(state(0), HostState::kMissing);
    EXPECT_THAT(events(), HasSubstr("host_left_out host=left"));
    see("left", 0);
    EXPECT_EQ(state(0), HostState::kInUse);
    EXPECT_THAT(events(), HasSubstr("host_in_use host=left"));
}

// This program was stopped: what came meanwhile waits to be taken.
TEST_F(HostTableTest, ItsOwnStandstillBlamesNobody) {
    table_.look(steady_);
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    see("left", 0);
    see("right", 2);
    events();
    pass(milliseconds(2000));
    table_.look(steady_);
    see("left", 0);
    pass(milliseconds(100));
    table_.look(steady_);
    EXPECT_EQ(events(), "");
    pass(milliseconds(100));
    table_.look(steady_);
    EXPECT_THAT(events(), HasSubstr("host_left_out host=right")) << "it was lost meanwhile";
    EXPECT_EQ(state(0), HostState::kInUse);
    for (int i = 0; i < 3; ++i) {  // again and again
        pass(milliseconds(300));
        table_.look(steady_);
    }
    EXPECT_EQ(state(0), HostState::kMissing);
}

TEST_F(HostTableTest, TellsOfHostsThatNeverComeAfterAWhile) {
    table_.look(steady_);
    pass(milliseconds(2900));
    table_.look(steady_);
    EXPECT_EQ(events(), "");
    pass(milliseconds(200));
    table_.look(steady_);
    EXPECT_THAT(events(),
                HasSubstr("host_left_out host=right cameras=\"c\" reason=\"nothing comes"));
}

TEST_F(HostTableTest, LeavesOutAHostWhoseSilhouettesComeTooLate) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    for (int i = 0; i < 10; ++i) {
        see("right", 2);
        see("left", 0, nanoseconds(0), milliseconds(130));
    }
    EXPECT_EQ(see("left", 0, nanoseconds(0), milliseconds(130)).front().camera, 0u);
    EXPECT_EQ(state(0), HostState::kLate);
    EXPECT_EQ(state(1), HostState::kInUse);
    EXPECT_THAT(events(), HasSubstr("come 130 ms after their pictures"));
    for (int i = 0; i < 11; ++i) see("left", 0);
    EXPECT_EQ(state(0), HostState::kInUse);
}

// The assembler waits from the first picture on.
TEST_F(HostTableTest, WhenAllAreSlowNobodyIsLate) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    for (int i = 0; i < 20; ++i) {
        see("right", 2, nanoseconds(0), milliseconds(130));
        see("left", 0, nanoseconds(0), milliseconds(150));
    }
    EXPECT_EQ(state(0), HostState::kInUse);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(HostTableTest, RefusesACameraOfAnotherHostAndOneThatDoesNotExist) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    EXPECT_TRUE(see("right", 0).empty());
    EXPECT_THAT(events(), HasSubstr("host_unknown host=right camera=0"));
    for (std::uint32_t i = 0; i < 100; ++i) EXPECT_TRUE(see("stranger", i).empty());
    EXPECT_THAT(events(), HasSubstr("host_unknown host=stranger camera=0"));
    EXPECT_TRUE(see("right", 0).empty());
    EXPECT_EQ(events(), "") << "each once, and some tens at most";
}

TEST_F(HostTableTest, AFreeCameraBelongsToTheHostThatTakesAny) {
    ask("hall", nanoseconds(0));
    ask("left", nanoseconds(0));
    EXPECT_FALSE(see("hall", 3).empty());
    EXPECT_EQ(table_.statuses()[2].num_cameras, 1u);
    EXPECT_TRUE(see("left", 3).empty());
    EXPECT_TRUE(see("hall", 0).empty());
}

TEST_F(HostTableTest, WhenItsOwnClockIsSetItMeasuresAnew) {
    ask("left", nanoseconds(0));
    EXPECT_FALSE(see("left", 0).empty());
    table_.forget_clocks(steady_);
    EXPECT_TRUE(see("left", 0).empty());
    EXPECT_EQ(state(0), HostState::kClockUnknown);
    ask("left", milliseconds(3));
    EXPECT_TRUE(see("left", 0, milliseconds(3)).empty())
        << "metaframes wait for pictures by the former clock";
    pass(milliseconds(101));
    EXPECT_FALSE(see("left", 0, milliseconds(3)).empty());
}

// Silhouettes that come between the moment and the notice of it have delays by the wrong clock.
TEST_F(HostTableTest, SettingItsOwnClockBackMakesNobodyLate) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    see("right", 2);
    now_ = now_ + -std::chrono::seconds(5);
    see("right", 2, std::chrono::seconds(5));
    table_.forget_clocks(steady_);
    pass(milliseconds(101));
    // only one of the hosts is set, too
    ask("left", nanoseconds(0), 2);
    ask("right", std::chrono::seconds(5));
    for (int i = 0; i < 20; ++i) {
        see("left", 0, nanoseconds(0), milliseconds(4), 2);
        see("right", 2, std::chrono::seconds(5));
    }
    EXPECT_EQ(state(1), HostState::kClockWrong);
    EXPECT_EQ(state(0), HostState::kInUse);
}

// Its times are ahead although its clock is right: a fault of its cameras.
TEST_F(HostTableTest, PicturesOfTheFutureMakeNobodyLate) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    for (int i = 0; i < 20; ++i) {
        pass(kPeriod);
        EXPECT_FALSE(see("left", 0).empty());
        EXPECT_TRUE(see("right", 2, nanoseconds(0), -milliseconds(200)).empty());
    }
    EXPECT_EQ(state(0), HostState::kInUse);
    EXPECT_EQ(table_.statuses()[1].num_left_out, 20u);
}

TEST_F(HostTableTest, KnowsWhereACameraHangs) {
    EXPECT_TRUE(table_.has_camera("left", 0) && !table_.has_camera("right", 0));
    EXPECT_TRUE(table_.has_camera("hall", 3));
    EXPECT_FALSE(table_.has_camera("stranger", 3));
    EXPECT_FALSE(table_.has_camera("hall", 4));
}

// What it was before its clock was wrong is no measure for the others: all may be slower by now.
TEST_F(HostTableTest, AHostOfWrongClockMakesNobodyLate) {
    ask("left", nanoseconds(0));
    ask("right", nanoseconds(0));
    see("right", 2);
    ask("right", milliseconds(20), 2);
    see("right", 2, milliseconds(20), milliseconds(4), 2);
    ASSERT_EQ(state(1), HostState::kClockWrong);
    for (int i = 0; i < 20; ++i) see("left", 0, nanoseconds(0), milliseconds(130));
    EXPECT_EQ(state(0), HostState::kInUse);
}

// Whatever a hostile program of the world sends: no overflow, no picture of a wrong time.
TEST_F(HostTableTest, SurvivesHostileTimesAndNames) {
    std::mt19937_64 random(5);
    const auto time = [&]() -> Timestamp {
        switch (random() % 4) {
            case 0:
                return {0};
            case 1:
                return {bus::kMaxTime_ns};
            case 2:
                return {static_cast<std::int64_t>(random() >> 2U)};
            default:
                return now_ + milliseconds(static_cast<int>(random() % 100) - 50);
        }
    };
    const char* names[] = {"left", "right", "hall", "nobody"};
    for (int i = 0; i < 20'000; ++i) {
        bus::ClockAnswer answer;
        answer.host = names[random() % 4];
        answer.asked = time();
        answer.received = time();
        answer.answered = time();
        answer.clock_epoch = random() % 7;
        table_.add(answer, now_, steady_);
        bus::CameraSilhouette silhouette;
        silhouette.host = names[random() % 4];
        silhouette.camera = static_cast<std::uint32_t>(random() % 6);
        silhouette.capture_time = time();
        silhouette.clock_epoch = random() % 7;
        silhouette.has_picture = random() % 2 == 0;
        std::vector<capture::CameraFrame> frames;
        table_.add(silhouette, now_, steady_, frames);
        for (const auto& frame : frames) {
            ASSERT_LT(frame.camera, 4u);
            ASSERT_LE(std::chrono::abs(frame.capture_time - now_), std::chrono::seconds(10));
        }
        if (i % 10 == 0) table_.look(steady_);
        table_.take_events();
        pass(milliseconds(static_cast<int>(random() % 20)));
    }
}

}  // namespace
}  // namespace atrium::hosts
