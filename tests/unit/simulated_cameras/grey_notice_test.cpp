#include "tools/simulated_cameras/grey_notice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::simulated_cameras {
namespace {

using testing::HasSubstr;

const PictureRequest kVga{640, 480, 0, 0, "BayerRG8"};
const PictureRequest kMegapixel{1000, 1000, 0, 0, "BayerRG8"};

TEST(GreyNotice, NamesTheRigOfALargerPictureOnce) {
    GreyNotice notice;
    const auto line = notice.look("cam3", kMegapixel, kVga);
    ASSERT_TRUE(line);
    EXPECT_THAT(*line, HasSubstr("camera cam3 sends grey: asked for 1000x1000+0+0 BayerRG8"));
    EXPECT_THAT(*line, HasSubstr("rig (capture.rig of a site) is not that of these cameras"));
    for (int i = 0; i < 100; ++i) EXPECT_FALSE(notice.look("cam3", kMegapixel, kVga));
}

TEST(GreyNotice, NamesThePixelFormatOfAnotherRequest) {
    GreyNotice notice;
    PictureRequest asked = kVga;
    asked.format = "Mono8";
    ASSERT_TRUE(notice.look("cam0", kMegapixel, kVga));
    const auto line = notice.look("cam0", asked, kVga);
    ASSERT_TRUE(line) << "another request is another mistake";
    EXPECT_THAT(*line, HasSubstr("serve with --pixel_format Mono8, or ask for BayerRG8"));
}

}  // namespace
}  // namespace atrium::simulated_cameras
