// Pictures on their side, and rotation tags of videos.
#include "tests/support/pictures/rotation_tag.hpp"
#include "tests/unit/calibrate/recording_fixture.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using test::write_picture;
using test::write_video;

class TurnedPictures : public test::ImportedRecording {
protected:
    std::string error() {
        const auto report = import(options_);
        return report ? "none" : report.error().message;
    }
};

TEST_F(TurnedPictures, OfVideosWithoutATagAreTurnedByACommand) {
    write_video(take("cam1.avi"), 64, 48, 3);
    write_video(take("cam 2.avi"), 48, 64, 3);
    write_video(take("cam3.avi"), 48, 64, 3);
    EXPECT_THAT(error(),
                AllOf(HasSubstr("camera 'cam2': calibrated at 64x48 px, but its pictures have "
                                "48x64 px"),
                      HasSubstr("cam 2.avi has no rotation tag: turn it with `ffmpeg -i '"),
                      HasSubstr("cam 2.avi' -vf transpose=1 OUT.avi`, or transpose=2 if it is then "
                                "upside down; the same with 'cam3'"),
                      Not(HasSubstr("scale"))));
    options_.said.size = {48, 64};
    EXPECT_THAT(error(), HasSubstr("has no rotation tag")) << "a size that is said turns nothing";
}

TEST_F(TurnedPictures, OfVideosWithATagAreTurnedBackTheOtherWay) {
    for (const auto& [tag_deg, transpose] : {std::array{90, 2}, {270, 1}}) {
        for (int camera = 1; camera <= 3; ++camera) {
            const auto file = take(fmt::format("cam{}.mp4", camera));
            write_video(file, 64, 48, 3, cv::VideoWriter::fourcc('m', 'p', '4', 'v'));
            if (camera == 3) atrium::test::set_rotation_tag(file, tag_deg);
        }
        EXPECT_THAT(
            error(),
            AllOf(HasSubstr("camera 'cam3': calibrated at 64x48 px"),
                  HasSubstr(fmt::format("cam3.mp4 has a rotation tag of {} degrees", tag_deg)),
                  HasSubstr(fmt::format("-vf transpose={} OUT.mp4`", transpose)),
                  Not(HasSubstr("scale"))));
    }
}

TEST_F(TurnedPictures, OfFilesMayHaveAnOrientation) {
    for (int camera = 1; camera <= 3; ++camera)
        write_picture(take(fmt::format("cam{}/0001.jpg", camera)), 48, 64, 40);
    EXPECT_THAT(error(), AllOf(HasSubstr("48x64 px: they were turned"), HasSubstr("EXIF")));
}

TEST_F(TurnedPictures, ThatAreScaledTooAreFirstTurned) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 96, 128, 3);
    EXPECT_THAT(error(), AllOf(HasSubstr("-vf transpose=1"), Not(HasSubstr("--size"))));
}

TEST_F(TurnedPictures, AreComparedWithTheCalibrationBeforeTheirMasks) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_video(take(fmt::format("cam{}.avi", camera)), 48, 64, 3);
        write_picture(take(fmt::format("masks/cam{}/000000.png", camera)), 64, 48, 0);
        write_picture(take(fmt::format("empty/cam{}.png", camera)), 64, 48, 0);
    }
    EXPECT_THAT(error(), AllOf(HasSubstr("-vf transpose=1"), Not(HasSubstr("mogrify"))));
}

TEST_F(TurnedPictures, WithMasksAsCalibratedNeedNoScaling) {
    for (int camera = 1; camera <= 3; ++camera) {
        write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 3);
        const bool is_turned = camera == 2;
        write_picture(take(fmt::format("masks/cam{}/000000.png", camera)),
                      is_turned ? 48 : 64,
                      is_turned ? 64 : 48,
                      0);
    }
    EXPECT_THAT(error(),
                AllOf(HasSubstr("masks of 'cam2' have another size than the pictures"),
                      HasSubstr("on their side"),
                      HasSubstr("mkdir -p turned/cam2 && mogrify -path turned/cam2 -rotate 90 "),
                      HasSubstr("copy the masks of the other cameras beside them"),
                      Not(HasSubstr("scale"))));
}

TEST_F(TurnedPictures, OfQualisysAreTurnedBackAsItsFileSays) {
    for (int camera = 1; camera <= 3; ++camera)
        write_video(take(fmt::format("cam{}.avi", camera)), 48, 64, 3);
    for (const auto& [degrees, transpose] : {std::array{90, 2}, {270, 1}}) {
        std::string text = test::qualisys_xml(cameras_);
        const std::string unturned = "viewrotation=\"0\"";
        for (std::size_t at = text.find(unturned); at != std::string::npos;
             at = text.find(unturned))
            text.replace(at, unturned.size(), fmt::format("viewrotation=\"{}\"", degrees));
        options_.files = {folder_.write("lab.qca.txt", text)};
        EXPECT_THAT(error(),
                    AllOf(HasSubstr(fmt::format("viewrotation {}", degrees)),
                          HasSubstr(fmt::format("-vf transpose={} OUT", transpose))));
    }
}

TEST_F(TurnedPictures, MayBeUpsideDown) {
    std::string text = test::qualisys_xml(cameras_);
    const std::string unturned = "viewrotation=\"0\"";
    text.replace(text.find(unturned), unturned.size(), "viewrotation=\"180\"");
    const auto foreign = read_foreign({folder_.write("lab.qca.txt", text)}, "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    EXPECT_THAT(
        foreign->checks,
        testing::ElementsAre(AllOf(HasSubstr("camera 'cam1'"), HasSubstr("-vf hflip,vflip OUT"))));
}

}  // namespace
}  // namespace atrium::calibrate
