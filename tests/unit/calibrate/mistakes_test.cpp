// Calibrations with the mistakes that people make: the message names the camera and the cure.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

class Mistakes : public testing::Test {
protected:
    Expected<Conclusion> conclude_from(const std::string& name,
                                       const std::string& text,
                                       const Said& said = {}) const {
        const auto foreign = read_foreign({folder_.write(name, text)}, "auto");
        if (!foreign) return tl::unexpected(foreign.error());
        return conclude(*foreign, said);
    }
    std::string error_of(const std::string& name, const std::string& text) const {
        const auto result = conclude_from(name, text);
        return result ? "no error" : result.error().message;
    }

    atrium::test::Random random_{77};
    test::Folder folder_;
    test::Cameras cameras_ = test::random_room(random_, 5);
};

TEST_F(Mistakes, ACameraThatQtmDidNotCalibrateIsLeftOut) {
    std::string text = test::qualisys_xml(cameras_);
    const std::size_t third = text.find("serial=\"cam3\"");
    const std::size_t attribute = text.rfind("calibrated=\"true\"", third);
    text.replace(attribute, 17, "calibrated=\"false\"");
    // QTM writes zeros
    const std::size_t transform = text.find("<transform", third);
    text.replace(transform, text.find("/>", transform) - transform, "<transform x=\"0\" r11=\"0\"");
    const auto result = conclude_from("a.qca.txt", text);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->rig.cameras.size(), 4U);
    EXPECT_THAT(
        result->problems,
        ElementsAre(HasSubstr("camera 'cam3' is not calibrated (QTM says so): left out; ")));
    std::string none = test::qualisys_xml({cameras_[0], cameras_[1]});
    none = replaced(none, "calibrated=\"true\"", "calibrated=\"false\"");
    EXPECT_THAT(error_of("b.qca.txt", none),
                AllOf(HasSubstr("1 cameras found"), HasSubstr("'cam1' is not calibrated")));
}

TEST_F(Mistakes, RotationVectorsInDegreesAreNamed) {
    std::string text = test::opencv_xml(cameras_);
    const std::size_t rotation = text.find("rvec");
    ASSERT_NE(rotation, std::string::npos);
    const std::size_t data = text.find("<data>", rotation);
    ASSERT_NE(data, std::string::npos);
    text.replace(data, text.find("</data>", data) - data, "<data>118 2 -7");
    EXPECT_THAT(error_of("a.xml", text),
                AllOf(HasSubstr("its rotation vector is 118 long"), HasSubstr("in degrees?")));
}

TEST_F(Mistakes, Utf16IsNamed) {
    EXPECT_THAT(error_of("a.xml", std::string("\xFF\xFE<\0c\0", 6)),
                AllOf(HasSubstr("is text in UTF-16"), HasSubstr("iconv -f UTF-16")));
}

TEST_F(Mistakes, CamerasForMarkersAreNamed) {
    std::string text = test::qualisys_xml(cameras_);
    const std::size_t third = text.find("serial=\"cam3\"");
    text.replace(text.rfind("active=\"1\"", third), 10, "active=\"0\"");
    const auto result = conclude_from("a.qca.txt", text);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->told,
                Contains(testing::ContainsRegex("cameras that are not active, or for markers "
                                                "without a calibration, were left out: .*cam3")));
}

TEST_F(Mistakes, AxesThatAreSaidWronglyAreToBeLeftOut) {
    Said said;
    said.opengl = true;
    const auto wrong = conclude_from("a.yml", test::opencv_yaml(cameras_, 1000.0), said);
    ASSERT_TRUE(wrong) << wrong.error().message;
    EXPECT_THAT(wrong->problems, Contains(HasSubstr("leave --direction and --axes out")));
}

TEST_F(Mistakes, ACameraThatLooksElsewhereIsNamed) {
    const auto whole = conclude_from("a.yml", test::opencv_yaml(cameras_, 1000.0));
    ASSERT_TRUE(whole);
    EXPECT_THAT(whole->problems, IsEmpty());
    // turned around upright axis of its own by 100 degrees
    test::Cameras turned = cameras_;
    auto& pose = turned[2].camera_from_site;
    const Eigen::Vector3d centre = turned[2].centre_site();
    pose.rotation = Eigen::AngleAxisd(1.75, Eigen::Vector3d::UnitY()) * pose.rotation;
    pose.translation = -(pose.rotation * centre);
    const auto result = conclude_from("b.yml", test::opencv_yaml(turned, 1000.0));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->told, Contains(HasSubstr("4 of 5 cameras look at one place")));
    EXPECT_THAT(result->problems,
                ElementsAre(AllOf(HasSubstr("camera 'cam3' does not look at the place"),
                                  HasSubstr("calibrate it again"))));
    test::Cameras unset = cameras_;
    for (auto& camera : unset) {
        camera.camera_from_site =
            camera.camera_from_site * geometry::RigidTransform{Eigen::Quaterniond::Identity(),
                                                               Eigen::Vector3d(-5.0, 0.0, 0.0)};
    }
    unset[4].camera_from_site = {};
    const auto origin = conclude_from("c.yml", test::opencv_yaml(unset, 1000.0));
    ASSERT_TRUE(origin) << origin.error().message;
    EXPECT_THAT(origin->problems,
                ElementsAre(AllOf(HasSubstr("camera 'cam5'"), HasSubstr("never calibrated"))));
}

TEST_F(Mistakes, TwoCamerasWithOnePoseAreAProblem) {
    cameras_[3].camera_from_site = cameras_[1].camera_from_site;
    const auto result = conclude_from("a.yml", test::opencv_yaml(cameras_, 1000.0));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->problems,
                ElementsAre(AllOf(HasSubstr("cameras 'cam2' and 'cam4' have exactly the same pose"),
                                  HasSubstr("--cameras '!cam4'"))));
}

// As Anipose and FreeMoCap write it: z = 0 would be the height of the lens.
TEST_F(Mistakes, TheFrameOfALevelCameraHasNoFloor) {
    const auto of_room = conclude_from("a.toml", test::anipose_toml(cameras_, 1000.0));
    ASSERT_TRUE(of_room) << of_room.error().message;
    EXPECT_THAT(of_room->told, Contains(HasSubstr("floor: z = 0 of the file")));
    test::Cameras level = cameras_;
    const Eigen::Vector3d centre = level[0].centre_site();
    const Eigen::Vector3d ahead = Eigen::Vector3d(-centre.x(), -centre.y(), 0.0).normalized();
    const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ());
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), -Eigen::Vector3d::UnitZ().transpose(), ahead.transpose();
    const geometry::RigidTransform own{Eigen::Quaterniond(rotation), -(rotation * centre)};
    level[0].camera_from_site = own;
    for (auto& camera : level) camera.camera_from_site = camera.camera_from_site * own.inverse();
    const auto result = conclude_from("b.toml", test::anipose_toml(level, 1000.0));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->checks,
                Contains(AllOf(HasSubstr("floor: unknown; 1 m below what the cameras look at"),
                               HasSubstr("--camera-height cam1 METRES"))));
    EXPECT_GT(result->rig.cameras[0].centre_site().z(), 1.0);  // the lens
}

TEST_F(Mistakes, AHeightSaysWhereThenTheCamerasLook) {
    Said said;
    const double height = cameras_[0].centre_site().z();
    said.heights = {{"cam1", height}};
    const std::string text = test::opencv_yaml(cameras_, 1000.0);
    const auto right = conclude_from("a.yml", text, said);
    ASSERT_TRUE(right);
    EXPECT_THAT(right->told, Contains(HasSubstr("as you say, so the cameras look at a place ")));
    EXPECT_THAT(right->checks, Not(Contains(HasSubstr("floor:"))));
    said.heights[0].metres = height + 2.0;
    const auto high = conclude_from("a.yml", text, said);
    ASSERT_TRUE(high);
    EXPECT_THAT(high->checks,
                Contains(AllOf(testing::ContainsRegex("look at a place (2.[89]|3.[01])"),
                               HasSubstr("m above it"),
                               HasSubstr("--camera-height cam1 METRES"))));
    said.heights[0].metres = height - 2.0;
    const auto low = conclude_from("a.yml", text, said);
    ASSERT_TRUE(low);
    EXPECT_THAT(low->checks,
                Contains(AllOf(testing::ContainsRegex("look at a place (0.[89]|1.[01])"),
                               HasSubstr("m below it"))));
}

TEST_F(Mistakes, AMeasuredCameraHasItsNameInTheFileOrInTheRig) {
    cameras_[0].name = "Küche links";
    cameras_[1].name = "Tür";
    const double distance = (cameras_[0].centre_site() - cameras_[1].centre_site()).norm();
    const std::string text = test::opencv_json(cameras_);
    for (const char* name : {"Küche links", "Ku\u0308che links", "Kueche_links"}) {
        Said said;
        said.distance = Said::Distance{name, "Tür", distance};
        said.heights = {{"Tuer", cameras_[1].centre_site().z()}};
        const auto result = conclude_from("a.json", text, said);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_THAT(result->told, Contains("camera 'Küche links' is called 'Kueche_links' here"));
    }
    Said said;
    said.distance = Said::Distance{"Flur", "Tür", distance};
    const auto unknown = conclude_from("a.json", text, said);
    ASSERT_FALSE(unknown);
    EXPECT_THAT(
        unknown.error().message,
        HasSubstr(
            "no camera 'Flur' in the calibration; it has cam3, cam4, cam5, Küche links, Tür"));
    EXPECT_TRUE(read_foreign({folder_.write("b.json", text)}, "auto", {"K*links", "Tu\u0308r"}));
}

TEST_F(Mistakes, AnUpThatTurnsPeopleOverIsAProblem) {
    Said said;
    said.up = "-Z";
    const std::string text = test::opencv_yaml(cameras_, 1000.0);
    const auto over = conclude_from("a.yml", text, said);
    ASSERT_TRUE(over);
    EXPECT_THAT(over->problems,
                ElementsAre(AllOf(HasSubstr(", -1.00) of the new frame"),
                                  HasSubstr("stand on their heads: say --up +Z, or leave --up out"),
                                  Not(HasSubstr("-0.00")))));
    // below the floor now, which is that of the new frame
    EXPECT_THAT(over->checks,
                Contains(AllOf(HasSubstr("z = 0 of the new frame"), HasSubstr("m below it"))));
    said.up = "+X";
    const auto side = conclude_from("a.yml", text, said);
    ASSERT_TRUE(side);
    EXPECT_THAT(side->problems, ElementsAre(HasSubstr("lie on their side: say --up +Z")));
    said.up = "+Z";
    EXPECT_THAT(conclude_from("a.yml", text, said)->problems, IsEmpty());
}

TEST_F(Mistakes, FormatsThatAreNotReadAreNamedWithTheCure) {
    EXPECT_THAT(error_of("transforms.json",
                         R"({"frames": [{"file_path": "a.jpg", "transform_matrix": [[1]]}]})"),
                AllOf(HasSubstr("transforms.json: a transforms.json of NeRF or Blender"),
                      HasSubstr("sparse/0"),
                      HasSubstr("read are opencv, qualisys")));
    EXPECT_THAT(
        error_of("cameras.xml", "<document version=\"2.0.0\"></document>"),
        AllOf(HasSubstr("not recognised"), HasSubstr("write it as YAML or JSON of OpenCV")));
}

TEST_F(Mistakes, KeysThatAreNotUnderstoodAreListed) {
    EXPECT_THAT(error_of("a.json", R"({"focal": 900, "cams": [{"place": [1, 2, 3]}]})"),
                AllOf(HasSubstr("0 cameras found"),
                      HasSubstr("these keys are not understood: place, focal; understood are "
                                "camera_matrix or K")));
    EXPECT_THAT(error_of("c.json",
                         R"({"a": {"K": [9, 0, 3, 0, 9, 2, 0, 0, 1], "T_world_a": [1, 2, 3]},
                             "b": {"K": [9, 0, 3, 0, 9, 2, 0, 0, 1], "T_world_a": [1, 2, 3]}})"),
                AllOf(HasSubstr("no rotation and translation of a, b"),
                      HasSubstr("these keys are not understood: T_world_a; ")));
}

class OneFilePerCamera : public Mistakes {
protected:
    // OpenCV's files with these names of the matrix, rotation vector and translation.
    Expected<ForeignRig> read(const std::string& k, const std::string& r, const std::string& t) {
        Files files;
        for (const auto& camera : cameras_) {
            const auto& lens = camera.intrinsics;
            const Eigen::AngleAxisd turn(camera.camera_from_site.rotation);
            const Eigen::Vector3d rotation = turn.angle() * turn.axis();
            const Eigen::Vector3d& translation = camera.camera_from_site.translation;
            files.push_back(folder_.write(
                camera.name + ".yml",
                fmt::format("%YAML:1.0\n---\nimage_size: [{}, {}]\n{}: [{}, 0, {}, 0, {}, {}, 0, "
                            "0, 1]\n{}: [{}, {}, {}]\n{}: [{}, {}, {}]\n",
                            lens.width,
                            lens.height,
                            k,
                            lens.fx,
                            lens.cx,
                            lens.fy,
                            lens.cy,
                            r,
                            rotation.x(),
                            rotation.y(),
                            rotation.z(),
                            t,
                            translation.x(),
                            translation.y(),
                            translation.z())));
        }
        return read_foreign(files, "auto");
    }
};

TEST_F(OneFilePerCamera, TakesKindsAndDirectionsForNoCameras) {
    for (const auto& [k, r, t] : {std::array{"K", "R_vec", "T_vec"},
                                  {"K_matrix", "r_vec", "t_vec"},
                                  {"K", "rvec_cw", "t_cw"},
                                  {"K_mat", "R_cw", "T_cw"}}) {
        const auto rig = read(k, r, t);
        ASSERT_TRUE(rig) << rig.error().message;
        ASSERT_EQ(rig->cameras.size(), cameras_.size());
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            EXPECT_EQ(rig->cameras[i].name, cameras_[i].name);
            const auto pose = camera_from_site(*rig->cameras[i].pose, rig->documented);
            EXPECT_LT((pose.translation - cameras_[i].camera_from_site.translation).norm(), 1e-6);
            EXPECT_LT(pose.rotation.angularDistance(cameras_[i].camera_from_site.rotation), 1e-6);
        }
    }
}

TEST_F(OneFilePerCamera, ListsWordsThatAreNotUnderstood) {
    const auto world = read("K", "R_world", "T_world");
    ASSERT_FALSE(world);
    EXPECT_THAT(world.error().message,
                AllOf(HasSubstr("no rotation and translation of cam1, cam2, cam3, cam4, cam5"),
                      HasSubstr("these keys are not understood: R_world, T_world; understood ")));
    const auto both = read("K_new", "R_world", "T_world");
    ASSERT_FALSE(both);
    EXPECT_THAT(both.error().message,
                HasSubstr("these keys are not understood: K_new, R_world, T_world; understood "));
}

TEST_F(Mistakes, APoseThatCannotBeReadNamesItsKeys) {
    EXPECT_THAT(error_of("a.json",
                         R"({"a": {"K": [9, 0, 3, 0, 9, 2, 0, 0, 1], "R_vec": [1, 2, 3, 4],
                                   "T_vec": [1, 2, 3]}})"),
                HasSubstr("; R_vec has 4, T_vec 3"));
    EXPECT_THAT(
        error_of("b.json", R"({"a": {"K": [9, 0, 3, 0, 9, 2, 0, 0, 1], "RT": [1, 2, 3, 4]}})"),
        AllOf(HasSubstr("must be a matrix of 3x4 or 4x4 numbers"), HasSubstr("; RT has 4")));
}

// A file whose up lies between its axes: an axis for --up makes it worse, and the import says so.
TEST_F(Mistakes, AnUpThatMakesPeopleLeanIsToBeChecked) {
    const Eigen::Matrix3d lean =
        Eigen::AngleAxisd(0.2, Eigen::Vector3d(1.0, 1.0, 0.0).normalized()).matrix();
    const std::string text = test::opencv_yaml(test::in_frame(cameras_, lean), 1.0);
    const auto found = conclude_from("a.yml", text);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(std::ranges::count_if(
                  found->checks, [](const std::string& line) { return line.starts_with("up:"); }),
              1);
    EXPECT_THAT(found->checks,
                Contains(AllOf(HasSubstr("If it is wrong, people lean"),
                               HasSubstr("for each; now it is --up "))));
    Said said;
    said.up = "+Z";
    const auto axis = conclude_from("a.yml", text, said);
    ASSERT_TRUE(axis);
    EXPECT_THAT(
        axis->checks,
        Contains(testing::ContainsRegex("up: \\+Z, as you say, is 1[12] degrees off .* "
                                        "say --up 0\\.1[0-9]*,-0\\.1[0-9]*,0\\.98[0-9]*, or")));
    // the direction of the check gives what was found
    for (const std::string& check : found->checks) {
        const std::size_t at = check.find("now it is --up ");
        if (at != std::string::npos) said.up = check.substr(at + 15);
    }
    ASSERT_NE(said.up, "+Z");
    const auto direction = conclude_from("a.yml", text, said);
    ASSERT_TRUE(direction) << said.up;
    EXPECT_THAT(direction->checks, Not(Contains(HasSubstr("up:"))));
    EXPECT_LT(test::difference(direction->rig.cameras, found->rig.cameras), 0.01);
}

TEST(UpVector, IsAnAxisOrThreeNumbers) {
    EXPECT_EQ(up_vector("-Y"), Eigen::Vector3d(0.0, -1.0, 0.0));
    EXPECT_TRUE(up_vector("0, -2,0").isApprox(Eigen::Vector3d(0.0, -1.0, 0.0)));
    for (const char* wrong : {"", "1,2", "1,2,3,4", "0,0,0", "a,b,c", "1,2,nan", "1 2 3", "1,2,3x"})
        EXPECT_TRUE(up_vector(wrong).isZero()) << wrong;
}

}  // namespace
}  // namespace atrium::calibrate
