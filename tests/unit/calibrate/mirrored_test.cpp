// Matrices for row vectors, as MATLAB writes them, and left-handed poses, as Unity writes them.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace atrium::calibrate {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

json list_of_rows(const Eigen::Matrix3d& m) {
    json rows;
    for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
    return rows;
}

json list_of_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Matrix3d matrix_of_lens(const geometry::PinholeCamera& k) {
    Eigen::Matrix3d m;
    m << k.fx, k.skew, k.cx, 0, k.fy, k.cy, 0, 0, 1;
    return m;
}

// Cameras all around, above the floor and the place that they look at.
test::Cameras ring_above(atrium::test::Random& random, int num_cameras) {
    test::Cameras cameras = test::random_room(random, num_cameras);
    for (int i = 0; i < num_cameras; ++i) {
        auto& camera = cameras[static_cast<std::size_t>(i)];
        const double angle = 6.283185307179586 * i / num_cameras;
        const Eigen::Vector3d eye(
            3.0 * std::cos(angle), 3.0 * std::sin(angle), atrium::test::between(random, 1.3, 2.6));
        const Eigen::Vector3d target =
            Eigen::Vector3d(0, 0, 0.9) + atrium::test::random_in_cube(random, 0.1);
        const Eigen::Matrix3d r = test::level_rotation(eye, target);
        camera.camera_from_site = {Eigen::Quaterniond(r), -(r * eye)};
        camera.intrinsics.skew = atrium::test::between(random, -1.0, 1.0);
    }
    return cameras;
}

class OtherConventions : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        atrium::test::Random random(static_cast<std::uint64_t>(GetParam()));
        cameras_ = ring_above(random, 4 + GetParam() % 6);
    }
    json lens_of(const geometry::CalibratedCamera& camera, bool is_transposed) const {
        const auto& k = camera.intrinsics;
        Eigen::Matrix3d m = matrix_of_lens(k);
        if (is_transposed) m.transposeInPlace();
        return {
            {"K", list_of_rows(m)}, {"dist", k.distortion}, {"image_size", {k.width, k.height}}};
    }
    Expected<Conclusion> read(const json& tree, const Said& said = {}) const {
        const auto foreign = read_foreign({folder_.write("calib.json", tree.dump(1))}, "auto");
        if (!foreign) return tl::unexpected(foreign.error());
        return conclude(*foreign, said);
    }

    test::Folder folder_;
    test::Cameras cameras_;
};

INSTANTIATE_TEST_SUITE_P(Rigs, OtherConventions, testing::Range(1, 13));

TEST_P(OtherConventions, TransposedMatricesOfMatlabAreRead) {
    for (const bool is_rotation_transposed : {false, true}) {
        json tree;
        for (const auto& camera : cameras_) {
            Eigen::Matrix3d r = camera.camera_from_site.rotation.toRotationMatrix();
            if (is_rotation_transposed) r.transposeInPlace();
            json& one = tree[camera.name] = lens_of(camera, true);
            one["R"] = list_of_rows(r);
            one["t"] = list_of_vector(camera.camera_from_site.translation);
        }
        const auto result = read(tree);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_LT(test::difference(result->rig.cameras, cameras_), 1e-6);
        EXPECT_THAT(result->told,
                    Contains(AllOf(HasSubstr("camera matrix of cam1, "),
                                   HasSubstr("as MATLAB writes it"))));
        EXPECT_EQ(std::ranges::any_of(result->told,
                                      [](const std::string& line) {
                                          return line.find("with a transposed rotation") !=
                                                 std::string::npos;
                                      }),
                  is_rotation_transposed);
        EXPECT_THAT(result->problems, IsEmpty());
    }
}

TEST_P(OtherConventions, ATransposedMatrixOfAWholePoseIsRead) {
    json tree;
    for (const auto& camera : cameras_) {
        json rows = list_of_rows(camera.camera_from_site.rotation.conjugate().toRotationMatrix());
        for (json& row : rows) row.push_back(0.0);
        rows.push_back(list_of_vector(camera.camera_from_site.translation));
        rows.back().push_back(1.0);
        tree[camera.name] = lens_of(camera, false);
        tree[camera.name]["extrinsics"] = rows;
    }
    const auto result = read(tree);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_LT(test::difference(result->rig.cameras, cameras_), 1e-6);
    EXPECT_THAT(result->told, Not(Contains(HasSubstr("MATLAB"))));
}

// Unity: +Y up and left-handed, also the cameras: +X right, +Y up, +Z ahead.
TEST_P(OtherConventions, LeftHandedPosesAreAProblemUntilTold) {
    Eigen::Matrix3d unity_from_site;
    unity_from_site << 1, 0, 0, 0, 0, 1, 0, 1, 0;
    const Eigen::Matrix3d flip = Eigen::Vector3d(1, -1, 1).asDiagonal();
    json tree;
    for (const auto& camera : cameras_) {
        const geometry::RigidTransform pose = camera.camera_from_site.inverse();
        tree[camera.name] = lens_of(camera, false);
        tree[camera.name]["R_wc"] =
            list_of_rows(unity_from_site * pose.rotation.toRotationMatrix() * flip);
        tree[camera.name]["t_wc"] = list_of_vector(unity_from_site * pose.translation);
    }
    const auto wrong = read(tree);
    ASSERT_TRUE(wrong) << wrong.error().message;
    EXPECT_THAT(wrong->problems,
                Contains(AllOf(HasSubstr("left-handed"), HasSubstr("say --left-handed"))));
    Said said;
    said.left_handed = true;
    for (const std::string up : {"", "+Y"}) {
        said.up = up;
        const auto right = read(tree, said);
        ASSERT_TRUE(right) << right.error().message;
        EXPECT_THAT(right->problems, IsEmpty());
        EXPECT_THAT(right->told, Contains(HasSubstr("up: +Y")));
        // the turn about up is free
        const auto& found = right->rig.cameras;
        const geometry::RigidTransform turn =
            cameras_[0].camera_from_site.inverse() * found[0].camera_from_site;
        EXPECT_NEAR((turn.rotation * Eigen::Vector3d::UnitZ()).z(), 1.0, 1e-9);
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            const auto expected = cameras_[i].camera_from_site * turn;
            EXPECT_LT((found[i].camera_from_site.translation - expected.translation).norm(), 1e-6);
            EXPECT_LT(found[i].camera_from_site.rotation.angularDistance(expected.rotation), 1e-6);
            EXPECT_NEAR(found[i].centre_site().z(), cameras_[i].centre_site().z(), 1e-6);
        }
    }
}

TEST_P(OtherConventions, RightHandedRoomsAreNotCalledLeftHanded) {
    for (const char* up : {"+Z", "-Y", "-Z", "+Y"}) {
        const Eigen::Matrix3d file_from_site =
            upright_from(axis_vector(up)).toRotationMatrix().transpose();
        json tree;
        for (const auto& camera : test::in_frame(cameras_, file_from_site)) {
            tree[camera.name] = lens_of(camera, false);
            tree[camera.name]["R"] =
                list_of_rows(camera.camera_from_site.rotation.toRotationMatrix());
            tree[camera.name]["t"] = list_of_vector(camera.camera_from_site.translation);
        }
        const auto result = read(tree);
        ASSERT_TRUE(result) << result.error().message;
        EXPECT_THAT(result->problems, IsEmpty()) << up;
        Said said;
        said.left_handed = true;
        const auto wrong = read(tree, said);
        ASSERT_TRUE(wrong) << wrong.error().message;
        EXPECT_THAT(wrong->problems,
                    Contains(HasSubstr("the poses look right-handed: leave --left-handed out")))
            << up;
    }
}

}  // namespace
}  // namespace atrium::calibrate
