#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/lens_fit.hpp"
#include "tools/calibrate/picture_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include <algorithm>
#include <regex>
#include <sstream>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Reads files without saying the format, and concludes without saying anything.
Expected<Conclusion> read_and_conclude(const Files& files, const Said& said = {}) {
    const auto foreign = read_foreign(files, "auto");
    if (!foreign) return tl::unexpected(foreign.error());
    return conclude(*foreign, said);
}

class Formats : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        atrium::test::Random random(static_cast<std::uint64_t>(GetParam()));
        cameras_ = test::random_room(random, 3 + GetParam() % 6);
    }
    void expect_truth(const Files& files, double tolerance = 1e-6) {
        const auto result = read_and_conclude(files);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_LT(test::difference(result->rig.cameras, cameras_), tolerance);
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            EXPECT_EQ(result->rig.cameras[i].name, cameras_[i].name);
    }
    void keep_only(std::size_t num_coefficients) {
        for (auto& camera : cameras_)
            std::fill(camera.intrinsics.distortion.begin() +
                          static_cast<std::ptrdiff_t>(num_coefficients),
                      camera.intrinsics.distortion.end(),
                      0.0);
    }

    test::Folder folder_;
    test::Cameras cameras_;
};

INSTANTIATE_TEST_SUITE_P(Rigs, Formats, testing::Range(1, 7));

TEST_P(Formats, OpenCvYaml) {
    expect_truth({folder_.write("all.yml", test::opencv_yaml(cameras_, 1.0))});
}

TEST_P(Formats, OpenCvXmlWithVectors) {
    expect_truth({folder_.write("all.xml", test::opencv_xml(cameras_))});
}

TEST_P(Formats, OpenCvJson) {
    expect_truth({folder_.write("calib.json", test::opencv_json(cameras_))});
}

TEST_P(Formats, OpenCvJsonWithCoefficientsByName) {
    const std::string listed = test::opencv_json(cameras_);
    const std::regex five(
        R"("distCoef": \[([^,\]]+), ([^,\]]+), ([^,\]]+), ([^,\]]+), ([^,\]]+)\])");
    const std::string named =
        std::regex_replace(listed, five, R"("k1": $1, "k2": $2, "p1": $3, "p2": $4, "k3": $5)");
    ASSERT_THAT(named, testing::Not(testing::HasSubstr("distCoef")));
    expect_truth({folder_.write("calib.json", named)});
}

TEST_P(Formats, OpenCvOneFilePerCamera) {
    Files files;
    for (const auto& camera : cameras_) {
        std::string text = test::opencv_yaml({camera}, 1.0);
        // the same keys at the top level
        text.erase(text.find(camera.name), camera.name.size() + 2);
        for (std::size_t at = 0; (at = text.find("\n   ", at)) != std::string::npos; ++at)
            text.erase(at + 1, 3);
        files.push_back(folder_.write(camera.name + ".yaml", text));
    }
    expect_truth(files);
}

TEST_P(Formats, IntrinsicsAndExtrinsicsSideBySide) {
    const Files files{folder_.write("intri.yml", test::easymocap_intri(cameras_)),
                      folder_.write("extri.yml", test::easymocap_extri(cameras_))};
    auto foreign = read_foreign(files, "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    const auto unsized = conclude(*foreign, {});
    ASSERT_FALSE(unsized);
    EXPECT_THAT(unsized.error().message, AllOf(HasSubstr("picture size"), HasSubstr("--size")));
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        const auto& lens = cameras_[i].intrinsics;
        ASSERT_TRUE(set_picture_size(foreign->cameras[i], {lens.width, lens.height}));
    }
    const auto result = conclude(*foreign, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_LT(test::difference(result->rig.cameras, cameras_), 1e-6);
}

// Two files of stereoCalibrate: the first camera is the frame.
TEST_P(Formats, OpenCvStereoPair) {
    cameras_.resize(2);
    std::string intrinsics = test::easymocap_intri(cameras_);
    for (const auto& [from, to] : {std::pair{"K_cam", "M"}, {"dist_cam", "D"}}) {
        for (std::size_t at = 0; (at = intrinsics.find(from, at)) != std::string::npos;)
            intrinsics.replace(at, std::string(from).size(), to);
    }
    test::Cameras second = {cameras_[1]};
    second[0].camera_from_site =
        second[0].camera_from_site * cameras_[0].camera_from_site.inverse();
    second[0].name = "x";
    std::string pose = test::easymocap_extri(second);
    pose.erase(pose.find("R_x"), pose.find("Rot_x") - pose.find("R_x"));
    pose.replace(pose.find("Rot_x"), 5, "R").replace(pose.find("T_x"), 3, "T");
    auto foreign = read_foreign(
        {folder_.write("intrinsics.yml", intrinsics), folder_.write("extrinsics.yml", pose)},
        "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    ASSERT_EQ(foreign->cameras.size(), 2u);
    const auto camera2 = camera_from_site(*foreign->cameras[1].pose, {});
    EXPECT_LT((camera2.translation - second[0].camera_from_site.translation).norm(), 1e-9);
    EXPECT_LT(camera2.rotation.angularDistance(second[0].camera_from_site.rotation), 1e-9);
    EXPECT_DOUBLE_EQ(foreign->cameras[1].lens.fx, cameras_[1].intrinsics.fx);
}

TEST_P(Formats, Qualisys) {
    expect_truth({folder_.write("lab.qca.txt", test::qualisys_xml(cameras_))});
}

// As other programs write QTM's elements: no window of the sensor, sensorMax the size or the last
// pixel.
TEST_P(Formats, QualisysInPixels) {
    for (const int beyond_last : {1, 0}) {
        pugi::xml_document document;
        ASSERT_TRUE(document.load_string(test::qualisys_xml(cameras_).c_str()));
        std::size_t i = 0;
        for (const pugi::xml_node camera :
             document.child("calibration").child("cameras").children("camera")) {
            if (!camera.child("intrinsic")) continue;
            const auto& k = cameras_.at(i++).intrinsics;
            pugi::xml_node found = camera;
            found.remove_child("fov_video");
            const pugi::xml_node intrinsic = camera.child("intrinsic");
            intrinsic.attribute("sensorMaxU").set_value(k.width - 1 + beyond_last);
            intrinsic.attribute("sensorMaxV").set_value(k.height - 1 + beyond_last);
            intrinsic.attribute("focalLengthU").set_value(k.fx);
            intrinsic.attribute("focalLengthV").set_value(k.fy);
            intrinsic.attribute("centerPointU").set_value(k.cx);
            intrinsic.attribute("centerPointV").set_value(k.cy);
        }
        std::ostringstream text;
        document.save(text);
        const auto file = folder_.write("pixels.qca.txt", text.str());
        expect_truth({file});
        const auto result = read_and_conclude({file});
        ASSERT_TRUE(result);
        for (i = 0; i < cameras_.size(); ++i) {
            EXPECT_EQ(result->rig.cameras[i].intrinsics.width, cameras_[i].intrinsics.width);
            EXPECT_EQ(result->rig.cameras[i].intrinsics.height, cameras_[i].intrinsics.height);
        }
        const auto lines = std::ranges::count_if(result->told, [](const std::string& line) {
            return line.starts_with("intrinsics: in pixels, not in 1/64 px");
        });
        EXPECT_EQ(lines, 1);
    }
}

TEST_P(Formats, Vicon) {
    keep_only(2);
    expect_truth({folder_.write("lab.xcp", test::vicon_xcp(cameras_))});
}

TEST_P(Formats, Anipose) {
    expect_truth({folder_.write("calibration.toml", test::anipose_toml(cameras_, 1000.0))});
}

TEST_P(Formats, CaliscopeCallsCamerasByNumber) {
    for (std::size_t i = 0; i < cameras_.size(); ++i) cameras_[i].name = "cam_" + std::to_string(i);
    expect_truth({folder_.write("config.toml", test::caliscope_toml(cameras_))});
}

// Frames of COLMAP and Kalibr mean nothing: the up, origin and turn of the rig are our own.
void expect_same_shape(const test::Cameras& found, const test::Cameras& truth, double tolerance) {
    ASSERT_EQ(found.size(), truth.size());
    const geometry::RigidTransform found_from_truth =
        found[0].camera_from_site.inverse() * truth[0].camera_from_site;
    test::Cameras moved = truth;
    for (auto& camera : moved)
        camera.camera_from_site = camera.camera_from_site * found_from_truth.inverse();
    EXPECT_LT(test::difference(found, moved), tolerance);
    const Eigen::Vector3d up = found_from_truth.rotation * Eigen::Vector3d::UnitZ();
    EXPECT_GT(up.z(), 0.998);  // the pictures are tilted by up to 3 degrees each
}

TEST_P(Formats, ColmapTextAndBinary) {
    Said said;
    const double apart = (cameras_[0].centre_site() - cameras_[2].centre_site()).norm();
    said.distance = Said::Distance{cameras_[0].name, cameras_[2].name, apart};
    folder_.write("text/cameras.txt", test::colmap_cameras_txt(cameras_));
    folder_.write("text/images.txt", test::colmap_images_txt(cameras_, 0.37));
    folder_.write("binary/sparse/0/cameras.bin", test::colmap_cameras_bin(cameras_));
    folder_.write("binary/sparse/0/images.bin", test::colmap_images_bin(cameras_));
    for (const char* name : {"text", "binary", "text/images.txt"}) {
        const auto result = read_and_conclude({folder_.path() / name}, said);
        ASSERT_TRUE(result) << result.error().message;
        expect_same_shape(result->rig.cameras, cameras_, 1e-6);
        EXPECT_EQ(result->rig.cameras[1].name, "cam2");
    }
    const auto unscaled = read_and_conclude({folder_.path() / "text"});
    ASSERT_FALSE(unscaled);
    EXPECT_THAT(unscaled.error().message, HasSubstr("--distance cam1 cam2"));
}

TEST_P(Formats, Kalibr) {
    keep_only(4);
    const auto result =
        read_and_conclude({folder_.write("camchain.yaml", test::kalibr_yaml(cameras_))});
    ASSERT_TRUE(result) << result.error().message;
    expect_same_shape(result->rig.cameras, cameras_, 1e-6);
}

TEST_P(Formats, ComeBackFromAnExport) {
    keep_only(2);
    cameras_[0].intrinsics.distortion[4] = GetParam() % 2 == 0 ? 0.01 : 0.0;
    const std::vector<std::pair<std::string, std::string>> all{{"opencv", "a.yml"},
                                                               {"opencv", "a.xml"},
                                                               {"opencv", "a.json"},
                                                               {"qualisys", "b.xml"},
                                                               {"vicon", "c.xcp"},
                                                               {"colmap", "d"},
                                                               {"anipose", "e.toml"}};
    config::Rig rig;
    rig.cameras = cameras_;
    for (const auto& [format, name] : all) {
        const auto lost = write_foreign(rig, *format_of(format), folder_.path() / name);
        ASSERT_TRUE(lost) << lost.error().message;
        Said said;
        if (format == "colmap") {
            said.distance = Said::Distance{
                "cam1", "cam2", (cameras_[0].centre_site() - cameras_[1].centre_site()).norm()};
        }
        const auto back = read_and_conclude({folder_.path() / name}, said);
        ASSERT_TRUE(back) << format << ": " << back.error().message;
        if (format == "colmap") {
            expect_same_shape(back->rig.cameras, cameras_, 1e-6);
        } else {
            EXPECT_LT(test::difference(back->rig.cameras, cameras_), 1e-6) << format;
        }
    }
    const auto kalibr = write_foreign(rig, Format::kKalibr, folder_.path() / "f.yaml");
    ASSERT_TRUE(kalibr);
    EXPECT_EQ(GetParam() % 2 == 0, std::ranges::any_of(*kalibr, [](const std::string& line) {
                  return line.find("k3 of cam1") != std::string::npos;
              }));
}

// Vicon's older model straightens pixels; ours distorts rays.
TEST(Lenses, OfViconInPixelsAreFitted) {
    atrium::test::Random random(5);
    const test::Folder folder;
    test::Cameras cameras = test::random_room(random, 4);
    for (auto& camera : cameras) {
        camera.intrinsics.fy = camera.intrinsics.fx;
        camera.intrinsics.distortion = {2.0e-8, 1.0e-15, 0.0, 0.0, 0.0};
    }
    const auto foreign = read_foreign({folder.write("a.xcp", test::vicon_xcp(cameras))}, "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    for (const ForeignCamera& camera : foreign->cameras) {
        const auto& k = camera.lens;
        for (const Eigen::Vector2d& pixel :
             {Eigen::Vector2d(3, 5), Eigen::Vector2d(k.cx, 0.9 * k.height)}) {
            const Eigen::Vector2d off = pixel - Eigen::Vector2d(k.cx, k.cy);
            const double r2 = off.squaredNorm();
            const Eigen::Vector2d straight =
                Eigen::Vector2d(k.cx, k.cy) + off * (1 + 2.0e-8 * r2 + 1.0e-15 * r2 * r2);
            EXPECT_LT((k.distort(straight) - pixel).norm(), 0.1);
        }
    }
}

TEST(Lenses, OfColmapsFisheyesAreFitted) {
    const test::Folder folder;
    atrium::test::Random random(6);
    folder.write("images.txt", test::colmap_images_txt(test::random_room(random, 3), 1.0));
    const std::string size = " 1280 720 ";
    folder.write("cameras.txt",
                 "1 OPENCV_FISHEYE" + size + "900 910 640.5 360.5 0.02 -0.01 0.004 0.001\n" +
                     "2 RADIAL_FISHEYE" + size + "900 640.5 360.5 0.02 -0.01\n" +
                     "3 SIMPLE_RADIAL_FISHEYE" + size + "900 640.5 360.5 0.02\n");
    const auto foreign = read_foreign({folder.path()}, "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    ASSERT_EQ(foreign->cameras.size(), 3U);
    const std::vector<std::vector<double>> polynomials{
        {0.02, -0.01, 0.004, 0.001}, {0.02, -0.01}, {0.02}};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& k = foreign->cameras[i].lens;
        for (const Eigen::Vector2d& ray : {Eigen::Vector2d(0.6, 0.3), Eigen::Vector2d(-0.2, 0.4)}) {
            const double angle = std::atan(ray.norm());
            double distorted = angle;
            for (std::size_t n = 0; n < polynomials[i].size(); ++n)
                distorted +=
                    polynomials[i][n] * std::pow(angle, 3.0 + 2.0 * static_cast<double>(n));
            const Eigen::Vector2d expected =
                Eigen::Vector2d(640, 360) +
                Eigen::Vector2d(900, i == 0 ? 910 : 900).cwiseProduct(ray.normalized() * distorted);
            const Eigen::Vector2d undistorted(k.cx + k.fx * ray.x(), k.cy + k.fy * ray.y());
            EXPECT_LT((k.distort(undistorted) - expected).norm(), 0.3) << i;
        }
    }
}

TEST(Lenses, OfRationalModelsAreFittedOrRefused) {
    geometry::PinholeCamera camera{
        .width = 1280, .height = 720, .fx = 1000, .fy = 1000, .cx = 640, .cy = 360};
    const std::vector<double> mild{0.1, -0.05, 1e-3, -5e-4, 0.01, 0.02, 0.0, 0.0};
    EXPECT_LT(fit_lens(camera, rational_lens(mild)).error_px, 0.05);
    const std::vector<double> fisheye{0.0, 0.0, 0.0, 0.0};
    camera.fx = camera.fy = 360.0;  // 180 degrees
    EXPECT_GT(fit_lens(camera, equidistant_lens(fisheye)).error_px, 2.0);
}

// The colour cameras of an Azure Kinect, as its makers calibrate them: 2.5 px of 1280 are fitted.
TEST(Lenses, OfKinectsAreReadWithANote) {
    const test::Folder folder;
    const auto camera = [](const char* name, const char* t) {
        return fmt::format(
            R"("{}": {{"K": [613.02, 0, 648.1, 0, 612.93, 373.5, 0, 0, 1], "size": [1280, 720],
               "dist": [0.403863, -2.602884, 0.000894, -4.17e-05,
                        1.511878, 0.284275, -2.420721, 1.435424],
               "R": [1, 0, 0, 0, 1, 0, 0, 0, 1], "t": [{}]}})",
            name,
            t);
    };
    const auto rig = read_foreign(
        {folder.write("k.json", "{" + camera("a", "0, 0, 3") + "," + camera("b", "1, 0, 3") + "}")},
        "auto");
    ASSERT_TRUE(rig) << rig.error().message;
    EXPECT_THAT(rig->notes,
                testing::Contains(
                    AllOf(HasSubstr("(rational, thin prism) was fitted, with an error of up to 2."),
                          HasSubstr("people near its border lose a rim"))));
}

TEST(Formats, SayWhatTheyCannotRead) {
    const test::Folder folder;
    atrium::test::Random random(1);
    const test::Cameras cameras = test::random_room(random, 3);
    std::string fov = test::colmap_cameras_txt(cameras);
    fov.replace(fov.find("OPENCV"), 6, "FOV");
    folder.write("model/cameras.txt", fov);
    folder.write("model/images.txt", test::colmap_images_txt(cameras, 1.0));
    const auto model = read_foreign({folder.path() / "model"}, "auto");
    ASSERT_FALSE(model);
    EXPECT_THAT(model.error().message,
                AllOf(HasSubstr("FOV"), HasSubstr("--ImageReader.camera_model OPENCV")));
    const auto alone =
        read_foreign({folder.write("intri.yml", test::easymocap_intri(cameras))}, "auto");
    ASSERT_FALSE(alone);
    EXPECT_THAT(
        alone.error().message,
        AllOf(HasSubstr("no rotation and translation of cam1, cam2"), HasSubstr("all files")));
    EXPECT_THAT(alone.error().message, testing::Not(HasSubstr("--cameras")));
    const auto unknown = read_foreign({folder.write("a.txt", "hello")}, "auto");
    ASSERT_FALSE(unknown);
    EXPECT_THAT(unknown.error().message, AllOf(HasSubstr("a.txt"), HasSubstr("--format")));
}

}  // namespace
}  // namespace atrium::calibrate
