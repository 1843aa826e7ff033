// Masks of other programs, in their names and numbers, become those of a recording.
#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class ImportedMasks : public test::ImportedRecording {
protected:
    void write_frames(int first, int num) const {
        for (int camera = 1; camera <= 3; ++camera) {
            for (int i = first; i < first + num; ++i)
                test::write_picture(
                    take(fmt::format("cam{}/img_{:04}.png", camera, i)), 64, 48, 40);
        }
    }
    // A mask that is white left of a column: the number of its picture plus 10.
    static void write_mask(const fs::path& file, int number) {
        fs::create_directories(file.parent_path());
        cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(0));
        mask.colRange(0, 10 + number).setTo(255);
        ASSERT_TRUE(cv::imwrite(file.string(), mask));
    }
    // The site's mask of each frame must be that of its picture.
    void expect_masks(int num_frames) {
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_THAT(report->problems, IsEmpty());
        EXPECT_THAT(report->told, Contains(HasSubstr("masks: found for every camera")));
        const auto source = capture::RecordingSource::open({.folder = options_.output});
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_TRUE((*source)->has_silhouettes());
        for (int i = 0; i < num_frames; ++i) {
            const auto frame = (*source)->read_frame(static_cast<std::size_t>(i));
            ASSERT_TRUE(frame) << frame.error().message;
            for (const auto& camera : frame->frames) {
                const auto& row = camera.silhouette->data;
                EXPECT_EQ(std::count(row.begin(), row.begin() + 64, std::uint8_t{255}), 10 + i);
            }
        }
    }
};

TEST_F(ImportedMasks, OfAFolderOfTheirOwnWithTheNumbersOfThePictures) {
    write_frames(100, 3);
    options_.masks = folder_.path() / "segmented";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_mask(options_.masks / fmt::format("cam{}/img_{:04}_mask.png", camera, 100 + i),
                       i);
    }
    expect_masks(3);
}

TEST_F(ImportedMasks, WithNumbersOfTheirOwn) {
    write_frames(100, 3);
    options_.masks = folder_.path() / "segmented";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_mask(options_.masks / fmt::format("cam{}_{:03}.tif", camera, 1 + i), i);
    }
    expect_masks(3);
    EXPECT_TRUE(fs::is_symlink(options_.output / "cam1/silhouettes/000000.png"));
}

TEST_F(ImportedMasks, BesideThePicturesByName) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i) {
            test::write_picture(take(fmt::format("cam{}/images/{:04}.jpg", camera, i)), 64, 48, 40);
            write_mask(take(fmt::format("cam{}/masks/{:04}.jpg.png", camera, i)), i);
        }
    }
    expect_masks(3);
}

TEST_F(ImportedMasks, InTheFolderOfThePictures) {
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i) {
            test::write_picture(take(fmt::format("cam{}/{:04}.png", camera, i)), 64, 48, 40);
            write_mask(take(fmt::format("cam{}/{:04}_mask.png", camera, i)), i);
        }
    }
    expect_masks(3);
}

// Programs that find people add words of their own.
TEST_F(ImportedMasks, WithWordsBehindTheirNumbers) {
    const auto with_word = [](const char* word, int camera, int i) {
        return fmt::format("cam{}/{:04}{}.png", camera, i, word);
    };
    for (const char* word : {"_person", "_pred", "-alpha", "_out"}) {
        for (int camera = 1; camera <= 3; ++camera) {
            for (int i = 0; i < 3; ++i) {
                test::write_picture(take(with_word("", camera, i)), 64, 48, 40);
                write_mask(take(with_word(word, camera, i)), i);
            }
        }
        options_.output = folder_.path() / (std::string("made") + word);
        expect_masks(3);
        fs::remove_all(options_.recording);
    }
    write_frames(0, 3);
    for (const char* word : {"_labelIds", "_0", "_anything_at_all"}) {
        options_.masks = folder_.path() / (std::string("segmented") + word);
        for (int camera = 1; camera <= 3; ++camera)
            for (int i = 0; i < 3; ++i) write_mask(options_.masks / with_word(word, camera, i), i);
        options_.output = folder_.path() / (std::string("made") + word);
        expect_masks(3);
    }
}

TEST_F(ImportedMasks, InFoldersOfSeveralResults) {
    write_frames(0, 3);
    options_.masks = folder_.path() / "matted";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i) {
            const auto result = options_.masks / fmt::format("cam{}", camera);
            write_mask(result / fmt::format("pha/{:04}.png", i), i);
            test::write_picture(result / fmt::format("com/{:04}.png", i), 64, 48, 90);
        }
    }
    expect_masks(3);
}

TEST_F(ImportedMasks, ThatShowNobodyAreTold) {
    write_frames(0, 3);
    options_.masks = folder_.path() / "segmented";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            test::write_picture(
                options_.masks / fmt::format("cam{}/{:04}.png", camera, i), 64, 48, 0);
    }
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(
        report->problems,
        Contains(AllOf(HasSubstr("none of 9 that were looked at"), HasSubstr("cam1/0000.png"))));
    // a person cut out on black
    cv::Mat cut_out(48, 64, CV_8UC3, cv::Scalar(0, 0, 0));
    for (int y = 0; y < 40; ++y) cut_out(cv::Rect(20, y, 20, 1)) = cv::Scalar(40 + y, 90, 3 * y);
    ASSERT_TRUE(cv::imwrite((options_.masks / "cam2/0000.png").string(), cut_out));
    options_.output = folder_.path() / "second";
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("cam2/0000.png"), HasSubstr("a picture in colours, not a mask")));
}

TEST_F(ImportedMasks, OfVideosCountFromTheFirst) {
    options_.masks = folder_.path() / "masks";
    for (int camera = 1; camera <= 3; ++camera) {
        test::write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 3);
        for (int i = 0; i < 3; ++i)
            write_mask(options_.masks / fmt::format("cam{}/{:06}.png", camera, 1 + i), i);
    }
    expect_masks(3);
}

TEST_F(ImportedMasks, AreThoseOfAllCamerasOrAnError) {
    write_frames(0, 3);
    options_.masks = folder_.path() / "masks";
    for (int camera = 1; camera <= 2; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_mask(options_.masks / fmt::format("cam{}/{:06}.png", camera, i), i);
    }
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("none of 'cam3'"), HasSubstr("of all cameras or of none")));
    write_mask(options_.masks / "cam3/000000.png", 0);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, Contains(HasSubstr("2 of 3 of camera 'cam3'")));
    // only the last instant is complete
    fs::rename(options_.masks / "cam3/000000.png", options_.masks / "cam3/000002.png");
    options_.output = folder_.path() / "last";
    EXPECT_TRUE(import(options_));
    fs::remove(options_.masks / "cam1/000002.png");
    options_.output = folder_.path() / "none";
    EXPECT_THAT(import(options_).error().message, HasSubstr("at no instant"));
}

TEST_F(ImportedMasks, MustBePicturesOfTheRightSize) {
    write_frames(0, 3);
    options_.masks = folder_.path() / "masks";
    for (int camera = 1; camera <= 3; ++camera)
        test::write_video(options_.masks / fmt::format("cam{}.avi", camera), 64, 48, 3);
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("is a video"), HasSubstr("ffmpeg -i")));
    fs::remove_all(options_.masks);
    for (int camera = 1; camera <= 3; ++camera)
        test::write_picture(options_.masks / fmt::format("cam{}/0000.png", camera), 32, 24, 255);
    EXPECT_THAT(import(options_).error().message, AllOf(HasSubstr("32x24"), HasSubstr("64x48")));
}

TEST_F(ImportedMasks, OfAnotherSizeAreRefusedBeforeAnythingIsWritten) {
    write_frames(100, 3);
    options_.masks = folder_.path() / "segmented";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i) {
            const auto file = options_.masks / fmt::format("cam{}/img_{:04}.png", camera, 100 + i);
            fs::create_directories(file.parent_path());
            const cv::Mat half(24, 32, CV_8UC1, cv::Scalar(255));
            ASSERT_TRUE(cv::imwrite(file.string(), camera == 2 ? cv::Mat(48, 64, CV_8UC1) : half));
        }
    }
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("masks of 'cam1', 'cam3' have another size"),
                      HasSubstr("'cam1' have 32x24 px, its pictures 64x48"),
                      HasSubstr("mkdir -p scaled/cam1 && mogrify -path scaled/cam1 -filter point "
                                "-resize '64x48!' "),
                      HasSubstr("segmented/cam1/*.png"),
                      HasSubstr("--masks scaled")));
    EXPECT_FALSE(fs::exists(options_.output / "cam1"));
}

TEST_F(ImportedMasks, OfPeopleInBlackAreInvertedIfTheUserSaysSo) {
    write_frames(100, 3);
    options_.masks = folder_.path() / "segmented";
    const auto write_all = [&](int people) {
        for (int camera = 1; camera <= 3; ++camera) {
            for (int i = 0; i < 3; ++i) {
                const auto file = options_.masks / fmt::format("cam{}/{:04}.tif", camera, 100 + i);
                fs::create_directories(file.parent_path());
                cv::Mat mask(48, 64, CV_8UC1, cv::Scalar(255 - people));
                mask(cv::Rect(20, 0, 10 + i, 40)).setTo(people);
                ASSERT_TRUE(cv::imwrite(file.string(), mask));
            }
        }
    };
    write_all(0);
    const auto refused = import(options_);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("masks: they look inverted"),
                      HasSubstr("segmented/cam1/0100.tif"),
                      HasSubstr("--invert-masks, and import again")));
    EXPECT_FALSE(fs::exists(options_.output));
    options_.invert_masks = true;
    expect_masks(3);
    EXPECT_FALSE(fs::is_symlink(options_.output / "cam1/silhouettes/000000.png"));
    write_all(255);
    options_.output = folder_.path() / "second";
    EXPECT_THAT(import(options_).error().message, HasSubstr("leave --invert-masks out"));
    fs::remove_all(options_.masks);
    options_.masks.clear();
    EXPECT_THAT(import(options_).error().message, HasSubstr("no masks were found"));
}

TEST_F(ImportedMasks, LeaveNothingBehindThatBlocksTheNextImport) {
    write_frames(0, 3);
    options_.masks = folder_.path() / "segmented";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_mask(options_.masks / fmt::format("cam{}/{:04}.png", camera, i), i);
    }
    // the first complete instant is 2; its picture is read only after everything is written
    for (const char* early : {"cam3/0000.png", "cam3/0001.png"}) fs::remove(options_.masks / early);
    const fs::path bad = take("cam2/img_0002.png");
    fs::remove(bad);
    std::ofstream(bad) << "garbage";
    const auto refused = import(options_);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("cam2/frames/000002.png"),
                      HasSubstr("nothing was kept"),
                      HasSubstr("and import again")));
    EXPECT_FALSE(fs::exists(options_.output));
    test::write_picture(bad, 64, 48, 40);
    for (int i = 0; i < 2; ++i) write_mask(options_.masks / fmt::format("cam3/{:04}.png", i), i);
    expect_masks(3);  // without --force
    // a file that is no link: the recording that is there stays whole
    const fs::path link = options_.output / "cam2/silhouettes/000001.png";
    const fs::path source = fs::canonical(link);
    fs::remove(link);
    fs::copy_file(source, link);
    options_.force = true;
    EXPECT_THAT(import(options_).error().message, HasSubstr("only links are replaced"));
    EXPECT_TRUE(capture::RecordingSource::open({.folder = options_.output}));
}

TEST_F(ImportedMasks, WithoutPicturesAreRefused) {
    for (int camera = 1; camera <= 3; ++camera)
        write_mask(take(fmt::format("cam{}/masks/{:04}.png", camera, 1)), 0);
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(
        report.error().message,
        AllOf(HasSubstr("people get their colours from the pictures"), HasSubstr("--masks")));
}

}  // namespace
}  // namespace atrium::calibrate
