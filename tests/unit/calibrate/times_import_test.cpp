// Pictures whose names have times become a recording.
#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

#include <array>
#include <functional>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using test::ImportedRecording;
using test::write_picture;

constexpr std::uint64_t kStartMs = 1'779'186'104'123;
constexpr int kNumInstants = 12;

class ImportedTimes : public ImportedRecording {
protected:
    using NameOf = std::function<std::string(std::uint64_t milliseconds)>;

    // Grey levels say camera and instant: 10 * camera + instant.
    void write(const fs::path& folder, int camera, const NameOf& name, int shift_ms = 0) {
        for (int i = 0; i < kNumInstants; ++i) {
            if (camera == 2 && i == 5) continue;  // lost
            const auto ms = static_cast<std::uint64_t>(i * 200 / 3 + shift_ms + (i + camera) % 5);
            write_picture(folder / (name(ms) + ".png"), 64, 48, 50 * camera + 3 * i);
        }
    }
    void write_all(const NameOf& name) {
        for (int camera = 1; camera <= 3; ++camera)
            write(take(fmt::format("cam{}", camera)), camera, name);
    }
    ImportReport expect_instants() {
        const auto report = import(options_);
        EXPECT_TRUE(report) << report.error().message;
        if (!report) return {};
        for (int camera = 1; camera <= 3; ++camera) {
            for (int i = 0; i < kNumInstants; ++i) {
                const fs::path file =
                    options_.output / fmt::format("cam{}/frames/{:06}.png", camera, i);
                if (camera == 2 && i == 5) {
                    EXPECT_FALSE(fs::exists(file));
                    continue;
                }
                const cv::Mat picture = cv::imread(file.string());
                EXPECT_FALSE(picture.empty()) << file;
                if (picture.empty()) continue;
                EXPECT_EQ(picture.at<cv::Vec3b>(0, 0)[0], 50 * camera + 3 * i) << file;
            }
        }
        const auto rig = config::load_rig(options_.output);
        EXPECT_NEAR(rig ? rig->rate_hz : 0.0, 15.0, 0.2);
        return *report;
    }
};

std::string unix_ms(std::uint64_t ms) { return fmt::format("{}", kStartMs + ms); }

TEST_F(ImportedTimes, InMillisecondsSinceAnyTime) {
    write_all(unix_ms);
    const ImportReport report = expect_instants();
    EXPECT_THAT(report.told,
                Contains(HasSubstr("the names of the pictures are times (milliseconds): 12")));
    EXPECT_THAT(report.checks,
                Contains(HasSubstr("By the times in the files' names, 'cam2' has "
                                   "no 177918610")));
    EXPECT_THAT(report.checks, Not(Contains(HasSubstr("is assumed"))));
}

TEST_F(ImportedTimes, AsDates) {
    write_all([](std::uint64_t ms) {
        return fmt::format(
            "x_2026-05-19_10-21-{:02}-{:03}", 44 + (ms + 700) / 1000, (ms + 700) % 1000);
    });
    EXPECT_THAT(expect_instants().told, Contains(HasSubstr("are times (dates)")));
}

TEST_F(ImportedTimes, AsDecimalsInOneFolder) {
    for (int camera = 1; camera <= 3; ++camera) {
        write(options_.recording, camera, [&](std::uint64_t ms) {
            return fmt::format("{}.{:03}_cam{}", (ms + 700) / 1000, (ms + 700) % 1000, camera);
        });
    }
    EXPECT_THAT(expect_instants().told, Contains(HasSubstr("are times (seconds)")));
}

TEST_F(ImportedTimes, ThatOnlyLookLikeTimes) {
    write_all([](std::uint64_t ms) { return fmt::format("{:06}", ms); });
    EXPECT_THAT(expect_instants().checks,
                Contains(HasSubstr("the numbers of the pictures look like times in milliseconds")));
}

TEST_F(ImportedTimes, BesideRunningNumbers) {
    for (int camera = 1; camera <= 3; ++camera) {
        int number = 0;
        write(take(fmt::format("cam{}", camera)), camera, [&](std::uint64_t ms) {
            return fmt::format("frame_{:06}_{}", number++, unix_ms(ms));
        });
    }
    expect_instants();
}

TEST_F(ImportedTimes, OfMasksAndRoomsFollowTheirPictures) {
    write_all(unix_ms);
    for (int camera = 1; camera <= 3; ++camera) {
        const std::string name = fmt::format("cam{}", camera);
        for (const auto& entry : fs::directory_iterator(take(name))) {
            cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(0));
            mask(cv::Rect(20, 10, 10, 30)).setTo(255);
            const fs::path file = folder_.path() / "masks" / name / entry.path().filename();
            fs::create_directories(file.parent_path());
            ASSERT_TRUE(cv::imwrite(file.string(), mask));
        }
        write(take("empty/" + name), camera, unix_ms, 90'000);
    }
    options_.masks = folder_.path() / "masks";
    expect_instants();
    EXPECT_TRUE(fs::exists(options_.output / "cam2/silhouettes/000004.png"));
    EXPECT_FALSE(fs::exists(options_.output / "cam2/silhouettes/000005.png"));
    EXPECT_TRUE(fs::exists(options_.output / "cam2/silhouettes/000006.png"));
    EXPECT_TRUE(fs::exists(options_.output / "cam2/background/000010.png"));
    EXPECT_FALSE(fs::exists(options_.output / "cam2/background/000011.png"));
}

TEST_F(ImportedTimes, OfClocksThatDifferAreNamed) {
    write(take("cam1"), 1, unix_ms);
    write(take("cam2"), 2, unix_ms);
    write(take("cam3"), 3, unix_ms, 3'600'000);
    auto report = import(options_);
    ASSERT_TRUE(report);
    EXPECT_THAT(report->problems,
                Contains(HasSubstr("camera 'cam3' left out: its pictures have "
                                   "the times 1779189704")));
    EXPECT_THAT(report->problems, Contains(HasSubstr("set its clock as those of the others")));
    options_.output = folder_.path() / "second";
    options_.cameras = {"cam[23]"};
    report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message, HasSubstr("the clocks of the cameras differ"));
}

TEST_F(ImportedTimes, BesideNumbersAreNamed) {
    write(take("cam1"), 1, unix_ms);
    write(take("cam2"), 2, unix_ms);
    for (int i = 0; i < 8; ++i) write_picture(take(fmt::format("cam3/{:04}.png", i)), 64, 48, 100);
    auto report = import(options_);
    ASSERT_TRUE(report);
    EXPECT_THAT(report->problems, Contains(HasSubstr("cameras left out: 'cam3'")));
    options_.output = folder_.path() / "second";
    options_.cameras = {"cam[23]"};
    report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message, HasSubstr("name all by times or all by numbers"));
}

TEST_F(ImportedTimes, AreCheckedAgainstTheRateThatIsSaid) {
    write_all(unix_ms);
    options_.has_rate = true;
    options_.said.rate_hz = 30.0;
    const auto report = import(options_);
    ASSERT_TRUE(report);
    EXPECT_THAT(report->checks,
                Contains(HasSubstr("--rate says 30 Hz, the times in the names of "
                                   "the pictures 15")));
}

TEST_F(ImportedTimes, OfACameraThatIsLateOrTakesMoreAreNamed) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 20; ++i) {
            const int ms = 80 * i + (camera == 3 ? 32 : 0);
            const std::string folder = fmt::format("cam{}/", camera);
            const auto name = [&](int at) {
                return folder + unix_ms(static_cast<std::uint64_t>(at)) + ".png";
            };
            write_picture(take(name(ms)), 64, 48, 40);
            if (camera == 1 && i < 3) write_picture(take(name(ms + 30)), 64, 48, 40);
        }
    }
    const auto report = import(options_);
    ASSERT_TRUE(report);
    EXPECT_THAT(report->checks,
                Contains(HasSubstr("3 pictures are not used, because another one "
                                   "of the same camera is nearer")));
    EXPECT_THAT(report->checks,
                Contains(HasSubstr("the times of some cameras differ from the others': 'cam3' by "
                                   "+3")))
        << "cam1's three more pictures move it by 2 ms";
}

TEST_F(ImportedTimes, NotButNumbersWithGapsAreNamed) {
    constexpr std::array kNumbers{3, 4, 90, 91, 92, 300, 800, 801, 802, 1300};
    for (int camera = 1; camera <= 3; ++camera)
        for (const int number : kNumbers)
            write_picture(take(fmt::format("cam{}/{:04}.png", camera, number)), 64, 48, 40);
    const auto report = import(options_);
    ASSERT_TRUE(report);
    EXPECT_THAT(report->problems,
                Contains(HasSubstr("only 10 of 1298 instants from 3 to 1300 have pictures")));
}

class ImportedRates : public ImportedRecording {
protected:
    void write_take(const std::vector<double>& rates_hz) {
        atrium::test::Random random(22);
        cameras_ = test::random_room(random, static_cast<int>(rates_hz.size()));
        for (std::size_t i = 0; i < rates_hz.size(); ++i) {
            cameras_[i].intrinsics.width = 64;
            cameras_[i].intrinsics.height = 48;
            test::write_video(take(cameras_[i].name + ".avi"),
                              64,
                              48,
                              4,
                              cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
                              rates_hz[i]);
        }
        options_.files = {folder_.write("all.yml", test::opencv_yaml(cameras_, 1000.0))};
    }
};

TEST_F(ImportedRates, NamesTheCamerasOfTheRateThatMostHave) {
    write_take({50.0, 25.0, 25.0, 25.0});
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    const std::string last = cameras_[1].name + "," + cameras_[2].name + "," + cameras_[3].name;
    EXPECT_THAT(report->problems,
                Contains(testing::AllOf(HasSubstr("25 of '" + cameras_[1].name + "'"),
                                        HasSubstr("50 of '" + cameras_[0].name + "'"),
                                        HasSubstr("convert the videos to one rate, or take only "
                                                  "the cameras of one: --cameras " +
                                                  last))));
    EXPECT_THAT(report->told, Contains(HasSubstr("rate: 25 Hz")));
}

TEST_F(ImportedRates, NamesNoneIfTwoCamerasWouldBeLeft) {
    write_take({50.0, 25.0, 25.0});
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, Contains(HasSubstr("convert the videos to one rate")));
    EXPECT_THAT(report->problems, Not(Contains(HasSubstr("--cameras"))));
}

}  // namespace
}  // namespace atrium::calibrate
