// From the files of another program to a person: pictures of a simulated room, in the layout, names
// and units of other programs, give the hull that the true rig gives.
#include "simulation/room_renderer.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/support/run_program.hpp"
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"
#include "tools/calibrate/formats/rig_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using test_support::run_program;
using testing::HasSubstr;

constexpr int kNumCameras = 6;
constexpr int kNumFrames = 3;
constexpr int kNumEmpty = 6;
constexpr double kVideoRate_hz = 30.0;
// The pictures are the same; only MJPEG and the numbers' digits differ.
constexpr double kSameVolume = 0.01;

cv::Mat to_mat(const image::YuvImage& picture) {
    std::vector<std::uint8_t> bgr = atrium::test::bgr_from_yuv(image::YuvView(picture));
    return cv::Mat(picture.height(), picture.width(), CV_8UC3, bgr.data()).clone();
}

struct Pictures {
    std::vector<cv::Mat> frames;
    std::vector<cv::Mat> empty;
};

// Filmed once for all tests.
class ImportedPerson : public testing::Test {
protected:
    static void SetUpTestSuite() {
        cameras_ = new test::Cameras(simulation::ring(kNumCameras));
        simulation::RoomOptions options;
        options.motion = "wave";
        auto room = simulation::RoomRenderer::create(*cameras_, options);
        ASSERT_TRUE(room) << room.error().message;
        pictures_ = new std::vector<Pictures>(kNumCameras);
        image::YuvImage picture;
        std::uint32_t shot = 0;
        for (int i = 0; i < kNumFrames + kNumEmpty; ++i) {
            const bool is_empty = i >= kNumFrames;
            for (std::size_t camera = 0; camera < kNumCameras; ++camera) {
                room->render(is_empty ? 0.0 : i / kVideoRate_hz,
                             camera,
                             is_empty ? simulation::Scene::kEmptyRoom : simulation::Scene::kPerson,
                             ++shot,
                             picture);
                Pictures& own = (*pictures_)[camera];
                (is_empty ? own.empty : own.frames).push_back(to_mat(picture));
            }
        }
    }
    static void TearDownTestSuite() {
        delete pictures_;
        delete cameras_;
    }

    static void write_sequence(const fs::path& folder,
                               const std::vector<cv::Mat>& pictures,
                               const char* name,
                               int first = 0) {
        fs::create_directories(folder);
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            const std::string file = cv::format(name, first + static_cast<int>(i));
            ASSERT_TRUE(cv::imwrite((folder / file).string(), pictures[i]));
        }
    }
    static void write_video(const fs::path& file, const std::vector<cv::Mat>& pictures) {
        fs::create_directories(file.parent_path());
        cv::VideoWriter video(file.string(),
                              cv::VideoWriter::fourcc('F', 'F', 'V', '1'),
                              kVideoRate_hz,
                              pictures[0].size());
        ASSERT_TRUE(video.isOpened());
        for (const cv::Mat& picture : pictures) video.write(picture);
    }

    // Litres of the hull of a recording's second frame.
    static double volume_l(const fs::path& recording) {
        const auto outcome = run_program(
            fmt::format(
                "{}/visual_hull --recording {} --frame 1", ATRIUM_BIN_DIR, recording.string()),
            60);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
        const auto report = nlohmann::json::parse(outcome.output, nullptr, false);
        return report.is_object() ? 1000.0 * report.value("volume_m3", 0.0) : 0.0;
    }

    double true_volume_l() const {
        config::Rig rig;
        rig.cameras = *cameras_;
        const fs::path folder = folder_.path() / "true";
        for (std::size_t i = 0; i < kNumCameras; ++i) {
            const fs::path own = folder / (*cameras_)[i].name;
            write_sequence(own / "frames", (*pictures_)[i].frames, "%06d.png");
            write_sequence(own / "background", (*pictures_)[i].empty, "%06d.png");
        }
        EXPECT_TRUE(write_text(folder / "rig.toml", rig_text(rig, {}), false));
        return volume_l(folder);
    }

    // Imports, compares the hull, and plays the recording in a site.
    void expect_the_person(const std::string& arguments) {
        const fs::path made = folder_.path() / "made";
        const auto imported = run_program(fmt::format("{}/calibrate import {} --recording {} -o {}",
                                                      ATRIUM_BIN_DIR,
                                                      arguments,
                                                      (folder_.path() / "take").string(),
                                                      made.string()),
                                          60);
        ASSERT_EQ(imported.exit_code, 0) << imported.output;
        EXPECT_THAT(imported.output, HasSubstr("the empty room was found for every camera"));
        const double truth = true_volume_l();
        EXPECT_GT(truth, 40.0);
        EXPECT_NEAR(volume_l(made) / truth, 1.0, kSameVolume) << imported.output;
        const auto played = run_program(
            fmt::format("{}/site_node --site.name imported --capture.source recording "
                        "--capture.recording {} --capture.rate_hz 2 --bus.world import-{} "
                        "--bus.domain 183",
                        ATRIUM_BIN_DIR,
                        made.string(),
                        getpid()),
            60);
        EXPECT_EQ(played.exit_code, 0) << played.output;
        EXPECT_THAT(played.output, HasSubstr(fmt::format("stopped captured={}", kNumFrames)));
        EXPECT_THAT(played.output, HasSubstr("failed=0"));
    }

    static inline test::Cameras* cameras_ = nullptr;
    static inline std::vector<Pictures>* pictures_ = nullptr;
    test::Folder folder_;
};

TEST_F(ImportedPerson, OfQualisysVideos) {
    test::Cameras named = *cameras_;
    for (std::size_t i = 0; i < kNumCameras; ++i) {
        named[i].name = fmt::format("{}", 23001 + 7 * i);
        const std::string name = fmt::format("_Miqus_{}_{}.avi", i + 1, named[i].name);
        write_video(folder_.path() / "take" / ("walk0003" + name), (*pictures_)[i].frames);
        write_video(folder_.path() / "take/background" / ("static0001" + name),
                    (*pictures_)[i].empty);
    }
    expect_the_person(folder_.write("walk0003.qca.txt", test::qualisys_xml(named)).string());
}

TEST_F(ImportedPerson, OfOpenCvPicturesInMillimetresWithYDown) {
    const Eigen::Matrix3d y_down = Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX())
                                       .toRotationMatrix()
                                       .transpose();
    const test::Cameras turned = test::in_frame(*cameras_, y_down);
    for (std::size_t i = 0; i < kNumCameras; ++i) {
        const std::string name = turned[i].name;
        write_sequence(
            folder_.path() / "take/images" / name, (*pictures_)[i].frames, "frame_%04d.png", 17);
        write_sequence(folder_.path() / "take/bg" / name, (*pictures_)[i].empty, "%d.png");
    }
    expect_the_person(folder_.write("calib.yml", test::opencv_yaml(turned, 1000.0)).string());
}

TEST_F(ImportedPerson, OfAColmapModelWithoutScaleAndFrame) {
    const Eigen::Matrix3d any =
        Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()).toRotationMatrix();
    const test::Cameras turned = test::in_frame(*cameras_, any);
    folder_.write("sparse/0/cameras.txt", test::colmap_cameras_txt(turned));
    folder_.write("sparse/0/images.txt", test::colmap_images_txt(turned, 0.83));
    for (std::size_t i = 0; i < kNumCameras; ++i) {
        const std::string name = turned[i].name;
        write_sequence(
            folder_.path() / "take" / name / "images", (*pictures_)[i].frames, "%04d.png", 1);
        write_sequence(
            folder_.path() / "take" / name / "empty", (*pictures_)[i].empty, "%04d.png", 1);
    }
    const double apart = ((*cameras_)[0].centre_site() - (*cameras_)[3].centre_site()).norm();
    expect_the_person(fmt::format("{} --distance cam0 cam3 {} --camera-height cam0 1.1",
                                  (folder_.path() / "sparse/0").string(),
                                  apart));
}

}  // namespace
}  // namespace atrium::calibrate
