#include "site_node/motion/motion_picture.hpp"

#include "site_node/motion/depth_map.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/rig_maker.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::motion {
namespace {

codec::TextureCrop random_crop(const image::PixelRect& rect, int divisor, test::Random& random) {
    codec::TextureCrop crop;
    crop.crop_px = rect;
    crop.y = image::Plane(rect.width / divisor, rect.height / divisor);
    crop.mask = crop.y;
    for (std::uint8_t& value : crop.y.data)
        value = static_cast<std::uint8_t>(test::between(random, 0, 255));
    for (std::uint8_t& value : crop.mask.data)
        value = test::between(random, 0, 2) > 0 ? std::uint8_t{255} : std::uint8_t{0};
    return crop;
}

TEST(MotionPicture, IsTheMeanOfTheSubjectsPixels) {
    test::Random random(2);
    for (const int divisor : {1, 2}) {
        for (const image::PixelRect& rect :
             {image::PixelRect{0, 0, 40, 32}, {6, 10, 42, 34}, {2, 4, 6, 4}, {102, 50, 2, 2}}) {
            const codec::TextureCrop crop = random_crop(rect, divisor, random);
            MotionPicture picture;
            reduce(crop, picture);
            ASSERT_EQ(picture.luma.width, picture.rect.width);
            EXPECT_EQ(picture.rect.x, rect.x / 4);
            EXPECT_EQ(picture.rect.y + picture.rect.height, (rect.y + rect.height + 3) / 4);
            for (int y = 0; y < picture.rect.height; ++y) {
                for (int x = 0; x < picture.rect.width; ++x) {
                    // the camera's pixels one by one
                    double inside = 0.0, all = 0.0;
                    int num_inside = 0, num = 0;
                    for (int j = 4 * (picture.rect.y + y); j < 4 * (picture.rect.y + y) + 4; ++j) {
                        for (int i = 4 * (picture.rect.x + x); i < 4 * (picture.rect.x + x) + 4;
                             ++i) {
                            const int u = i - rect.x;
                            const int v = j - rect.y;
                            if (u < 0 || v < 0 || u >= rect.width || v >= rect.height) continue;
                            const int value = crop.y.at(u / divisor, v / divisor);
                            const bool shows = crop.mask.at(u / divisor, v / divisor) != 0;
                            all += value;
                            ++num;
                            if (shows) inside += value;
                            if (shows) ++num_inside;
                        }
                    }
                    const double mean = num_inside > 0 ? inside / num_inside : all / num;
                    EXPECT_NEAR(picture.luma.at(x, y), mean, 0.51);
                    EXPECT_EQ(picture.mask.at(x, y), num_inside >= 8 ? 255 : 0);
                }
            }
        }
    }
}

TEST(MotionPicture, OfNothingIsEmpty) {
    MotionPicture picture;
    picture.rect = {1, 2, 3, 4};
    reduce({}, picture);
    EXPECT_TRUE(picture.empty());
}

TEST(MotionPicture, RepeatsItsBorderAroundItself) {
    test::Random random(3);
    MotionPicture picture;
    reduce(random_crop({40, 80, 80, 40}, 2, random), picture);
    image::Plane part;
    copy_part(picture, {5, 18, 40, 20}, part);
    EXPECT_EQ(part.at(0, 0), picture.luma.at(0, 0));
    EXPECT_EQ(part.at(5, 2), picture.luma.at(0, 0));
    EXPECT_EQ(part.at(10, 6), picture.luma.at(5, 4));
    EXPECT_EQ(part.at(39, 19), picture.luma.at(19, 9));
}

TEST(DepthMap, HasTheDepthOfASphere) {
    constexpr double kRadiusM = 0.4;
    const geometry::TriangleMesh sphere =
        physics_test::make_sphere_mesh(kRadiusM, {0.0, 0.0, 0.9}, 60);
    const auto cameras = test::make_ring_rig({.num_cameras = 3, .size_px = 800, .focal_px = 900.0});
    for (const geometry::CalibratedCamera& camera : cameras) {
        DepthMap depths;
        depths.draw(sphere, camera, {0, 0, 200, 200});
        const Eigen::Vector3d centre = camera.camera_from_site * Eigen::Vector3d(0.0, 0.0, 0.9);
        int num = 0;
        for (int y = 0; y < 200; ++y) {
            for (int x = 0; x < 200; ++x) {
                const Eigen::Vector3d ray =
                    camera.intrinsics.ray_camera({4.0 * x + 1.5, 4.0 * y + 1.5});
                // the nearer crossing of the ray with the sphere
                const double along = ray.dot(centre) / ray.squaredNorm();
                const double off_sq = (along * ray - centre).squaredNorm();
                const double inverse = static_cast<double>(depths.inverse_depth(x, y));
                if (off_sq > 1.03 * kRadiusM * kRadiusM) {
                    EXPECT_EQ(inverse, 0.0) << x << ' ' << y;
                } else if (off_sq < 0.8 * kRadiusM * kRadiusM) {
                    const double depth =
                        along - std::sqrt((kRadiusM * kRadiusM - off_sq) / ray.squaredNorm());
                    ASSERT_GT(inverse, 0.0) << x << ' ' << y;
                    EXPECT_NEAR(1.0 / inverse, depth, 0.003);
                    ++num;
                }
            }
        }
        EXPECT_GT(num, 1000);
    }
}

}  // namespace
}  // namespace atrium::motion
