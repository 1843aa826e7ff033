// Calibrations of programs whose formats are not read, and how their numbers are brought in.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/picture_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class UnreadFormats : public testing::Test {
protected:
    std::string error_of(const Files& files) const {
        const auto rig = read_foreign(files, "auto");
        return rig ? "no error" : rig.error().message;
    }
    test::Folder folder_;
    atrium::test::Random random_{3};
    test::Cameras cameras_ = test::random_room(random_, 4);
};

TEST_F(UnreadFormats, AreNamedWithTheCure) {
    struct Example {
        const char* file;
        const char* text;
        const char* name;
    };
    for (const Example& example :
         {Example{"cameras.sfm",
                  R"({"version": ["1"], "views": [{"viewId": "1", "poseId": "1"}], "intrinsics": [],
                      "poses": [{"poseId": "1", "pose": {"transform": {"rotation": ["-0.9"]}}}]})",
                  "an .sfm file of Meshroom"},
          {"sfm_data.json",
           R"({"sfm_data_version": "0.3", "views": [], "intrinsics": []})",
           "OpenMVG"},
          {"tf.yaml",
           "transforms:\n- header: {frame_id: map}\n  child_frame_id: Cam_A\n  transform:\n"
           "    translation: {x: 1.0, y: 2.0, z: 3.0}\n    rotation: {x: 0, y: 0, z: 0, w: 1}\n",
           "poses of ROS (tf)"},
          {"doc.xml",
           "<?xml version=\"1.0\"?>\n<document version=\"2.0.0\"><chunk><sensors><sensor id=\"0\"/>"
           "</sensors><cameras><camera id=\"0\"/></cameras></chunk></document>",
           "an XML file of Metashape"},
          {"rc.csv",
           "#name,x,y,alt,heading,pitch,roll,f,px,py\na.jpg,1,2,3,4,5,6,7,8,9\n",
           "a table of RealityCapture"}}) {
        EXPECT_THAT(error_of({folder_.write(example.file, example.text)}),
                    AllOf(HasSubstr(std::string(example.file) + ": "),
                          HasSubstr(example.name),
                          HasSubstr("a format that is not read"),
                          HasSubstr("write it as YAML or JSON of OpenCV"),
                          HasSubstr("docs/calibrate.md")));
    }
}

TEST_F(UnreadFormats, OfNoKnownProgramHaveTheCure) {
    EXPECT_THAT(error_of({folder_.write("a.json", R"({"lenses": [{"f": 1.0}]})")}),
                AllOf(HasSubstr("0 cameras found as OpenCV"),
                      HasSubstr("of any other program: write it as YAML or JSON of OpenCV")));
}

TEST_F(UnreadFormats, AFileWithoutAnyCameraIsNamed) {
    const auto lenses = folder_.write("intri.yml", test::easymocap_intri(cameras_));
    const auto poses = folder_.write("stations.yaml", "stations:\n   one: [ 1., 2., 3. ]\n");
    EXPECT_THAT(error_of({lenses, poses}),
                AllOf(HasSubstr("no rotation and translation of cam1"),
                      HasSubstr("stations.yaml: nothing in it is understood"),
                      Not(HasSubstr("intri.yml: nothing"))));
}

// As Meshroom, Metashape and RealityCapture write them.
TEST_F(UnreadFormats, PrincipalPointsMayBeOffsetsFromTheMiddle) {
    const auto whole =
        read_foreign({folder_.write("a.yml", test::opencv_yaml(cameras_, 1.0))}, "auto");
    ASSERT_TRUE(whole) << whole.error().message;
    ForeignRig same = *whole;
    read_point_offsets(same);
    EXPECT_THAT(same.checks, IsEmpty());
    EXPECT_EQ(same.cameras[0].lens.cx, whole->cameras[0].lens.cx);

    test::Cameras offset = cameras_;
    for (auto& camera : offset) {
        camera.intrinsics.cx -= 0.5 * (camera.intrinsics.width - 1);
        camera.intrinsics.cy -= 0.5 * (camera.intrinsics.height - 1);
    }
    const auto read =
        read_foreign({folder_.write("b.yml", test::opencv_yaml(offset, 1.0))}, "auto");
    ASSERT_TRUE(read) << read.error().message;
    const auto expected = conclude(*whole, {});
    const auto result = conclude(*read, {});
    ASSERT_TRUE(expected && result);
    EXPECT_THAT(
        result->checks,
        Contains(HasSubstr("principal points lie near 0, so they are read as offsets from the "
                           "middle of the picture")));
    EXPECT_LT(test::difference(result->rig.cameras, expected->rig.cameras), 1e-9);
}

}  // namespace
}  // namespace atrium::calibrate
