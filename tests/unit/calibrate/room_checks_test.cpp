// People in the pictures of the empty room are told with the camera, the place and the file.
#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

#include <optional>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class ImportedRoom : public test::ImportedRecording {
protected:
    // A person of 14x30 px at this column, or nobody.
    static cv::Mat picture(std::optional<int> left) {
        cv::Mat room(48, 64, CV_8UC3, cv::Scalar(140, 150, 150));
        if (left) room(cv::Rect(*left, 10, 14, 30)).setTo(cv::Scalar(60, 40, 160));
        return room;
    }
    // Somebody who walks from left to right.
    void write_take(int camera) {
        for (int i = 0; i < 12; ++i)
            write(take(fmt::format("cam{}/{:04}.png", camera, i)), picture(4 * i));
    }
    static void write(const fs::path& file, const cv::Mat& picture) {
        fs::create_directories(file.parent_path());
        ASSERT_TRUE(cv::imwrite(file.string(), picture));
    }
    ImportReport imported() {
        const auto report = import(options_);
        EXPECT_TRUE(report) << report.error().message;
        return report.value_or(ImportReport{});
    }
};

constexpr const char* kDoubt = "the empty room seems to show a person";

TEST_F(ImportedRoom, WithAPersonInOneCameraIsACheck) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_take(camera);
        const auto left = camera == 2 ? std::optional(24) : std::nullopt;
        write(take(fmt::format("empty/cam{}.png", camera)), picture(left));
    }
    const ImportReport report = imported();
    EXPECT_THAT(report.problems, Not(Contains(HasSubstr(kDoubt))));
    EXPECT_THAT(
        report.checks,
        Contains(AllOf(HasSubstr(kDoubt),
                       HasSubstr("'cam2' at (30, 24) of " + take("empty/cam2.png").string()),
                       Not(HasSubstr("'cam1'")),
                       HasSubstr("If these files show nobody there, ignore this; else film"),
                       HasSubstr("--segmentation.background_from people"))));
}

// Taken from the middle of a take in which somebody sits.
TEST_F(ImportedRoom, WithThePersonOfTheTakeIsAProblem) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 12; ++i)
            write(take(fmt::format("cam{}/{:04}.png", camera, i)), picture(20));
        write(take(fmt::format("empty/cam{}.png", camera)), picture(20));
    }
    EXPECT_THAT(imported().problems,
                Contains(AllOf(HasSubstr("nobody is seen before the empty room of 'cam1' (" +
                                         take("empty/cam1.png").string()),
                               HasSubstr("does it show the same person?"))));
}

TEST_F(ImportedRoom, InOtherLightIsAProblem) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_take(camera);
        write(take(fmt::format("empty/cam{}.png", camera)), picture(std::nullopt) / 4);
    }
    EXPECT_THAT(
        imported().problems,
        Contains(AllOf(HasSubstr("people cannot be told reliably from the empty room: that of "
                                 "'cam1' is 3.9 times darker than the pictures (" +
                                 take("empty/cam1.png").string()),
                       HasSubstr("that of 'cam3'"),
                       HasSubstr("--segmentation.background_from people"))));
}

TEST_F(ImportedRoom, ThatWasExchangedWithAnotherIsNamed) {
    const auto dark = [](const cv::Mat& picture) { return cv::Mat(picture / 4); };
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 12; ++i) {
            const cv::Mat seen = picture(4 * i);
            write(take(fmt::format("cam{}/{:04}.png", camera, i)), camera == 2 ? dark(seen) : seen);
        }
        write(take(fmt::format("empty/cam{}.png", camera)),
              camera == 3 ? dark(picture({})) : picture({}));
    }
    EXPECT_THAT(imported().problems,
                Contains(AllOf(HasSubstr("those of 'cam2' and 'cam3' fit if they are exchanged: "
                                         "exchange these files, or the videos of the take. Else "
                                         "film it again"),
                               Not(HasSubstr("'cam1'")))));
}

TEST_F(ImportedRoom, WithAPersonInMostCamerasIsAProblem) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_take(camera);
        for (int i = 0; i < 3; ++i)
            write(take(fmt::format("empty/cam{}/{:04}.png", camera, i)), picture(24));
    }
    EXPECT_THAT(imported().problems,
                Contains(AllOf(HasSubstr(kDoubt),
                               HasSubstr("'cam1' at (30, 24) of " + take("empty/cam1").string()),
                               HasSubstr("'cam3' at"))));
}

TEST_F(ImportedRoom, WithoutAPersonIsNotDoubted) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_take(camera);
        write(take(fmt::format("empty/cam{}.png", camera)), picture({}));
    }
    const ImportReport report = imported();
    EXPECT_THAT(report.problems, Not(Contains(HasSubstr(kDoubt))));
    EXPECT_THAT(report.checks, Not(Contains(HasSubstr(kDoubt))));
}

TEST_F(ImportedRoom, IsNotComparedWithMasksWhichReplaceIt) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_take(camera);
        write(take(fmt::format("empty/cam{}.png", camera)), picture(24));
        for (int i = 0; i < 12; ++i) {
            cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(0));
            mask(cv::Rect(4 * i, 10, 14, 30)).setTo(cv::Scalar(255));
            write(take(fmt::format("masks/cam{}/{:04}.png", camera, i)), mask);
        }
    }
    EXPECT_THAT(imported().problems, Not(Contains(HasSubstr(kDoubt))));
}

}  // namespace
}  // namespace atrium::calibrate
