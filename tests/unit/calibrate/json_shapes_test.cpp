// JSON of one's own scripts: lists, nested maps, other names, one matrix per pose.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/judge/rig_judge.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace atrium::calibrate {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

json rows_of(const Eigen::Matrix3d& m) {
    json rows;
    for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
    return rows;
}
json list_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

json matrix_of(const geometry::RigidTransform& pose) {
    json rows = rows_of(pose.rotation.toRotationMatrix());
    for (int i = 0; i < 3; ++i) rows[static_cast<std::size_t>(i)].push_back(pose.translation[i]);
    rows.push_back({0, 0, 0, 1});
    return rows;
}

class JsonShapes : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        atrium::test::Random random(static_cast<std::uint64_t>(GetParam()));
        cameras_ = test::random_room(random, 3 + GetParam() % 4);
    }
    static json rotation_of(const geometry::CalibratedCamera& camera) {
        return rows_of(camera.camera_from_site.rotation.toRotationMatrix());
    }
    static json translation_of(const geometry::CalibratedCamera& camera) {
        return list_of(camera.camera_from_site.translation);
    }
    static json matrix_of_lens(const geometry::CalibratedCamera& camera) {
        const auto& k = camera.intrinsics;
        return {{k.fx, k.skew, k.cx}, {0, k.fy, k.cy}, {0, 0, 1}};
    }
    Expected<Conclusion> read(const json& tree) const {
        const auto foreign = read_foreign({folder_.write("calib.json", tree.dump(1))}, "auto");
        if (!foreign) return tl::unexpected(foreign.error());
        return conclude(*foreign, {});
    }
    // Returns the checks.
    std::vector<std::string> expect_truth(const json& tree) const {
        const auto result = read(tree);
        if (!result) {
            ADD_FAILURE() << result.error().message;
            return {};
        }
        EXPECT_LT(test::difference(result->rig.cameras, cameras_), 1e-6);
        for (std::size_t i = 0; i < cameras_.size(); ++i)
            EXPECT_EQ(result->rig.cameras[i].name, cameras_[i].name);
        return result->checks;
    }

    test::Folder folder_;
    test::Cameras cameras_;
};

INSTANTIATE_TEST_SUITE_P(Rigs, JsonShapes, testing::Range(1, 7));

TEST_P(JsonShapes, NestedIntrinsicsAndExtrinsics) {
    json tree;
    for (const auto& camera : cameras_) {
        const auto& k = camera.intrinsics;
        tree[camera.name] = {
            {"intrinsics",
             {{"width", k.width},
              {"height", k.height},
              {"K", matrix_of_lens(camera)},
              {"dist", k.distortion}}},
            {"extrinsics",
             {{"rotation", rotation_of(camera)}, {"translation", translation_of(camera)}}}};
    }
    EXPECT_THAT(expect_truth(tree), Not(Contains(HasSubstr("no distortion"))));
}

TEST_P(JsonShapes, AListWithOneMatrixPerPose) {
    json to_camera = json::array();
    json to_site = json::array();
    for (const auto& camera : cameras_) {
        const auto& k = camera.intrinsics;
        json common{{"cam_id", camera.name},
                    {"K", matrix_of_lens(camera)},
                    {"coeffs", k.distortion},
                    {"image_size", {k.width, k.height}}};
        to_camera.push_back(common);
        to_camera.back()["T_cw"] = matrix_of(camera.camera_from_site);
        to_site.push_back(common);
        to_site.back()["T_wc"] = matrix_of(camera.camera_from_site.inverse());
    }
    expect_truth(to_camera);
    expect_truth(to_site);
}

TEST_P(JsonShapes, KeysThatSayWhatAPoseMeans) {
    struct Pair {
        const char* rotation;
        const char* translation;
        Reading::Pose pose;
    };
    for (const Pair& pair : {Pair{"R_cw", "t_cw", Reading::Pose::kCameraFromSite},
                             {"R", "t_cw", Reading::Pose::kCameraFromSite},
                             {"R_mat", "T_vec", Reading::Pose::kCameraFromSite},
                             {"R_cw", "t_wc", Reading::Pose::kRotationAndPosition},
                             {"R_wc", "T_wc", Reading::Pose::kSiteFromCamera}}) {
        json tree;
        for (const auto& camera : cameras_) {
            const auto& k = camera.intrinsics;
            const ForeignPose pose = foreign_pose(camera.camera_from_site, {pair.pose, false});
            tree[camera.name] = {{"K_matrix", matrix_of_lens(camera)},
                                 {"dist", k.distortion},
                                 {"image_size", {k.width, k.height}},
                                 {pair.rotation, rows_of(pose.rotation)},
                                 {pair.translation, list_of(pose.vector)}};
        }
        expect_truth(tree);
        const auto result = read(tree);
        ASSERT_TRUE(result);
        EXPECT_THAT(result->told, Contains(HasSubstr(", as documented: "))) << pair.rotation;
    }
}

TEST_P(JsonShapes, ARotationAndATranslationOfOppositeDirections) {
    json tree;
    for (const auto& camera : cameras_) {
        const auto& k = camera.intrinsics;
        tree[camera.name] = {
            {"K", matrix_of_lens(camera)},
            {"dist", k.distortion},
            {"image_size", {k.width, k.height}},
            {"R_wc", rows_of(camera.camera_from_site.inverse().rotation.toRotationMatrix())},
            {"t_cw", translation_of(camera)}};
    }
    expect_truth(tree);
}

// In some rooms a rotation of one direction beside the position would fit as well as the truth, or
// better, but no matrix holds these two.
TEST(OneMatrixPerPose, IsNoRotationBesideAPosition) {
    atrium::test::Random random(5);
    const Eigen::Quaterniond y_up(Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitX()));
    std::size_t num_misled = 0;
    for (int i = 0; i < 300; ++i) {
        test::Cameras cameras = test::random_room(random, 4);
        std::vector<ForeignPose> poses;
        for (auto& camera : cameras) {
            camera.camera_from_site.rotation = camera.camera_from_site.rotation * y_up;
            poses.push_back(
                foreign_pose(camera.camera_from_site, {Reading::Pose::kSiteFromCamera, false}));
        }
        const auto takes_position = [&](bool are_matrices) {
            return choose_reading(cameras, poses, {}, are_matrices).reading.pose ==
                   Reading::Pose::kRotationAndPosition;
        };
        num_misled += takes_position(false) ? 1 : 0;
        EXPECT_FALSE(takes_position(true)) << i;
    }
    EXPECT_GT(num_misled, 0U) << "the test cannot fail";
}

TEST_P(JsonShapes, NamesOfRealSense) {
    json tree;
    for (auto& camera : cameras_) {
        auto& k = camera.intrinsics;
        k.skew = 0.0;
        tree["cameras"].push_back({{"serial", camera.name},
                                   {"intrinsics",
                                    {{"width", k.width},
                                     {"height", k.height},
                                     {"fx", k.fx},
                                     {"fy", k.fy},
                                     {"ppx", k.cx},
                                     {"ppy", k.cy},
                                     {"model", "Brown Conrady"},
                                     {"coeffs", k.distortion}}},
                                   {"rotation", rotation_of(camera)},
                                   {"translation", translation_of(camera)}});
    }
    expect_truth(tree);
}

// Multical: the first camera is the frame, the others are named by both.
TEST_P(JsonShapes, PosesNamedByTwoCameras) {
    json tree;
    const geometry::RigidTransform site_from_first = cameras_[0].camera_from_site.inverse();
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        auto& camera = cameras_[i];
        tree["cameras"][camera.name] = {
            {"model", "standard"},
            {"image_size", {camera.intrinsics.width, camera.intrinsics.height}},
            {"K", matrix_of_lens(camera)},
            {"dist", {camera.intrinsics.distortion}}};
        const geometry::RigidTransform pose = camera.camera_from_site * site_from_first;
        const std::string name =
            i == 0 ? camera.name : fmt::format("{}_to_{}", camera.name, cameras_[0].name);
        tree["camera_poses"][name] = {{"R", rows_of(pose.rotation.toRotationMatrix())},
                                      {"T", list_of(pose.translation)}};
    }
    const auto foreign = read_foreign({folder_.write("calib.json", tree.dump())}, "auto");
    ASSERT_TRUE(foreign) << foreign.error().message;
    ASSERT_EQ(foreign->cameras.size(), cameras_.size());
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        EXPECT_EQ(foreign->cameras[i].name, cameras_[i].name);
        ASSERT_TRUE(foreign->cameras[i].pose);
        const auto pose = camera_from_site(*foreign->cameras[i].pose, {});
        const auto expected = cameras_[i].camera_from_site * site_from_first;
        EXPECT_LT((pose.translation - expected.translation).norm(), 1e-9);
        EXPECT_LT(pose.rotation.angularDistance(expected.rotation), 1e-7);
    }
    // Multical leaves out the pose of a camera that it could not calibrate
    tree["camera_poses"].erase(
        fmt::format("{}_to_{}", cameras_.back().name, cameras_.front().name));
    const auto incomplete = read_foreign({folder_.write("calib.json", tree.dump())}, "auto");
    ASSERT_FALSE(incomplete);
    EXPECT_THAT(incomplete.error().message,
                HasSubstr(fmt::format("leave them out: --cameras '!{}'", cameras_.back().name)));
}

TEST_P(JsonShapes, HeightBeforeWidthAndNoDistortionAreTold) {
    json tree;
    for (auto& camera : cameras_) {
        auto& k = camera.intrinsics;
        k.distortion = {};
        k.width = 1024;
        k.height = 576;
        k.cx = 505.0;
        k.cy = 290.0;
        tree[camera.name] = {{"K", matrix_of_lens(camera)},
                             {"image_size", {k.height, k.width}},
                             {"R", rotation_of(camera)},
                             {"t", translation_of(camera)}};
    }
    const std::vector<std::string> checks = expect_truth(tree);
    EXPECT_THAT(checks, Contains(HasSubstr("is taken as height, width")));
    EXPECT_THAT(checks, Contains(HasSubstr("gives no distortion")));
}

}  // namespace
}  // namespace atrium::calibrate
