#include "simulation/changing_light.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <vector>

namespace atrium::simulation {
namespace {

Picture ramp() {
    auto image = std::make_shared<image::YuvImage>();
    image->y = image::Plane(256, 2);
    for (int y = 0; y < 2; ++y) std::iota(image->y.row(y), image->y.row(y) + 256, std::uint8_t(0));
    image->u = image::Plane(128, 1, 148);
    image->v = image::Plane(128, 1, 28);
    return Picture(std::move(image));
}

TEST(ChangingLight, GrowsAndFadesByItsShare) {
    const ChangingLight light(0.25, 40.0);
    EXPECT_NEAR(light.gain(0.0), 1.0, 1e-12);
    EXPECT_NEAR(light.gain(10.0), 1.25, 1e-12);
    EXPECT_NEAR(light.gain(30.0), 0.75, 1e-12);
    EXPECT_NEAR(light.gain(70.0), 0.75, 1e-9);
    const Picture bright = light.lit(ramp(), 10.0), dark = light.lit(ramp(), 30.0);
    const image::YuvView view = view_of(bright), dim = view_of(dark);
    ASSERT_EQ(view.width(), 256);
    EXPECT_EQ(view.y.at(100, 1), 125);
    EXPECT_EQ(view.y.at(250, 0), 255) << "saturated";
    EXPECT_EQ(view.u.at(5, 0), 153);
    EXPECT_EQ(view.v.at(5, 0), 3);
    EXPECT_EQ(dim.y.at(100, 1), 75);
    EXPECT_EQ(dim.u.at(5, 0), 143);
    std::vector<std::uint8_t> samples{0, 100, 250};
    light.light(samples, 10.0);
    EXPECT_EQ(samples, (std::vector<std::uint8_t>{0, 125, 255}));
}

TEST(ChangingLight, ThatStaysCopiesNothing) {
    const ChangingLight light;
    ASSERT_TRUE(light.stays());
    const Picture picture = ramp();
    EXPECT_EQ(light.lit(picture, 10.0).planes[0].data, picture.planes[0].data);
}

}  // namespace
}  // namespace atrium::simulation
