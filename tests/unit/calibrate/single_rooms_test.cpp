// One folder with a picture of the empty room per camera, whose names are those of the videos.
#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

// The cameras are cam1, cam2, cam3, their videos 01, 02, 03.
class SingleRooms : public test::ImportedRecording {
protected:
    void SetUp() override {
        ImportedRecording::SetUp();
        for (int camera = 1; camera <= 3; ++camera)
            test::write_video(take(fmt::format("videos/{:02}.avi", camera)), 64, 48, 10);
    }
    void write_room(const std::string& name, int width = 64) const {
        test::write_picture(take(name), width, 48, 10);
    }
    ImportReport imported() {
        options_.force = true;
        const auto report = import(options_);
        EXPECT_TRUE(report) << report.error().message;
        return report.value_or(ImportReport{});
    }
    // The file that became the empty room of a camera; empty if it has none.
    std::string room_of(int camera) const {
        const fs::path link = options_.output / fmt::format("cam{}/background.png", camera);
        std::error_code failure;
        return fs::is_symlink(link, failure) ? fs::read_symlink(link).filename().string() : "";
    }
    bool has_sequence(int camera) const {
        return fs::exists(options_.output / fmt::format("cam{}/background", camera));
    }
};

TEST_F(SingleRooms, HaveTheNamesOfTheVideosOrNumbersOfTheCameras) {
    for (const char* form : {"background/{:02}.png",
                             "background1f/{:02}.png",
                             "background/{}.png",
                             "background/empty_{}.png",
                             "background/camera{:02}.png"}) {
        SCOPED_TRACE(form);
        for (int camera = 1; camera <= 3; ++camera)
            write_room(fmt::format(fmt::runtime(form), camera));
        const ImportReport report = imported();
        EXPECT_THAT(report.told,
                    Contains(HasSubstr("background: the empty room was found for every camera")));
        for (int camera = 1; camera <= 3; ++camera) {
            const std::string wanted = fmt::format(fmt::runtime(form), camera);
            EXPECT_EQ(room_of(camera), fs::path(wanted).filename().string());
            EXPECT_FALSE(has_sequence(camera));
        }
        fs::remove_all(take(form).parent_path());
    }
}

TEST_F(SingleRooms, AreFoundInTheFolderThatTheUserNames) {
    options_.background = folder_.path() / "room2";
    for (int camera = 1; camera <= 3; ++camera)
        test::write_picture(options_.background / fmt::format("{:02}.png", camera), 64, 48, 10);
    imported();
    for (int camera = 1; camera <= 3; ++camera)
        EXPECT_EQ(room_of(camera), fmt::format("{:02}.png", camera));
}

TEST_F(SingleRooms, OfSomeCamerasNeedTheNamesOfTheirVideosOrAWordForACamera) {
    for (const int camera : {1, 3}) write_room(fmt::format("bg/{:02}.png", camera));
    write_room("bg/plan.png");  // says nothing about the others
    EXPECT_THAT(imported().told, Contains(HasSubstr("found for 2 of 3 cameras")));
    EXPECT_EQ(room_of(1), "01.png");
    EXPECT_EQ(room_of(3), "03.png");
    fs::remove_all(take("bg"));
    for (const int camera : {2, 3}) write_room(fmt::format("bg/camera_0{}.png", camera));
    EXPECT_THAT(imported().told, Contains(HasSubstr("found for 2 of 3 cameras")));
    EXPECT_EQ(room_of(2), "camera_02.png");
    fs::remove_all(take("bg"));
    for (const int camera : {2, 3}) write_room(fmt::format("bg/{:05}.png", camera));
    EXPECT_THAT(imported().checks,
                Contains(AllOf(HasSubstr("no empty room of 'cam1', 'cam2', 'cam3', although"),
                               HasSubstr("has 'bg/00002.png', 'bg/00003.png'"))));
}

// A camera without video, or one that the user leaves out, may have an empty room.
TEST_F(SingleRooms, MayBeOfCamerasWithoutVideo) {
    fs::remove(take("videos/02.avi"));
    for (int camera = 1; camera <= 3; ++camera) write_room(fmt::format("bg/{}.png", camera));
    imported();
    EXPECT_EQ(room_of(1), "1.png");
    EXPECT_EQ(room_of(3), "3.png");
    options_.cameras = {"!cam2"};
    imported();
    EXPECT_EQ(room_of(1), "1.png");
    EXPECT_EQ(room_of(3), "3.png");
}

// The pictures of one camera: its name is in the path, or there is one folder for each.
TEST_F(SingleRooms, AreNoSequenceOfACamera) {
    for (int i = 1; i <= 3; ++i) write_room(fmt::format("bg/cam2/{:02}.png", i));
    EXPECT_THAT(imported().told, Contains(HasSubstr("found for 1 of 3 cameras: 'bg/cam2'")));
    EXPECT_TRUE(has_sequence(2));
    fs::remove_all(take("bg"));
    for (int camera = 1; camera <= 3; ++camera)
        for (int i = 1; i <= 3; ++i) write_room(fmt::format("bg/{}/{:02}.png", camera, i));
    EXPECT_THAT(imported().told, Contains(HasSubstr("found for every camera: 'bg/1'")));
    for (int camera = 1; camera <= 3; ++camera) EXPECT_TRUE(has_sequence(camera));
    fs::remove_all(take("bg"));
    // more pictures than cameras: the number in the folder's name is the camera's
    for (int i = 0; i < 20; ++i) write_room(fmt::format("bg_2/{:04}.png", i));
    EXPECT_THAT(imported().told, Contains(HasSubstr("found for 1 of 3 cameras: 'bg_2'")));
    EXPECT_TRUE(has_sequence(2));
}

// As many pictures as cameras, whose numbers are not those of the cameras: nobody can tell.
TEST_F(SingleRooms, AreNotTakenAsASequenceIfTheyMayBeOneOfEachCamera) {
    for (int i = 0; i < 3; ++i) write_room(fmt::format("bg1f/{:02}.png", i));
    const ImportReport report = imported();
    EXPECT_THAT(report.told, Not(Contains(HasSubstr("empty room was found"))));
    EXPECT_THAT(report.checks,
                Contains(AllOf(HasSubstr("although"),
                               HasSubstr("has 'bg1f/00.png', 'bg1f/01.png', 'bg1f/02.png' (wanted"),
                               HasSubstr("as 'cam1', 'cam2', 'cam3', or that of its pictures, as "
                                         "'01', '02', '03'"),
                               HasSubstr("give these files such names"))));
    EXPECT_FALSE(has_sequence(1));
    // of another size they cannot be those of all cameras
    fs::remove_all(take("bg1f"));
    for (int i = 0; i < 3; ++i) write_room(fmt::format("bg1f/{:02}.png", i), 32);
    EXPECT_THAT(import(options_).error().message,
                HasSubstr("empty room of 'cam1' has another size"));
}

TEST_F(SingleRooms, InTwoFoldersAreAQuestion) {
    for (const char* room : {"bg_first", "bg_second"})
        for (int camera = 1; camera <= 3; ++camera)
            write_room(fmt::format("{}/{:02}.png", room, camera));
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("background: "),
                      HasSubstr("bg_first and "),
                      HasSubstr("bg_second each hold a picture of the empty room per camera; name "
                                "one of them with --background")));
    options_.background = take("bg_second");
    imported();
    EXPECT_EQ(room_of(3), "03.png");
}

TEST_F(SingleRooms, ThatFitNoCameraInTheFolderThatTheUserNamesAreAProblem) {
    options_.background = folder_.path() / "room";
    for (const char* name : {"a.png", "b.png"})
        test::write_picture(options_.background / name, 64, 48, 10);
    EXPECT_THAT(imported().problems,
                Contains(AllOf(HasSubstr("no empty room of 'cam1', 'cam2', 'cam3', although"),
                               HasSubstr("room has 'a.png', 'b.png' (wanted"))));
    fs::remove_all(options_.background);
    fs::create_directories(options_.background);
    EXPECT_THAT(imported().problems, Contains(HasSubstr("room has neither videos nor pictures")));
}

}  // namespace
}  // namespace atrium::calibrate
