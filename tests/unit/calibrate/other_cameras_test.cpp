// Calibrated cameras that are none of the rig: carried about, or with pictures of other instants.
#include "tests/unit/calibrate/recording_fixture.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <gmock/gmock.h>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using test::write_picture;

class OtherCameras : public test::ImportedRecording {
protected:
    // A model of COLMAP with the three cameras, and `name` at 9 places `step_m` apart.
    void write_model(const std::string& name, double step_m) {
        std::string images;
        // in front, so that a proposed --distance would name it
        for (int i = 0; i < 9; ++i) {
            images += fmt::format(
                "{} 1 0 0 0 {} 0.5 2 1 {}/IMG_{}.jpg\n\n", 100 + i, step_m * i, name, 4711 + i);
        }
        images += test::colmap_images_txt(cameras_, 1.0);
        folder_.write("model/cameras.txt", test::colmap_cameras_txt(cameras_));
        folder_.write("model/images.txt", images);
        options_.files = {folder_.path() / "model"};
        options_.said.distance = Said::Distance{"cam1", "cam2", 2.0};
    }
    void write_pictures(const std::string& phone) const {
        for (int camera = 1; camera <= 3; ++camera)
            write_picture(take(fmt::format("cam{}/frame_000001.png", camera)), 64, 48, 40);
        for (int i = 0; i < 9; ++i)
            write_picture(take(fmt::format("{}/IMG_{}.jpg", phone, 4711 + i)), 32, 24, 40);
    }
};

TEST_F(OtherCameras, OneThatWasCarriedAboutIsLeftOutOfTheRig) {
    write_model("phone", 0.2);
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("camera 'phone': its 9 images stand up to "),
                               HasSubstr("so it moved: left out"),
                               HasSubstr("--cameras '!phone'"))));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 3U);
    options_.output = folder_.path() / "second.toml";
    options_.cameras = {"!phone"};
    const auto excluded = import(options_);
    ASSERT_TRUE(excluded) << excluded.error().message;
    EXPECT_THAT(excluded->problems, Not(Contains(HasSubstr("phone"))));
    options_.cameras.clear();
    options_.said.distance.reset();
    EXPECT_THAT(import(options_).error().message, HasSubstr("--distance cam1 cam2 METRES"));
}

TEST_F(OtherCameras, OneThatWasCarriedAboutIsLeftOutOfTheRecordingWithItsPictures) {
    // the number of a phone is not that of a camera without pictures
    write_model("phone2", 0.2);
    write_pictures("phone2");
    std::filesystem::remove_all(take("cam2"));
    options_.said.distance = Said::Distance{"cam1", "cam3", 2.0};
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, Contains(HasSubstr("camera 'phone2': its 9 images")));
    EXPECT_THAT(report->problems, Contains(HasSubstr("has no pictures of 'cam2'; a hull")));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 2U);
}

TEST_F(OtherCameras, OneThatTheUserLeavesOutHasNoPicturesThatAreMissed) {
    write_model("phone", 0.2);
    write_pictures("phone");
    options_.cameras = {"!phone"};
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    for (const auto& lines : {report->told, report->checks, report->problems})
        EXPECT_THAT(lines, Not(Contains(HasSubstr("phone"))));
}

// One picture per camera lies beside the folder of the phone.
TEST_F(OtherCameras, OneInAFolderBesideLoosePicturesIsLeftOut) {
    write_model("phone", 0.2);
    std::string images = test::colmap_images_txt(cameras_, 1.0);
    for (std::size_t at = images.find("/0001"); at != std::string::npos; at = images.find("/0001"))
        images.replace(at, 5, "");
    for (int i = 0; i < 9; ++i)
        images += fmt::format("{} 1 0 0 0 {} 0.5 2 1 phone/{}.jpg\n\n", 100 + i, 0.2 * i, i);
    folder_.write("model/images.txt", images);
    const auto rig = read_foreign(options_.files, "auto", {});
    ASSERT_TRUE(rig) << rig.error().message;
    std::vector<std::string> names;
    for (const ForeignCamera& camera : rig->cameras) names.push_back(camera.name);
    EXPECT_THAT(names, testing::UnorderedElementsAre("cam1", "cam2", "cam3"));
    ASSERT_EQ(rig->walked.size(), 1U);
    EXPECT_EQ(rig->walked[0].name, "phone");
}

TEST_F(OtherCameras, OneThatMovedByTheNoiseOfASolutionStays) {
    write_model("cam9", 0.01);
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->checks,
                Contains(AllOf(HasSubstr("camera 'cam9': its 9 images stand up to "),
                               HasSubstr("or COLMAP erred; the first is used"))));
    EXPECT_THAT(report->problems, Not(Contains(HasSubstr("left out"))));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 4U);
}

TEST_F(OtherCameras, OneThatWasCarriedAboutStaysIfNoRigRemains) {
    write_model("phone", 0.2);
    const auto rig = read_foreign(options_.files, "auto", {"phone", "cam1"});
    ASSERT_TRUE(rig) << rig.error().message;
    EXPECT_EQ(rig->cameras.size(), 2U);
    EXPECT_THAT(rig->checks, ElementsAre(HasSubstr("camera 'phone'")));
    EXPECT_THAT(rig->walked, IsEmpty());
}

TEST_F(OtherCameras, OneWithPicturesOfOtherInstantsIsLeftOut) {
    options_.recording = folder_.path() / "take";
    for (int camera = 1; camera <= 3; ++camera) {
        for (int i = 0; i < 3; ++i)
            write_picture(
                take(fmt::format("cam{}/{}.png", camera, i + (camera == 2 ? 4711 : 1))), 64, 48, 4);
    }
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("camera 'cam2' left out: its pictures have the numbers "
                                         "4711 to 4713, the others 1 to 3"),
                               HasSubstr("--cameras '!cam2'"))));
    EXPECT_EQ(config::load_rig(options_.output)->cameras.size(), 2U);
    EXPECT_FALSE(std::filesystem::exists(options_.output / "cam2"));
}

// "Oqus 210c" and "Arqus" take pictures and do not say so.
TEST_F(OtherCameras, UsesCamerasOfAnyModelOfQualisysThatHavePictures) {
    std::string text = test::qualisys_xml(cameras_);
    const std::string model = "model=\"Miqus Video\"";
    ASSERT_NE(text.find(model), std::string::npos);
    for (std::size_t at = text.find(model); at != std::string::npos; at = text.find(model, at))
        text.replace(at, model.size(), "model=\"Arqus A9\"");
    const std::size_t third = text.find("model=", text.find("serial=\"cam3\""));
    text.replace(third, 16, "model=\"Miqus M3\"");
    options_.files = {folder_.write("a.qca.txt", text)};
    for (int camera = 1; camera <= 2; ++camera)
        test::write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 8);
    const auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->told,
                AllOf(Contains(AllOf(HasSubstr("'cam1', 'cam2' have pictures"))),
                      Contains(AllOf(HasSubstr("markers were left out: 'cam3'")))));
    EXPECT_THAT(report->problems, testing::Not(Contains(HasSubstr("left out"))));
}

// As caliscope's ignore and Vicon's cameras without a KeyFrame.
TEST_F(OtherCameras, OfOtherFormatsThatAreLeftOutButHavePicturesAreAProblem) {
    std::string toml = test::anipose_toml(cameras_, 1000.0);
    toml.insert(toml.find("size", toml.find("\"cam3\"")), "ignore = true\n");
    std::string xcp = test::vicon_xcp(cameras_);
    const std::size_t frame = xcp.find("<KeyFrame ", xcp.find("\"cam3\""));
    xcp.erase(frame, xcp.find("/>", frame) + 2 - frame);
    for (int camera = 1; camera <= 3; ++camera)
        test::write_video(take(fmt::format("cam{}.avi", camera)), 64, 48, 8);
    options_.force = true;
    for (const auto& [name, text] : {std::pair{"a.toml", toml}, std::pair{"a.xcp", xcp}}) {
        options_.files = {folder_.write(name, text)};
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_THAT(report->problems,
                    Contains(HasSubstr("camera 'cam3' left out, although it has pictures")))
            << name;
    }
}

class CamerasOfQualisys : public test::ImportedRecording {
protected:
    // The three cameras, of these models.
    std::string of_models(const std::vector<std::string>& models) const {
        std::string text = test::qualisys_xml(cameras_);
        for (std::size_t i = 0; i < models.size(); ++i) {
            const std::size_t at =
                text.find("model=", text.find(fmt::format("serial=\"cam{}\"", i + 1)));
            text.replace(at, text.find('"', at + 7) + 1 - at, "model=\"" + models[i] + "\"");
        }
        return text;
    }
    ImportReport report_of(const std::string& text) {
        options_.files = {folder_.write("a.qca.txt", text)};
        options_.force = true;
        const auto report = import(options_);
        EXPECT_TRUE(report) << report.error().message;
        return report ? *report : ImportReport{};
    }
};

TEST_F(CamerasOfQualisys, OfTheModelOfOthersWithPicturesAreMissed) {
    for (const char* name : {"cam1.avi", "cam2.avi"}) test::write_video(take(name), 64, 48, 8);
    const ImportReport report = report_of(of_models({"Oqus 210c", "Oqus 210c", "Oqus 210c"}));
    EXPECT_THAT(report.problems,
                Contains(AllOf(HasSubstr("has no pictures of 'cam3'"),
                               HasSubstr("'cam3' is of the same model as 'cam1', 'cam2' (Oqus "
                                         "210c)"))));
    EXPECT_THAT(report.told, Not(Contains(HasSubstr("for markers were left out"))));
}

// Most of that model see markers.
TEST_F(CamerasOfQualisys, OfTheModelOfFewWithPicturesAreToBeChecked) {
    cameras_ = [] {
        atrium::test::Random random(22);
        return test::random_room(random, 5);
    }();
    for (auto& camera : cameras_) {
        camera.intrinsics.width = 64;
        camera.intrinsics.height = 48;
    }
    for (const char* name : {"cam1.avi", "cam2.avi"}) test::write_video(take(name), 64, 48, 8);
    const ImportReport report = report_of(of_models(std::vector<std::string>(5, "Oqus 300")));
    EXPECT_THAT(report.problems, Not(Contains(HasSubstr("left out"))));
    EXPECT_THAT(report.checks,
                Contains(HasSubstr("cameras for markers: 'cam3', 'cam4', 'cam5' are of the same "
                                   "model as 'cam1', 'cam2' (Oqus 300), but have no pictures")));
}

TEST_F(CamerasOfQualisys, WithAnEmptyRoomAndNoPicturesAreMissed) {
    for (const char* name : {"cam1.avi", "cam2.avi"}) test::write_video(take(name), 64, 48, 8);
    test::write_video(take("empty_cam3.avi"), 64, 48, 8);
    const ImportReport report = report_of(of_models({"Arqus A9", "Arqus A9", "Miqus M3"}));
    EXPECT_THAT(report.problems,
                Contains(AllOf(HasSubstr("has no pictures of 'cam3'"),
                               HasSubstr("of 'cam3' there is an empty room or a mask"))));
}

TEST_F(CamerasOfQualisys, ThatAreNotActiveButHavePicturesAreAProblem) {
    std::string text = of_models({});
    const std::size_t third = text.find("serial=\"cam3\"");
    text.replace(text.rfind("active=\"1\"", third), 10, "active=\"0\"");
    for (const char* name : {"cam1.avi", "cam2.avi"}) test::write_video(take(name), 64, 48, 8);
    EXPECT_THAT(report_of(text).problems, Not(Contains(HasSubstr("cam3"))));
    test::write_video(take("cam3.avi"), 64, 48, 8);
    const ImportReport report = report_of(text);
    EXPECT_THAT(report.problems,
                Contains(AllOf(HasSubstr("camera 'cam3' left out, although it has pictures "
                                         "('cam3'): it is not active in QTM's file"),
                               HasSubstr("--cameras '!cam3'"))));
    EXPECT_THAT(report.checks, Not(Contains(HasSubstr("cam3"))));
    options_.cameras = {"!cam3"};
    const ImportReport without = report_of(text);
    EXPECT_THAT(without.problems, Not(Contains(HasSubstr("cam3"))));
    EXPECT_THAT(without.checks, Not(Contains(HasSubstr("cam3"))));
}

TEST_F(OtherCameras, KnowsCamerasOfColmapByTheFoldersThatDiffer) {
    const std::string images = test::colmap_images_txt(cameras_, 1.0);
    folder_.write("model/cameras.txt", test::colmap_cameras_txt(cameras_));
    options_.files = {folder_.path() / "model"};
    const std::vector<std::vector<std::string>> layouts{
        {"cam1/rgb", "cam2/rgb", "cam3/rgb"},
        {"head0/left", "head0/right", "head1/left"},
        {"a/cam1/images", "a/cam2/images", "b/cam3/images"},
    };
    for (std::size_t layout = 0; layout < layouts.size(); ++layout) {
        std::string text = images;
        options_.recording = folder_.path() / fmt::format("take{}", layout);
        options_.output = folder_.path() / fmt::format("made{}", layout);
        for (std::size_t camera = 0; camera < 3; ++camera) {
            const std::string old = fmt::format("cam{}/0001.jpg", camera + 1);
            const std::string folder = layouts[layout][camera];
            text.replace(text.find(old), old.size(), folder + "/0001.jpg");
            for (int i = 0; i < 3; ++i)
                test::write_picture(take(fmt::format("{}/{:04}.jpg", folder, i)), 64, 48, 40);
        }
        folder_.write("model/images.txt", text);
        options_.said.distance = Said::Distance{
            layout == 1 ? "head0_left" : "cam1", layout == 1 ? "head0_right" : "cam2", 2.0};
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        const auto source = capture::RecordingSource::open({.folder = options_.output});
        ASSERT_TRUE(source) << source.error().message;
        EXPECT_EQ((*source)->rig().cameras.size(), 3U) << layout;
    }
}

// COLMAP misplaced one picture of ten: the others say where the camera is.
TEST_F(OtherCameras, PicturesThatColmapMisplacedAreLeftOut) {
    const std::string images = test::colmap_images_txt(cameras_, 1.0);
    const std::size_t start = images.find("1 ", images.find("lines of data"));
    const std::string line = images.substr(start, images.find('\n', start) - start);
    ASSERT_TRUE(line.ends_with("cam1/0001.jpg")) << line;
    std::string more = images;
    for (int i = 2; i <= 10; ++i) {
        std::string other = line;
        other.replace(other.find("0001.jpg"), 8, fmt::format("{:04}.jpg", i));
        // the first one of the file is the odd one
        const std::string moved = "1 1 0 0 0 9 9 9 1 cam1/0001.jpg";
        more = i == 2 ? moved + "\n\n" + other + "\n" + images.substr(images.find('\n', start) + 1)
                      : more + other + "\n\n";
    }
    folder_.write("model/cameras.txt", test::colmap_cameras_txt(cameras_));
    folder_.write("model/images.txt", more);
    const auto rig = read_foreign({folder_.path() / "model"}, "auto", {});
    ASSERT_TRUE(rig) << rig.error().message;
    ASSERT_EQ(rig->cameras.size(), 3U);
    EXPECT_THAT(rig->checks,
                ElementsAre(AllOf(HasSubstr("camera 'cam1': 9 of its 10 images stand in one place"),
                                  HasSubstr("not cam1/0001.jpg: COLMAP erred there"))));
    for (const ForeignCamera& camera : rig->cameras) {
        if (camera.name != "cam1") continue;
        const auto& truth = cameras_.front().camera_from_site.translation;
        EXPECT_LT((camera.pose->vector - truth).norm(), 1e-9);
    }
}

TEST_F(OtherCameras, OneThatIsLeftOutMeasuresNothing) {
    write_model("phone", 0.2);
    options_.recording.clear();
    options_.output = folder_.path() / "rig.toml";
    options_.said.distance = Said::Distance{"phone", "cam2", 2.0};
    const auto report = import(options_);
    ASSERT_FALSE(report);
    EXPECT_THAT(report.error().message,
                AllOf(HasSubstr("camera 'phone': its 9 images stand up to "),
                      HasSubstr("so it moved: left out")));
}

// Of a text and a binary model in one folder the newer one counts, and the other is named.
TEST_F(OtherCameras, TheNewerOfTwoModelsOfColmapIsRead) {
    namespace fs = std::filesystem;
    auto other = cameras_;
    for (auto& camera : other) camera.intrinsics.fx *= 1.08;
    const fs::path folder = folder_.path() / "model";
    folder_.write("model/cameras.bin", test::colmap_cameras_bin(other));
    const fs::path binary = folder_.write("model/images.bin", test::colmap_images_bin(other));
    folder_.write("model/cameras.txt", test::colmap_cameras_txt(cameras_));
    const fs::path text = folder_.write("model/images.txt", test::colmap_images_txt(cameras_, 1.0));
    const auto focal_length = [&](const fs::path& given, const char* said) {
        const auto rig = read_foreign({given}, "auto", {});
        EXPECT_TRUE(rig) << rig.error().message;
        EXPECT_EQ(rig->checks.size(), said == nullptr ? 0U : 1U);
        if (said != nullptr) {
            EXPECT_THAT(rig->checks, ElementsAre(HasSubstr(said)));
        }
        return rig->cameras.front().lens.fx;
    };
    const double right = cameras_.front().intrinsics.fx;
    const auto now = fs::file_time_type::clock::now();
    for (const bool is_text_newer : {true, false}) {
        fs::last_write_time(text, now);
        fs::last_write_time(binary, now + std::chrono::hours(is_text_newer ? -24 : 24));
        EXPECT_NEAR(
            focal_length(folder,
                         is_text_newer ? "cameras.txt and images.txt are newer and were read"
                                       : "cameras.bin and images.bin are newer"),
            is_text_newer ? right : 1.08 * right,
            1e-6);
    }
    EXPECT_NEAR(focal_length(folder / "cameras.txt", nullptr), right, 1e-6);
    folder_.write("model/cameras.bin", test::colmap_cameras_bin(cameras_));
    EXPECT_NEAR(focal_length(folder, nullptr), right, 1e-6) << "two files of one model";
}

// Undistorted pictures have sizes of their own; those of the cameras are not cropped.
TEST_F(OtherCameras, AModelOfUndistortedPicturesIsNamed) {
    const std::vector<std::array<int, 2>> sizes{{70, 52}, {68, 51}, {64, 48}};
    auto undistorted = cameras_;
    for (std::size_t i = 0; i < 3; ++i) {
        geometry::PinholeCamera& lens = undistorted[i].intrinsics;
        lens.distortion = {};
        lens.width = sizes[i][0];
        lens.height = sizes[i][1];
    }
    folder_.write("model/cameras.txt", test::colmap_cameras_txt(undistorted));
    folder_.write("model/images.txt", test::colmap_images_txt(undistorted, 1.0));
    options_.files = {folder_.path() / "model"};
    options_.said.distance = Said::Distance{"cam1", "cam2", 2.0};
    for (int camera = 1; camera <= 3; ++camera)
        write_picture(take(fmt::format("cam{}/frame_000001.png", camera)), 64, 48, 40);
    const auto refused = import(options_);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                AllOf(HasSubstr("calibrated at 70x52 px"),
                      HasSubstr("`colmap image_undistorter` made (dense/)"),
                      HasSubstr("(sparse/0)")));
    options_.said.size = {64, 48};
    const auto scaled = import(options_);
    ASSERT_TRUE(scaled) << scaled.error().message;
    EXPECT_THAT(scaled->checks, Contains(HasSubstr("leave --size out")));
}

}  // namespace
}  // namespace atrium::calibrate
