#include "site_node/refine/colour_clash.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

namespace atrium::refine {
namespace {

TEST(ColourClash, IsTheLargestDifference) {
    const std::array<Eigen::Vector3f, 3> colours = {Eigen::Vector3f(100, 120, 130),
                                                    Eigen::Vector3f(110, 125, 128),
                                                    Eigen::Vector3f(60, 90, 160)};
    EXPECT_EQ(colour_clash({}), 0.0F);
    EXPECT_EQ(colour_clash(std::span(colours).first(1)), 0.0F);
    EXPECT_NEAR(colour_clash(std::span(colours).first(2)), 0.4F * 10 + 5 + 2, 1e-4F);
    EXPECT_NEAR(colour_clash(colours), 0.4F * 50 + 35 + 32, 1e-4F);
}

// 40 x 30 px; the person is the left half, and one colour.
struct HalfPicture {
    image::YuvImage picture{image::Plane(40, 30), image::Plane(20, 15), image::Plane(20, 15)};
    image::Mask mask{40, 30};
    LumaScratch scratch;
    LumaPicture luma;

    HalfPicture() {
        for (int y = 0; y < 30; ++y) {
            for (int x = 0; x < 40; ++x) {
                picture.y.row(y)[x] = x < 20 ? 90 : 200;
                mask.row(y)[x] = x < 20 ? 255 : 0;
            }
        }
        for (int y = 0; y < 15; ++y) {
            for (int x = 0; x < 20; ++x) {
                picture.u.row(y)[x] = x < 10 ? 100 : 220;
                picture.v.row(y)[x] = x < 10 ? 150 : 20;
            }
        }
        fill(view(), scratch, luma);
    }
    PictureView view() const { return {nullptr, picture, &mask, {0, 0, 40, 30}}; }
};

TEST(ColourAt, TakesOnlyThePerson) {
    const HalfPicture half;
    for (const float x : {3.0F, 8.4F, 9.6F}) {  // the last one at the border of the mask
        const auto colour = colour_at(half.view(), half.luma, {x, 7.0F});
        ASSERT_TRUE(colour) << x;
        EXPECT_EQ(*colour, Eigen::Vector3f(90, 100, 150)) << x;
    }
}

TEST(ColourAt, IsUnknownOutside) {
    const HalfPicture half;
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Eigen::Vector2f> outside = {
        {12.0F, 7.0F}, {0.5F, 7.0F}, {-3.0F, 7.0F}, {5.0F, 14.0F}, {5.0F, 1e9F}, {kNan, 7.0F}};
    for (const Eigen::Vector2f& place : outside)
        EXPECT_FALSE(colour_at(half.view(), half.luma, place)) << place.transpose();
}

}  // namespace
}  // namespace atrium::refine
