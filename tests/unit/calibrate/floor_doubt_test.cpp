#include "tools/calibrate/recording/floor_doubt.hpp"

#include "tests/support/shapes/rig_maker.hpp"
#include "tests/unit/calibrate/foreign_texts.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <filesystem>

namespace atrium::calibrate {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

// Whether a ray meets a capsule of 1.7 m that stands at z = `feet_m`.
bool meets_person(const Eigen::Vector3d& from, const Eigen::Vector3d& along, double feet_m) {
    for (double z = 0.2; z <= 1.5; z += 0.05) {
        const Eigen::Vector3d to = Eigen::Vector3d(0.0, 0.0, feet_m + z) - from;
        if (to.cross(along).norm() < 0.2 * along.norm()) return true;
    }
    return false;
}

class FloorDoubt : public testing::Test {
protected:
    // Masks of somebody who stands still.
    std::string doubt(double feet_m,
                      std::size_t num_masks,
                      bool inverted = false,
                      const rig_check::Measured& measured = {}) {
        Material material;
        material.mask_reading.inverted = inverted;
        for (const auto& camera : rig_) {
            const auto& k = camera.intrinsics;
            cv::Mat mask(k.height, k.width, CV_8UC1);
            const auto to_site = camera.camera_from_site.rotation.conjugate();
            for (int y = 0; y < k.height; ++y) {
                for (int x = 0; x < k.width; ++x) {
                    const bool meets =
                        meets_person(camera.centre_site(), to_site * k.ray_camera({x, y}), feet_m);
                    mask.at<std::uint8_t>(y, x) = meets != inverted ? 255 : 0;
                }
            }
            const auto file = folder_.path() / (camera.name + ".png");
            EXPECT_TRUE(cv::imwrite(file.string(), mask));
            Shots& shots = material.masks[camera.name];
            for (std::size_t i = 0; i < num_masks; ++i) shots.pictures[100 + i] = file;
        }
        return doubt_of_floor(material, rig_, measured, measured.has_heights ? "cam1" : "");
    }

    test::Folder folder_;
    std::vector<geometry::CalibratedCamera> rig_ = atrium::test::make_ring_rig(
        {.num_cameras = 4, .heights_m = {1.3, 2.2}, .size_px = 120, .focal_px = 70.0});
};

TEST_F(FloorDoubt, NamesPeopleInTheFloorAndAboveIt) {
    const std::string below = doubt(-0.74, 12);
    EXPECT_THAT(below, StartsWith("floor: people stand 0.7"));
    EXPECT_THAT(below, HasSubstr("--camera-height cam0 METRES"));
    EXPECT_THAT(doubt(-0.74, 300, true), StartsWith("floor: people stand 0.7"));
    EXPECT_THAT(doubt(0.5, 12), StartsWith("floor: the feet of people stay 0.5"));
}

TEST_F(FloorDoubt, NamesTheNumbersThatWereMeasured) {
    const std::string scaled = doubt(-0.74, 12, false, {"cam1 to cam3 6.137 m", false});
    EXPECT_THAT(scaled,
                HasSubstr("a number of --distance is wrong (you say: cam1 to cam3 6.137 m"));
    EXPECT_THAT(scaled, HasSubstr("--camera-height cam0 METRES"));
    EXPECT_THAT(scaled, Not(HasSubstr("board")));
    const std::string measured =
        doubt(0.5, 12, false, {"cam1 to cam3 6.137 m; cam1 2.083 m high", true});
    EXPECT_THAT(measured,
                HasSubstr("a number of --distance or --camera-height is wrong (you say: cam1 to "
                          "cam3 6.137 m; cam1 2.083 m high)"));
    EXPECT_THAT(measured, HasSubstr("by this cam1 is about 1.68 m"));
    EXPECT_THAT(measured, Not(HasSubstr("METRES")));
    EXPECT_THAT(measured, Not(HasSubstr("board")));
}

TEST_F(FloorDoubt, NamesHowFarARigIsOffTheFloor) {
    for (const double feet_m : {-1.2, -0.7, -0.3, 0.3, 0.5, 0.7, 0.9}) {
        EXPECT_THAT(doubt(feet_m, 12), StartsWith("floor: ")) << feet_m;
    }
    EXPECT_THAT(doubt(0.0, 12), IsEmpty());
}

TEST_F(FloorDoubt, IsSilentOnTheFloorAndAboutFewOrNoMasks) {
    EXPECT_THAT(doubt(0.0, 12), IsEmpty());
    EXPECT_THAT(doubt(-0.74, 9), IsEmpty());
    EXPECT_THAT(doubt_of_floor({}, rig_), IsEmpty());
}

TEST_F(FloorDoubt, IsSilentAboutMasksThatCannotBeRead) {
    const std::filesystem::path file = folder_.write("none.png", "no picture");
    Material material;
    for (const auto& camera : rig_) {
        for (std::size_t i = 0; i < 12; ++i) material.masks[camera.name].pictures[i] = file;
    }
    EXPECT_THAT(doubt_of_floor(material, rig_), IsEmpty());
}

}  // namespace
}  // namespace atrium::calibrate
