// What becomes of a calibration: the report, the rig that it replaces, and the frame that it keeps.
#include "tools/calibrate/report/report.hpp"

#include "swept_room.hpp"
#include "tools/calibrate/finish_calibration.hpp"
#include "tools/calibrate/report/drawings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using calibrate_test::sweep;
using calibrate_test::SweepOptions;
using calibrate_test::SweptRoom;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

class Report : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("atrium-report-" + std::to_string(getpid()));
        fs::create_directories(folder_);
        file_ = folder_ / "lab.toml";
    }
    void TearDown() override { fs::remove_all(folder_); }

    static SweepOptions small_room(std::uint32_t sweep_seed) {
        SweepOptions options;
        options.num_cameras = 5;
        options.num_instants = 150;
        options.sweep_seed = sweep_seed;
        return options;
    }

    Expected<void> calibrate(const SweepOptions& room_options,
                             const Wand& wand = default_wand(),
                             const std::function<void(FinishOptions&)>& change = {}) {
        const SweptRoom room = sweep(default_wand(), room_options);
        WandOptions how;
        how.num_threads = 2;
        const auto solution = solve_wand(wand, room.nominal, room.points, how);
        if (!solution) return tl::unexpected(solution.error());
        FinishOptions options;
        options.command = "calibrate wand";
        options.source = "sweep.csv";
        options.body = "the wand";
        options.output = file_;
        if (change) change(options);
        const auto previous = find_previous_rig(file_, {}, options.force);
        if (!previous) return tl::unexpected(previous.error());
        return finish_calibration(*solution, judge_wand(*solution, 30.0), *previous, options);
    }

    nlohmann::json json() const {
        return nlohmann::json::parse(text_of(folder_ / "calibration.json"));
    }
    std::size_t num_rigs() const {
        std::size_t count = 0;
        for (const auto& entry : fs::directory_iterator(folder_))
            count += entry.path().extension() == ".toml" ? 1 : 0;
        return count;
    }

    fs::path folder_, file_;
};

// A camera that somebody bumped is named, the others and the floor stay, and the old rig is kept.
TEST_F(Report, ComparesWithTheRigThatItReplaces) {
    ASSERT_TRUE(calibrate(small_room(5), default_wand(), [](FinishOptions& options) {
        options.said.heights = {{"cam0", 2.0}};
        options.said.rate_hz = 25.0;
    }));
    const auto before = config::load_rig(file_);
    ASSERT_TRUE(before) << before.error().message;
    EXPECT_EQ(json()["previous"], nullptr);
    EXPECT_EQ(json()["grade"], "good");
    EXPECT_EQ(json()["cameras"].size(), 5U);
    EXPECT_LT(json()["cameras"][0]["held_out_px"].get<double>(), 0.3);

    SweepOptions bumped = small_room(6);
    bumped.change = [](std::vector<geometry::CalibratedCamera>& cameras) {
        cameras[3].camera_from_site.translation.x() += 0.04;
        cameras[3].camera_from_site =
            geometry::RigidTransform{
                Eigen::Quaterniond(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY())),
                Eigen::Vector3d::Zero()} *
            cameras[3].camera_from_site;
    };
    const auto again = calibrate(bumped);
    ASSERT_TRUE(again) << again.error().message;
    const auto after = config::load_rig(file_);
    ASSERT_TRUE(after) << after.error().message;
    for (std::size_t c = 0; c < 5; ++c) {
        const double moved =
            (after->cameras[c].centre_site() - before->cameras[c].centre_site()).norm();
        if (c == 3) {
            EXPECT_GT(moved, 0.02);
        } else {
            EXPECT_LT(moved, 0.006) << c << ": the frame is that of the rig before";
        }
    }
    EXPECT_EQ(num_rigs(), 2U) << "the rig before is kept";
    const nlohmann::json report = json();
    EXPECT_THAT(report["told"].dump(), HasSubstr("camera 'cam3' was moved by "));
    EXPECT_THAT(report["told"].dump(), HasSubstr("4 of 5 cameras stand where they do"));
    for (const auto& camera : report["previous"]["cameras"])
        EXPECT_EQ(camera["stays"], camera["name"] != "cam3") << camera;
}

TEST_F(Report, LeavesARigThatIsStillTrue) {
    ASSERT_TRUE(calibrate(small_room(5)));
    const std::string before = text_of(file_);
    ASSERT_TRUE(calibrate(small_room(6)));
    EXPECT_EQ(text_of(file_), before);
    EXPECT_EQ(num_rigs(), 1U);
    EXPECT_THAT(json()["outcome"].get<std::string>(), HasSubstr("kept "));
    ASSERT_TRUE(calibrate(
        small_room(6), default_wand(), [](FinishOptions& options) { options.force = true; }));
    EXPECT_NE(text_of(file_), before);
    EXPECT_EQ(num_rigs(), 2U);
}

// Nothing in the sweep tells lengths that are all wrong; the rig before and a tape do.
TEST_F(Report, RefusesAWandOfOtherLengths) {
    ASSERT_TRUE(calibrate(small_room(5)));
    const std::string before = text_of(file_);
    Wand longer = default_wand();
    for (Eigen::Vector3d& light : longer.lights_m) light *= 1.04;
    const auto refused = calibrate(small_room(6), longer);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("stays as it was"));
    EXPECT_EQ(text_of(file_), before);
    EXPECT_THAT(json()["problems"].dump(),
                HasSubstr("all distances between cameras are 4.0 % longer than in lab.toml"));
    EXPECT_EQ(json()["grade"], "wrong");
    EXPECT_THAT(json()["told"][0].get<std::string>(),
                HasSubstr("wrong, though its errors are small"));

    fs::remove(file_);
    const SweptRoom room = sweep(default_wand(), small_room(6));
    const double apart = (room.cameras[0].centre_site() - room.cameras[2].centre_site()).norm();
    const auto by_tape = [&](FinishOptions& options) {
        options.said.distance = {"cam0", "cam2", std::round(apart * 100.0) / 100.0};
    };
    EXPECT_FALSE(calibrate(small_room(6), longer, by_tape));
    EXPECT_THAT(json()["problems"].dump(), HasSubstr("measure the lengths of the wand"));
    EXPECT_TRUE(calibrate(small_room(6), default_wand(), by_tape));
    EXPECT_THAT(json()["told"].dump(), HasSubstr("% off your tape"));
}

TEST_F(Report, TurnsTheFrontTowardsACamera) {
    const auto azimuth_of = [&](std::size_t camera) {
        const auto rig = config::load_rig(file_);
        EXPECT_TRUE(rig);
        const Eigen::Vector3d place = rig->cameras[camera].centre_site();
        return std::atan2(place.y(), place.x());
    };
    ASSERT_TRUE(calibrate(small_room(5)));
    EXPECT_NEAR(azimuth_of(0), 0.0, 1e-6) << "by default the first";
    EXPECT_THAT(json()["checks"].dump(), HasSubstr("towards 'cam0' look along +X"));
    ASSERT_TRUE(calibrate(small_room(6), default_wand(), [](FinishOptions& options) {
        options.front = "cam3";
    })) << "a new frame is asked for, though the rig is still true";
    EXPECT_NEAR(azimuth_of(3), 0.0, 1e-6);
    EXPECT_EQ(num_rigs(), 2U);
    const auto wrong = calibrate(
        small_room(6), default_wand(), [](FinishOptions& options) { options.front = "door"; });
    ASSERT_FALSE(wrong);
    EXPECT_THAT(wrong.error().message, HasSubstr("--front door: no camera has this name"));
}

TEST_F(Report, DoesNotReplaceWhatIsNoRig) {
    std::ofstream(file_) << "site = \"lab\"\n";
    const auto refused = find_previous_rig(file_, {}, false);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("exists already and is no rig"));
    EXPECT_TRUE(find_previous_rig(file_, {}, true));
    EXPECT_FALSE(find_previous_rig(folder_ / "new.toml", folder_ / "missing.toml", true));
}

TEST_F(Report, KeepsEveryOldRig) {
    std::ofstream(file_) << "first";
    const auto one = keep_old_rig(file_), two = keep_old_rig(file_);
    ASSERT_TRUE(one && two);
    EXPECT_NE(*one, *two) << "also within a second";
    EXPECT_EQ(text_of(*one), "first");
    EXPECT_EQ(one->extension(), ".toml");
    EXPECT_FALSE(keep_old_rig(folder_ / "missing.toml"));
}

CalibrationReport hostile_report() {
    CalibrationReport report;
    report.command = "calibrate wand";
    report.source = "<script>alert(1)</script> & \"more\".csv";
    report.told = {"good: <b>0.2</b> px", "second\nline\x01"};
    report.problems = {"a < b && c > d"};
    report.outcome = "wrote a&b.toml";
    SweepOptions options;
    options.num_instants = 0;
    for (const geometry::CalibratedCamera& camera : sweep(default_wand(), options).cameras) {
        ReportedCamera one;
        one.camera = camera;
        for (int i = 0; i < 3000; ++i)
            one.errors.push_back({{i % 1280, i % 1024}, {0.1, -0.1}, i % 50 == 0});
        report.cameras.push_back(one);
    }
    return report;
}

// The page is also XML, so that a parser finds what is not closed or not escaped.
TEST(ReportPage, IsWholeAndLoadsNothing) {
    const std::string page = report_page(hostile_report());
    pugi::xml_document parsed;
    const auto result = parsed.load_string(page.c_str(), pugi::parse_default | pugi::parse_doctype);
    ASSERT_TRUE(result) << result.description() << " at " << page.substr(result.offset, 80);
    EXPECT_THAT(page, Not(HasSubstr("<script")));
    EXPECT_THAT(page, Not(HasSubstr("http")));
    EXPECT_THAT(page, Not(HasSubstr("url(")));
    EXPECT_EQ(parsed.select_nodes("//svg").size(), 2U + 2U * 8U);
    EXPECT_EQ(parsed.select_nodes("//table").size(), 1U) << "no rig before";
    const std::string text = parsed.select_node("//li[@class='problem']").node().text().get();
    EXPECT_EQ(text, "a < b && c > d");
    EXPECT_LT(page.size(), 2'000'000U) << "points are thinned out";
}

TEST(ReportPage, DrawsRoomsOfAnySize) {
    CalibrationReport report = hostile_report();
    for (const double scale : {0.0, 1e-6, 1.0, 1e6}) {
        CalibrationReport scaled = report;
        for (ReportedCamera& one : scaled.cameras) one.camera.camera_from_site.translation *= scale;
        const std::string drawing = draw_rig(scaled, 30.0, 15.0);
        EXPECT_THAT(drawing, Not(HasSubstr("nan"))) << scale;
        EXPECT_THAT(drawing, Not(HasSubstr("inf"))) << scale;
        EXPECT_LT(drawing.size(), 400'000U) << scale;
    }
    report.cameras.clear();
    EXPECT_THAT(report_page(report), HasSubstr("Calibration of 0 cameras"));
}

TEST(ReportJson, SurvivesBytesThatAreNoText) {
    CalibrationReport report = hostile_report();
    report.source = "sweep\xff.csv";
    report.cameras[0].held_out_px = std::numeric_limits<double>::quiet_NaN();
    const nlohmann::json json = nlohmann::json::parse(report_json(report));
    EXPECT_EQ(json["cameras"].size(), 8U);
    EXPECT_TRUE(json["cameras"][0]["held_out_px"].is_null());
}

}  // namespace
}  // namespace atrium::calibrate
