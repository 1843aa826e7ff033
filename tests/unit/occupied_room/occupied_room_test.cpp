#include "site_node/occupied_room/learn_occupied_room.hpp"
#include "site_node/segmentation/block_clusters.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "tests/unit/occupied_room/occupied_capsules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace atrium::occupied_room {
namespace {

using testing::HasSubstr;

constexpr std::size_t kInstants = 30;

enum class Way { kAbout, kAlongX };

// Pictures of all cameras while a person stands at one place for `num_still` instants and then
// moves.
struct Film {
    explicit Film(std::size_t num_still, Way way = Way::kAbout, int num_cameras = 4)
        : room(num_cameras) {
        for (std::size_t c = 0; c < room.cameras.size(); ++c) {
            pictures.emplace_back();
            truth.emplace_back(kInstants);
            for (std::size_t i = 0; i < kInstants; ++i) {
                const double step = static_cast<double>(i);
                const Eigen::Vector3d place =
                    i < num_still
                        ? Eigen::Vector3d(0.1, way == Way::kAbout ? -0.1 : 0.0, 0.0)
                        : Eigen::Vector3d(0.7 * std::sin(1.9 * step),
                                          way == Way::kAbout ? 0.7 * std::cos(2.7 * step) : 0.0,
                                          0.0);
                pictures.back().push_back(room.picture(c, place, &truth.back()[i]));
            }
        }
    }

    OccupiedRoom seen() const {
        OccupiedRoom all{room.cameras, room.bounds_site, {}};
        for (const auto& own : pictures) all.pictures.emplace_back(own.begin(), own.end());
        return all;
    }

    // Least over the cameras of the mean over the instants.
    double iou(const std::vector<segmentation::BackgroundStatistics>& rooms) const {
        double least = 1.0;
        for (std::size_t c = 0; c < rooms.size(); ++c) {
            segmentation::Segmenter segmenter(rooms[c], {.min_area_px = 20, .max_hole_px = 20});
            double sum = 0.0;
            for (std::size_t i = 0; i < kInstants; ++i) {
                image::Mask mask;
                EXPECT_TRUE(segmenter.segment(pictures[c][i], mask));
                double both = 0.0;
                double either = 0.0;
                for (std::size_t p = 0; p < mask.data.size(); ++p) {
                    both += (mask.data[p] & truth[c][i].data[p]) != 0;
                    either += (mask.data[p] | truth[c][i].data[p]) != 0;
                }
                sum += both / either;
            }
            least = std::min(least, sum / kInstants);
        }
        return least;
    }

    std::vector<segmentation::BackgroundStatistics> learn() {
        std::vector<segmentation::BackgroundStatistics> rooms;
        for (auto& room_of : learn_occupied_room(seen(), {}, [](std::size_t, std::size_t) {}, {})) {
            EXPECT_TRUE(room_of) << room_of.error().message;
            most_never_empty = std::max(most_never_empty, room_of->never_empty);
            rooms.push_back(std::move(room_of->room));
        }
        return rooms;
    }

    test::CapsuleFilm room;
    std::vector<std::vector<image::YuvImage>> pictures;
    std::vector<std::vector<image::Mask>> truth;
    double most_never_empty = 0.0;  // of the cameras, as learned
};

Film& moving_film() {
    static Film film(0);
    return film;
}

TEST(OccupiedRoom, LearnsTheRoomBehindAPersonWhoMoves) {
    Film& film = moving_film();
    EXPECT_GT(film.iou(film.learn()), 0.85);
    EXPECT_LT(film.most_never_empty, 0.01);
}

// The mean of the pictures, like their median, has the person in it.
TEST(OccupiedRoom, LearnsTheRoomBehindAPersonWhoStandsMostOfTheTime) {
    Film film(18);
    EXPECT_GT(film.iou(film.learn()), 0.85);
    EXPECT_LT(film.most_never_empty, 0.01);
    std::vector<segmentation::BackgroundStatistics> means;
    for (const auto& pictures : film.pictures) {
        segmentation::BackgroundLearner learner;
        for (const auto& picture : pictures) ASSERT_TRUE(learner.add(picture));
        means.push_back(*learner.finish());
    }
    EXPECT_LT(film.iou(means), 0.4);
}

// Cameras 0 and 4 see the middle of the person at the same place of the picture all the time. Only
// the other cameras tell that it is not the room.
TEST(OccupiedRoom, LearnsTheRoomBehindAPersonWhoMovesAlongALineOfSight) {
    Film film(18, Way::kAlongX, 8);
    EXPECT_GT(film.iou(film.learn()), 0.8);  // 0.59 without the other cameras
    EXPECT_GT(film.most_never_empty, 0.005);
}

TEST(OccupiedRoom, LearnsTheSameFromEmptyPictures) {
    test::CapsuleFilm room;
    OccupiedRoom seen{room.cameras, room.bounds_site, {}};
    std::vector<std::vector<image::YuvImage>> pictures(room.cameras.size());
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        for (int i = 0; i < 12; ++i) pictures[c].push_back(room.empty(c));
        seen.pictures.emplace_back(pictures[c].begin(), pictures[c].end());
    }
    const auto learned = learn_occupied_room(seen, {}, [](std::size_t, std::size_t) {}, {});
    for (std::size_t c = 0; c < learned.size(); ++c) {
        ASSERT_TRUE(learned[c]);
        EXPECT_EQ(learned[c]->never_empty, 0.0);
        EXPECT_EQ(learned[c]->covered, 0.0);
        segmentation::BackgroundLearner learner;
        for (const auto& picture : pictures[c]) ASSERT_TRUE(learner.add(picture));
        const auto mean = learner.finish();
        double most = 0.0;
        for (std::size_t p = 0; p < mean->luma.size(); ++p)
            most = std::max(most, std::abs(mean->luma[p] - learned[c]->room.luma[p]) / 256.0);
        EXPECT_LT(most, 2.0);  // grey levels: an outlier may be left out
    }
}

TEST(OccupiedRoom, NamesACameraWithTooFewPictures) {
    OccupiedRoom seen = moving_film().seen();
    for (std::size_t i = 5; i < kInstants; ++i) seen.pictures[1][i] = {};
    const auto learned = learn_occupied_room(seen, {}, [](std::size_t, std::size_t) {}, {});
    EXPECT_TRUE(learned[0]);
    ASSERT_FALSE(learned[1]);
    EXPECT_EQ(learned[1].error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(learned[1].error().message, HasSubstr("only 5 pictures"));
}

TEST(OccupiedRoom, NamesInstantsWithoutPictures) {
    OccupiedRoom seen = moving_film().seen();
    for (auto& views : seen.pictures)
        for (std::size_t i = 0; i < kInstants; ++i)
            if (i % 10 != 0) views[i] = {};
    const auto learned = learn_occupied_room(seen, {}, [](std::size_t, std::size_t) {}, {});
    ASSERT_FALSE(learned[0]);
    EXPECT_THAT(learned[0].error().message,
                HasSubstr(" of " + std::to_string(kInstants) + " instants have pictures"));
    EXPECT_THAT(learned[0].error().message, HasSubstr("number the pictures of the recording"));
}

TEST(OccupiedRoom, StopsEarly) {
    std::stop_source stop;
    stop.request_stop();
    const auto learned = learn_occupied_room(
        moving_film().seen(), {}, [](std::size_t, std::size_t) {}, stop.get_token());
    ASSERT_EQ(learned.size(), 4u);
    for (const auto& room : learned) EXPECT_EQ(room.error().kind, ErrorKind::kUnavailable);
}

TEST(BlockClusters, FillsUnknownBlocksFromTheirSurroundings) {
    test::CapsuleFilm film;
    segmentation::BackgroundStatistics room = film.learned_empty(0);
    const segmentation::BackgroundStatistics whole = room;
    std::vector<std::uint8_t> unknown(room.u.size(), 0);
    const int columns = room.width / 2;
    for (int y = 20; y < 30; ++y) {
        for (int x = 30; x < 40; ++x) unknown[static_cast<std::size_t>(y * columns + x)] = 1;
    }
    segmentation::fill_unknown(unknown, room);
    double most = 0.0;
    for (std::size_t p = 0; p < room.luma.size(); ++p)
        most = std::max(most, std::abs(room.luma[p] - whole.luma[p]) / 256.0);
    EXPECT_GT(most, 0.0);
    EXPECT_LT(most, 12.0);  // grey levels, of a wall that varies by 20 across the hole
}

}  // namespace
}  // namespace atrium::occupied_room
