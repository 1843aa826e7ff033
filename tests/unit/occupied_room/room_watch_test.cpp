#include "site_node/segmentation/room_watch.hpp"

#include "site_node/segmentation/segmentation.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/unit/occupied_room/occupied_capsules.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::occupied_room {
namespace {

using segmentation::RoomWatch;

const Eigen::Vector3d kPlace{0.1, -0.1, 0.0};

// Shows `num_looks` due pictures, which `picture(look)` makes, segmented with `room`.
template <typename Picture>
std::optional<RoomWatch::Ghost> watch(const segmentation::BackgroundStatistics& room,
                                      int num_looks,
                                      Picture&& picture) {
    segmentation::Segmenter segmenter(room, {.min_area_px = 20, .max_hole_px = 20});
    RoomWatch watch;
    image::Mask mask;
    for (int look = 0; look < num_looks;) {
        if (!watch.is_due()) continue;
        const image::YuvImage shown = picture(look++);
        EXPECT_TRUE(segmenter.segment(shown, mask));
        if (const auto ghost = watch.look(shown, room, mask)) return ghost;
    }
    return std::nullopt;
}

segmentation::BackgroundStatistics room_with_a_person(test::CapsuleFilm& film, std::size_t camera) {
    segmentation::BackgroundLearner learner;
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(learner.add(film.picture(camera, kPlace)));
    return *learner.finish();
}

TEST(RoomWatch, FindsThePersonInTheLearnedRoom) {
    test::CapsuleFilm film;
    for (std::size_t camera = 0; camera < film.cameras.size(); ++camera) {
        image::Mask truth;
        (void)film.picture(camera, kPlace, &truth);
        const auto ghost =
            watch(room_with_a_person(film, camera), 10, [&](int) { return film.empty(camera); });
        ASSERT_TRUE(ghost) << camera;
        EXPECT_NE(truth.at(ghost->x, ghost->y), 0);
    }
}

TEST(RoomWatch, FindsItWhileSomebodyElseWalksThroughTheRoom) {
    test::CapsuleFilm film;
    const auto ghost = watch(room_with_a_person(film, 0), 20, [&](int look) {
        return film.picture(0, {0.0, look % 3 == 0 ? 0.1 : look % 2 == 0 ? 1.0 : -1.0, 0.0});
    });
    EXPECT_TRUE(ghost);
}

TEST(RoomWatch, IsQuietInAGoodRoom) {
    test::CapsuleFilm film;
    const std::size_t num_cameras = atrium::test::kSanitized ? 1 : film.cameras.size();
    for (std::size_t camera = 0; camera < num_cameras; ++camera) {
        const auto room = film.learned_empty(camera);
        EXPECT_FALSE(watch(room, 30, [&](int) { return film.picture(camera, kPlace); }));
        EXPECT_FALSE(watch(room, 30, [&](int) { return film.empty(camera); }));
        EXPECT_FALSE(watch(room, 30, [&](int look) {
            return film.picture(camera, {0.8 * std::sin(0.7 * look), 0.8 * std::cos(look), 0.0});
        }));
    }
}

TEST(RoomWatch, LooksRarelyAfterTheStart) {
    RoomWatch watch;
    test::CapsuleFilm film;
    const auto room = film.learned_empty(0);
    const image::YuvImage picture = film.empty(0);
    const image::Mask nobody(picture.width(), picture.height());
    int num_looks = 0;
    for (std::uint32_t i = 0; i < 2 * RoomWatch::kLaterGap; ++i) {
        if (!watch.is_due()) continue;
        ++num_looks;
        (void)watch.look(picture, room, nobody);
    }
    EXPECT_EQ(num_looks, RoomWatch::kFirstLooks + 1);
}

}  // namespace
}  // namespace atrium::occupied_room
