// Camera matrices of 3x4 or 4x4 numbers: poses beside intrinsics, as OpenPose writes them, and
// projection matrices.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/formats/foreign_rig.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Pose = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Pose pose_of(const geometry::CalibratedCamera& camera, int num_rows) {
    Pose pose = Pose::Identity(num_rows, 4);
    pose.topLeftCorner<3, 3>() = camera.camera_from_site.rotation.toRotationMatrix();
    pose.block<3, 1>(0, 3) = camera.camera_from_site.translation;
    return pose;
}

Matrix intrinsics_of(const geometry::CalibratedCamera& camera) {
    const geometry::PinholeCamera& lens = camera.intrinsics;
    Eigen::Matrix3d k;
    k << lens.fx, lens.skew, lens.cx, 0.0, lens.fy, lens.cy, 0.0, 0.0, 1.0;
    return k;
}

std::string xml_of(const std::string& key, const Matrix& m) {
    return fmt::format(
        "<{0} type_id=\"opencv-matrix\"><rows>{1}</rows><cols>{2}</cols><dt>d</dt><data>{3}</data>"
        "</{0}>\n",
        key,
        m.rows(),
        m.cols(),
        fmt::join(m.data(), m.data() + m.size(), " "));
}

class WideMatrix : public testing::TestWithParam<int> {
protected:
    // One file per camera, without its picture size.
    template <typename Values>
    Expected<ForeignRig> read(const Values& values_of) const {
        Files files;
        for (const auto& camera : cameras_)
            files.push_back(folder_.write(camera.name + ".xml",
                                          "<?xml version=\"1.0\"?>\n<opencv_storage>\n" +
                                              values_of(camera) + "</opencv_storage>\n"));
        return read_foreign(files, "auto");
    }
    template <typename Values>
    std::string error_of(const Values& values_of) const {
        const auto rig = read(values_of);
        return rig ? "no error" : rig.error().message;
    }

    atrium::test::Random random_{static_cast<std::uint64_t>(GetParam())};
    test::Folder folder_;
    test::Cameras cameras_ = test::random_room(random_, 3 + GetParam() % 6);
};

INSTANTIATE_TEST_SUITE_P(Rigs, WideMatrix, testing::Range(1, 7));

TEST_P(WideMatrix, IsThePoseBesideIntrinsics) {
    for (const int num_rows : {3, 4}) {
        const auto rig = read([&](const geometry::CalibratedCamera& camera) {
            const auto& d = camera.intrinsics.distortion;
            Matrix eight = Matrix::Zero(8, 1);
            for (int i = 0; i < 5; ++i) eight(i, 0) = d[static_cast<std::size_t>(i)];
            return xml_of("CameraMatrix", pose_of(camera, num_rows)) +
                   xml_of("Intrinsics", intrinsics_of(camera)) + xml_of("Distortion", eight);
        });
        ASSERT_TRUE(rig) << rig.error().message;
        EXPECT_TRUE(rig->has_matrix_poses);
        ASSERT_EQ(rig->cameras.size(), cameras_.size());
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            const ForeignCamera& read = rig->cameras[i];
            EXPECT_EQ(read.name, cameras_[i].name);
            ASSERT_TRUE(read.pose);
            const auto pose = camera_from_site(*read.pose, rig->documented);
            EXPECT_LT((pose.translation - cameras_[i].camera_from_site.translation).norm(), 1e-9);
            EXPECT_LT(pose.rotation.angularDistance(cameras_[i].camera_from_site.rotation), 1e-7);
            const geometry::PinholeCamera& lens = cameras_[i].intrinsics;
            EXPECT_NEAR(read.lens.fx, lens.fx, 1e-9);
            EXPECT_NEAR(read.lens.cy, lens.cy, 1e-9);
            EXPECT_EQ(read.lens.distortion, lens.distortion);
        }
    }
}

TEST_P(WideMatrix, IsNoPoseBesideAnotherOne) {
    const auto rig = read([&](const geometry::CalibratedCamera& camera) {
        return xml_of("K", intrinsics_of(camera)) +
               xml_of("matrix", intrinsics_of(camera) * pose_of(camera, 3)) +
               xml_of("RT", pose_of(camera, 3));
    });
    ASSERT_TRUE(rig) << rig.error().message;
    for (std::size_t i = 0; i < cameras_.size(); ++i)
        EXPECT_LT((camera_from_site(*rig->cameras[i].pose, rig->documented).translation -
                   cameras_[i].camera_from_site.translation)
                      .norm(),
                  1e-9);
}

TEST_P(WideMatrix, ThatLooksLikeAPoseAsksForIntrinsics) {
    for (const int num_rows : {3, 4}) {
        const std::string error = error_of([&](const geometry::CalibratedCamera& camera) {
            return xml_of("CameraMatrix", pose_of(camera, num_rows));
        });
        EXPECT_THAT(error,
                    AllOf(HasSubstr(cameras_.front().name + ".xml: camera '"),
                          HasSubstr(fmt::format("CameraMatrix has {}x4 numbers and looks like a "
                                                "pose [R|t], as OpenPose writes it: give the "
                                                "intrinsics beside it",
                                                num_rows)),
                          Not(HasSubstr("comma"))));
    }
}

// Also with another scale or sign: P is only defined up to a factor.
TEST_P(WideMatrix, ThatIsAProjectionNamesItsLens) {
    const geometry::PinholeCamera& lens = cameras_.front().intrinsics;
    for (const double factor : {1.0, -0.003}) {
        for (const bool has_lens : {false, true}) {
            const std::string error = error_of([&](const geometry::CalibratedCamera& camera) {
                return xml_of("camera_matrix",
                              factor * intrinsics_of(camera) * pose_of(camera, 3)) +
                       (has_lens ? xml_of("intrinsics", intrinsics_of(camera)) : "");
            });
            EXPECT_THAT(error,
                        AllOf(HasSubstr("camera_matrix has 3x4 numbers and looks like a projection "
                                        "matrix P = K [R|t] with fx = "),
                              HasSubstr(fmt::format("fx = {:.6g}, fy = {:.6g}, cx = {:.6g}, cy = "
                                                    "{:.6g}: write K",
                                                    lens.fx,
                                                    lens.fy,
                                                    lens.cx,
                                                    lens.cy)),
                              HasSubstr("the inverse of K times P as RT"),
                              Not(HasSubstr("comma"))));
        }
    }
}

// Three decimal commas make 12 numbers of 9: neither a pose nor a projection.
TEST_P(WideMatrix, OfDecimalCommasIsNamedSo) {
    const std::string error = error_of([&](const geometry::CalibratedCamera& camera) {
        Matrix twelve(3, 4);
        twelve << 571, 37, 0, 399, 19, 0, 571, 296, 55, 0, 0, 1;
        return xml_of("K", twelve) + xml_of("RT", pose_of(camera, 3));
    });
    EXPECT_THAT(error,
                AllOf(HasSubstr("its camera matrix must be 9 numbers"),
                      HasSubstr("a decimal comma makes two numbers of one")));
}

}  // namespace
}  // namespace atrium::calibrate
