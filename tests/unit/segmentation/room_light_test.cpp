#include "site_node/segmentation/room_light.hpp"

#include "site_node/segmentation/room_watch.hpp"
#include "tests/unit/segmentation/test_room.hpp"

#include <gmock/gmock.h>

namespace atrium::segmentation {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::Optional;

class RoomLight : public testing::Test {
protected:
    static image::YuvImage in_light(double light) {
        image::YuvImage frame = room(240, 160);
        scale_light(frame, kWhole, light);
        return frame;
    }
    std::optional<std::string> doubt(const image::YuvImage& room, const image::YuvImage& picture) {
        return doubt_of_light(learn(room, 3, random_).luma, picture.y, scratch_);
    }
    std::mt19937 random_{5};
    LightScratch scratch_;
};

TEST_F(RoomLight, AcceptsWhatSegmentationCompensates) {
    for (const double light : {0.75, 0.9, 1.0, 1.1, 1.25}) {
        image::YuvImage picture = in_light(light);
        EXPECT_EQ(doubt(in_light(1.0), picture), std::nullopt) << light;
        // somebody dark who covers nearly half of it
        for (int y = 0; y < 160; ++y) std::fill_n(picture.y.row(y), 110, std::uint8_t{20});
        EXPECT_EQ(doubt(in_light(1.0), picture), std::nullopt) << light;
    }
}

// In a dark room the ratios are those of noise.
TEST_F(RoomLight, AcceptsADarkRoom) {
    EXPECT_EQ(doubt(plain(240, 160, {14, 128, 128}), plain(240, 160, {21, 128, 128})),
              std::nullopt);
}

TEST_F(RoomLight, TellsHowMuchDarkerOrBrighterTheRoomIs) {
    EXPECT_THAT(doubt(in_light(0.25), in_light(1.0)),
                Optional(HasSubstr("is 4.0 times darker than the pictures")));
    EXPECT_THAT(doubt(in_light(0.625), in_light(1.0)), Optional(HasSubstr("1.6 times darker")));
    EXPECT_THAT(doubt(in_light(1.0), in_light(0.5)),
                Optional(HasSubstr("is 2.0 times brighter than the pictures")));
}

TEST_F(RoomLight, TellsPlainRoomsAndOtherViews) {
    EXPECT_THAT(doubt(plain(240, 160, {0, 128, 128}), in_light(1.0)),
                Optional(HasSubstr("is one plain grey (")));
    EXPECT_THAT(doubt(plain(240, 160, {128, 128, 128}), in_light(1.0)),
                Optional(std::string("is one plain grey (128 of 255)")));
}

// Patches of random light, seen again from a little further to the side, or with somebody who hides
// half of them.
TEST_F(RoomLight, TellsAnotherViewFromTheSameOneWithSomebodyInIt) {
    const int width = 480;
    const int height = 320;
    image::YuvImage wide = plain(width + 64, height, {0, 128, 128});
    std::uniform_int_distribution<int> luma(60, 180);
    for (int y = 0; y < height; y += 16) {
        for (int x = 0; x < width + 64; x += 16) {
            const auto value = static_cast<std::uint8_t>(luma(random_));
            for (int row = y; row < y + 16; ++row) std::fill_n(wide.y.row(row) + x, 16, value);
        }
    }
    const auto view_from = [&](int left, double light) {
        image::YuvImage view = plain(width, height, {0, 128, 128});
        for (int y = 0; y < height; ++y) std::copy_n(wide.y.row(y) + left, width, view.y.row(y));
        scale_light(view, {0, 0, width, height}, light);
        return view;
    };
    const image::YuvImage room = view_from(0, 1.0);
    for (const double light : {0.85, 1.0, 1.2}) {
        EXPECT_THAT(doubt(room, view_from(40, light)), Optional(HasSubstr("shows another view")))
            << light;
        image::YuvImage with_somebody = view_from(0, light);
        EXPECT_EQ(doubt(room, with_somebody), std::nullopt) << light;
        for (int y = 0; y < height; ++y)
            std::fill_n(with_somebody.y.row(y) + width / 2, width / 2, std::uint8_t{90});
        EXPECT_EQ(doubt(room, with_somebody), std::nullopt) << light;
    }
}

TEST_F(RoomLight, IsUnknownForAnotherSize) {
    EXPECT_EQ(doubt(plain(240, 160, {10, 128, 128}), plain(160, 120, {200, 128, 128})),
              std::nullopt);
}

// One dark picture, as of somebody right in front of the camera, says nothing.
TEST_F(RoomLight, IsToldOnceAfterSeveralLooks) {
    const BackgroundStatistics dark = learn(in_light(0.25), 3, random_);
    const BackgroundStatistics right = learn(in_light(1.0), 3, random_);
    const image::YuvImage picture = in_light(1.0);
    RoomWatch watch;
    for (int i = 0; i + 1 < RoomWatch::kOtherLight; ++i)
        EXPECT_EQ(watch.look_at_light(picture, dark.luma), std::nullopt);
    EXPECT_EQ(watch.look_at_light(picture, right.luma), std::nullopt);
    for (int i = 0; i + 1 < RoomWatch::kOtherLight; ++i)
        EXPECT_EQ(watch.look_at_light(picture, dark.luma), std::nullopt);
    EXPECT_NE(watch.look_at_light(picture, dark.luma), std::nullopt);
    for (int i = 0; i < 2 * RoomWatch::kOtherLight; ++i)
        EXPECT_EQ(watch.look_at_light(picture, dark.luma), std::nullopt);
}

}  // namespace
}  // namespace atrium::segmentation
