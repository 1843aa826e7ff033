// From pictures of a simulated sweep to cameras, and what a sweep says while it lasts.
#include "simulation/wand_room.hpp"
#include "swept_room.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"
#include "tools/calibrate/sweep/detect_lights.hpp"
#include "tools/calibrate/sweep/resting_wand.hpp"
#include "tools/calibrate/sweep/sweep_tally.hpp"
#include "tools/calibrate/wand/judge_wand.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace atrium::calibrate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kRate_hz = 30.0;

config::Rig room_of(int num_cameras, int width, int height) {
    config::Rig rig;
    rig.cameras = simulation::ring(num_cameras, width, height);
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
        geometry::PinholeCamera& lens = rig.cameras[c].intrinsics;
        lens.cx += 3.0 * static_cast<double>(c) - 8.0;
        lens.distortion = {-0.15, 0.05, 2e-4, -3e-4, 0.0};
    }
    rig.bounds_site = {{-1.0, -1.0, 0.1}, {1.0, 1.0, 2.1}};
    rig.rate_hz = kRate_hz;
    return rig;
}

std::vector<NominalCamera> nominal_of(const config::Rig& rig) {
    std::vector<NominalCamera> nominal;
    for (const geometry::CalibratedCamera& camera : rig.cameras)
        nominal.push_back({camera.name, camera.intrinsics.width, camera.intrinsics.height, 0.0});
    return nominal;
}

// Shows pictures of the room to a tally.
class Watching {
public:
    Watching(const config::Rig& rig, const simulation::WandRoomOptions& options)
        : room_(rig, options),
          num_cameras_(rig.cameras.size()),
          detectors_(num_cameras_, LightDetector(DetectionOptions{})) {}

    std::vector<std::optional<DetectedLights>> at(std::uint32_t instant) {
        const double time_s = instant / kRate_hz;
        std::vector<std::optional<DetectedLights>> seen(num_cameras_);
        for (std::size_t c = 0; c < num_cameras_; ++c) {
            if (room_.is_lost(time_s, c)) continue;
            room_.render(time_s, c, plane_);
            image::YuvView view;
            view.y = plane_;
            detectors_[c].detect(view, seen[c].emplace());
        }
        return seen;
    }
    const simulation::WandRoom& room() const { return room_; }

private:
    simulation::WandRoom room_;
    std::size_t num_cameras_;
    std::vector<LightDetector> detectors_;
    image::Plane plane_;
};

// Eight cameras of 1.3 MP, a lamp, reflections and hot pixels in each, 5 ms of motion in each
// picture, 2 % of the pictures lost.
TEST(SweptPictures, GiveTheCameras) {
    const config::Rig rig = room_of(8, 1280, 1024);
    Watching watching(rig, {.exposure_ms = 5.0, .lost_percent = 2.0, .noise_lsb = 2.0, .seed = 4});
    const std::uint32_t num_instants = test::kSanitized ? 60 : 240;
    auto tally = SweepTally::make(default_wand(), nominal_of(rig), {num_instants, kRate_hz});
    ASSERT_TRUE(tally) << tally.error().message;
    double sum = 0.0;
    std::size_t num_found = 0, num_shown = 0;
    for (std::uint32_t i = 0; i < num_instants; ++i) {
        const std::uint32_t instant = i * (test::kSanitized ? 4 : 1);
        const auto seen = watching.at(instant);
        tally->add(instant, seen);
        for (std::size_t c = 0; c < seen.size(); ++c) {
            if (!seen[c]) continue;
            for (const auto& truth : watching.room().lights_px(instant / kRate_hz, c)) {
                if (!truth) continue;
                ++num_shown;
                for (const DetectedLight& light : seen[c]->lights) {
                    const double off = (light.px - *truth).norm();
                    if (off > 2.0) continue;
                    sum += off * off;
                    ++num_found;
                    break;
                }
            }
        }
    }
    EXPECT_GT(num_found, num_shown * 9 / 10);
    EXPECT_LT(std::sqrt(sum / (2.0 * static_cast<double>(num_found))), 0.1) << "of the detection";
    EXPECT_THAT(tally->take_warnings(), IsEmpty());
    EXPECT_EQ(tally->why_too_little(), "");

    calibrate_test::SweptRoom truth;
    truth.cameras = rig.cameras;
    const LightPoints points = tally->points();
    WandOptions options;
    options.num_threads = 2;
    const auto solution = solve_wand(default_wand(), nominal_of(rig), points, options);
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_LE(solution->held_out_px, 0.25);
    EXPECT_LT(calibrate_test::centres_rms_m(truth, *solution), 0.002);
    EXPECT_THAT(judge_wand(*solution, kRate_hz).problems, IsEmpty());
    RecordProperty("detection_px",
                   std::to_string(std::sqrt(sum / (2.0 * static_cast<double>(num_found)))));
    RecordProperty("held_out_px", std::to_string(solution->held_out_px));
    RecordProperty("centres_mm",
                   std::to_string(1000.0 * calibrate_test::centres_rms_m(truth, *solution)));
}

TEST(WandRoom, GivesTheSamePicturesAgain) {
    const config::Rig rig = room_of(2, 320, 240);
    const simulation::WandRoom first(rig, {.seed = 3}), again(rig, {.seed = 3}),
        other(rig, {.seed = 4});
    image::Plane a, b, c;
    first.render(1.5, 1, a);
    again.render(0.5, 0, b);
    again.render(1.5, 1, b);
    other.render(1.5, 1, c);
    EXPECT_EQ(a.data, b.data);
    EXPECT_NE(a.data, c.data);
}

// Lights where a test says.
DetectedLights lights_at(const std::vector<Eigen::Vector2d>& places) {
    DetectedLights found;
    found.background = 10.0;
    found.noise = 1.0;
    found.threshold = 8.0;
    for (const Eigen::Vector2d& px : places) {
        DetectedLight& light = found.lights.emplace_back();
        light.px = px;
        light.contrast = 100.0;
    }
    return found;
}

// The default wand, upright, with its end at `start`.
std::vector<Eigen::Vector2d> wand_at(double x, double y) {
    std::vector<Eigen::Vector2d> places;
    for (const double along : {0.0, 10.0, 30.0, 60.0}) places.emplace_back(x, y + along);
    return places;
}

class Tallying : public testing::Test {
protected:
    void begin(std::size_t num_cameras, std::size_t num_instants = 40) {
        std::vector<NominalCamera> cameras;
        for (std::size_t c = 0; c < num_cameras; ++c)
            cameras.push_back({"cam" + std::to_string(c), 640, 480, 0.0});
        auto made = SweepTally::make(default_wand(), cameras, {num_instants, kRate_hz});
        ASSERT_TRUE(made);
        tally_.emplace(std::move(*made));
    }
    using Seen = std::vector<std::optional<DetectedLights>>;
    void show(const Seen& seen) { tally_->add(instant_++, seen); }

    std::optional<SweepTally> tally_;
    std::uint32_t instant_ = 0;
};

TEST_F(Tallying, CountsAWandThatMovesBeforeTwoCameras) {
    begin(3);
    for (int i = 0; i < 20; ++i)
        show({lights_at(wand_at(100, 100)), lights_at(wand_at(50, 50)), {}});
    EXPECT_EQ(tally_->num_instants(), 1U) << "it rests";
    for (int i = 0; i < 20; ++i)
        show({lights_at(wand_at(120 + 20 * i, 100)), lights_at({}), lights_at({})});
    EXPECT_EQ(tally_->num_instants(), 1U) << "one camera sees it";
    for (int i = 0; i < 20; ++i)
        show({lights_at(wand_at(120 + 20 * i, 300)), {}, lights_at(wand_at(90 + 20 * i, 40))});
    EXPECT_EQ(tally_->num_instants(), 21U);
    EXPECT_EQ(tally_->cameras()[1].num_instants, 1U);
    EXPECT_EQ(tally_->cameras()[2].num_instants, 20U);
}

TEST_F(Tallying, LeavesOutLampsThatStay) {
    begin(2);
    const Eigen::Vector2d lamp(400.5, 300.25);
    for (int i = 0; i < 60; ++i) {
        auto places = wand_at(20 + 9 * i, 200);
        places.push_back(lamp);
        show({lights_at(places), lights_at(wand_at(20 + 9 * i, 100))});
    }
    const LightPoints points = tally_->points();
    for (const LightPoint& point : points[0].points) EXPECT_GT((point.px - lamp).norm(), 1.5);
    EXPECT_GE(points[0].points.size(), 4U * 59U - 4U) << "the wand passed the lamp";
    EXPECT_EQ(points[1].points.size(), 240U);
}

TEST_F(Tallying, EndsWhenEachCameraHasEnoughEverywhere) {
    begin(2);
    const auto sweep_to = [&](double low, double high, double right) {
        for (double y = low; y < high; y += 30.0)
            for (double x = 10.0; x < right; x += 30.0)
                show({lights_at(wand_at(x, y)), lights_at(wand_at(x, 120.0 + 0.5 * y))});
    };
    sweep_to(10.0, 130.0, 320.0);
    EXPECT_GE(tally_->num_instants(), 40U);
    EXPECT_FALSE(tally_->is_complete());
    EXPECT_THAT(tally_->progress(), HasSubstr("sweep: 40 of 40 instants"));
    EXPECT_THAT(tally_->need_of(0), HasSubstr("% of its picture, sweep its lower left"));
    sweep_to(130.0, 410.0, 630.0);
    EXPECT_TRUE(tally_->is_complete());
    EXPECT_EQ(tally_->need_of(0), "");
    EXPECT_THAT(tally_->progress(), HasSubstr("enough: cam0, cam1"));
}

TEST_F(Tallying, AsksForALinkBetweenPairsOfCameras) {
    begin(4, 60);
    for (const bool is_first : {true, false}) {
        for (double y = 10.0; y < 410.0; y += 40.0) {
            for (double x = 10.0; x < 630.0; x += 60.0) {
                const DetectedLights wand = lights_at(wand_at(x, y)), none = lights_at({});
                is_first ? show({wand, wand, none, none}) : show({none, none, wand, wand});
            }
        }
    }
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(tally_->need_of(c), "");
    EXPECT_FALSE(tally_->is_complete());
    EXPECT_THAT(tally_->progress(),
                HasSubstr("sweep where cam2, cam3 and the others see the wand at once"));
}

TEST_F(Tallying, WarnsOfCamerasThatCannotSeeTheWand) {
    begin(4);
    std::mt19937 rng(1);
    for (int i = 0; i < 160; ++i) {
        DetectedLights bright = lights_at({});
        bright.background = 140.0;
        std::vector<Eigen::Vector2d> crowd;
        for (int k = 0; k < 40; ++k)
            crowd.emplace_back(static_cast<double>(rng() % 640), static_cast<double>(rng() % 480));
        show({lights_at({}), bright, lights_at(crowd), {}});
    }
    EXPECT_THAT(
        tally_->take_warnings(),
        testing::UnorderedElementsAre(
            HasSubstr("camera 'cam0' sees no light: is it covered, or its exposure too long or"),
            HasSubstr("camera 'cam1': the picture is bright all over (140 of 255): shorten"),
            HasSubstr("camera 'cam2' sees 24 bright spots or more: cover lamps"),
            HasSubstr("camera 'cam3' sends no pictures")));
    EXPECT_THAT(tally_->take_warnings(), IsEmpty());
    const std::string why = tally_->why_too_little();
    EXPECT_THAT(why, HasSubstr("only 0 instants show the moving wand in two cameras"));
    EXPECT_THAT(why, HasSubstr("'cam0' saw no light"));
    EXPECT_THAT(why, HasSubstr("'cam1' is bright all over"));
    EXPECT_THAT(why, HasSubstr("'cam3' sent no picture"));
}

TEST_F(Tallying, ShortensItsLineForATerminal) {
    begin(8);
    show({{}, {}, {}, {}, {}, {}, {}, {}});
    EXPECT_GT(tally_->progress().size(), 200U);
    for (const std::size_t columns : {60U, 80U, 120U}) {
        EXPECT_LE(tally_->progress(columns).size(), columns);
        EXPECT_THAT(tally_->progress(columns), testing::EndsWith("; ..."));
    }
}

TEST(SweepTally, RefusesWandsWhoseLightsLookAlike) {
    const auto made = SweepTally::make({{{0, 0, 0}, {0.5, 0, 0}}}, {{"a", 640, 480, 0.0}}, {});
    ASSERT_FALSE(made);
    EXPECT_THAT(made.error().message, HasSubstr("look alike"));
}

class LayingTheWand : public testing::Test {
protected:
    void begin(const Wand& wand) {
        std::vector<NominalCamera> cameras;
        for (const char* name : {"cam0", "cam1", "cam2"}) cameras.push_back({name, 640, 480, 0.0});
        auto made = RestingWand::make(wand, cameras);
        ASSERT_TRUE(made) << made.error().message;
        resting_.emplace(std::move(*made));
    }
    // Before cam0 and cam1, with some noise.
    void rest(double x, double y, int num) {
        for (int i = 0; i < num; ++i)
            resting_->add({lights_at(wand_at(x + 0.2 * (i % 3), y)),
                           lights_at(wand_at(y, x - 0.2 * (i % 2))),
                           lights_at({})});
    }
    std::optional<RestingWand> resting_;
};

TEST_F(LayingTheWand, TakesThreePlacesOfAWandOnALine) {
    begin(default_wand());
    EXPECT_EQ(resting_->progress(),
              "floor: 0 of 3 places; lay the wand down where two cameras see it");
    for (int i = 0; i < 40; ++i) rest(20 + 9 * i, 200, 1);
    EXPECT_EQ(resting_->num_places(), 0u) << "it is carried";
    rest(400, 100, 10);
    EXPECT_THAT(resting_->progress(),
                HasSubstr("the wand rests before cam0, cam1: 10 of 15 instants"));
    rest(400, 100, 60);
    EXPECT_EQ(resting_->num_places(), 1u) << "it rests where it was";
    rest(100, 100, 20);
    rest(100, 300, 20);
    ASSERT_TRUE(resting_->is_complete());
    const LightPoints& points = resting_->points();
    ASSERT_EQ(points.size(), 3u);
    ASSERT_EQ(points[0].points.size(), 12u);
    EXPECT_TRUE(points[2].points.empty());
    EXPECT_NEAR(points[0].points[0].px.x(), 400.2, 1e-9) << "the median";
    EXPECT_EQ(points[0].points[7].light, 3u);
    EXPECT_EQ(points[0].points[7].instant, 1u);
    EXPECT_EQ(points[0].points[7].px.y(), 160.0);
}

TEST_F(LayingTheWand, DoesNotCountWhatOneCameraSees) {
    begin(default_wand());
    for (int i = 0; i < 40; ++i) resting_->add({lights_at(wand_at(100, 100)), lights_at({}), {}});
    EXPECT_EQ(resting_->num_places(), 0u);
}

TEST_F(LayingTheWand, NamesAWandOfOtherDistances) {
    begin({{{0, 0, 0}, {0.1, 0, 0}, {0.35, 0, 0}, {0.6, 0, 0}}});
    rest(100, 100, 10);
    EXPECT_FALSE(resting_->sees_other_wand()) << "two cameras, ten instants";
    rest(100, 100, 10);
    ASSERT_TRUE(resting_->sees_other_wand());
    EXPECT_THAT(
        resting_->progress(),
        HasSubstr("floor: 0 of 3 places; 40 pictures show 4 lights or more, but none at the "
                  "distances that the wand has: is --wand the file of this wand?"));
    EXPECT_EQ(resting_->num_places(), 0u);
    begin(default_wand());
    rest(100, 100, 60);
    EXPECT_FALSE(resting_->sees_other_wand());
}

TEST_F(LayingTheWand, TakesOnePlaceOfAFlatWand) {
    begin({{{0, 0, 0}, {0.5, 0, 0}, {0, 0.3, 0}, {0.15, 0, 0}, {0.5, 0.1, 0}}});
    EXPECT_EQ(resting_->num_needed(), 1u);
}

TEST(RestingWand, RefusesWandsWhoseLightsLookAlike) {
    for (const Wand& wand : {Wand{{{0, 0, 0}}}, Wand{{{0, 0, 0}, {0.5, 0, 0}}}}) {
        const auto made = RestingWand::make(wand, {{"a", 640, 480, 0.0}});
        ASSERT_FALSE(made);
        EXPECT_THAT(made.error().message, HasSubstr("whose lights can be told apart"));
    }
}

}  // namespace
}  // namespace atrium::calibrate
