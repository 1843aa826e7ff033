#include "site_node/silhouette_stage/learned_rooms.hpp"

#include "tests/unit/occupied_room/occupied_capsules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace atrium::site_node {
namespace {

using occupied_room::test::CapsuleFilm;
using testing::HasSubstr;
using testing::IsEmpty;

// A person who walks, with true rooms.
struct WalkedFilm {
    WalkedFilm() {
        rig.cameras = film.cameras;
        rig.bounds_site = film.bounds_site;
        for (std::size_t c = 0; c < film.cameras.size(); ++c) {
            rooms.push_back(film.learned_empty(c));
            pictures.emplace_back();
            for (int i = 0; i < 15; ++i) {
                const Eigen::Vector3d place(0.7 * std::sin(1.9 * i), 0.7 * std::cos(2.7 * i), 0.0);
                pictures.back().push_back(film.picture(c, place));
            }
        }
    }

    std::optional<LearnedAgreement> compare(std::size_t num_rooms = 4) const {
        std::vector<std::vector<image::YuvView>> views;
        for (const auto& own : pictures) views.emplace_back(own.begin(), own.end());
        if (lost) views[1][0] = {};
        std::vector<const segmentation::BackgroundStatistics*> learned(rooms.size(), nullptr);
        for (std::size_t c = 0; c < num_rooms; ++c) learned[c] = &rooms[c];
        return compare_learned_rooms(rig, views, learned, {.min_area_px = 20}, {});
    }

    CapsuleFilm film;
    config::Rig rig;
    std::vector<segmentation::BackgroundStatistics> rooms;
    std::vector<std::vector<image::YuvImage>> pictures;
    bool lost = false;  // the first picture of a camera
};

TEST(LearnedRooms, AgreeIfTheyAreEmpty) {
    WalkedFilm film;
    const auto agreement = film.compare();
    ASSERT_TRUE(agreement);
    EXPECT_EQ(agreement->num_instants, 12u);
    EXPECT_GT(agreement->explained, 0.9);
    EXPECT_LE(agreement->worst_explained, agreement->explained);
    EXPECT_THAT(doubt_learned_rooms(*agreement), IsEmpty());
    film.lost = true;
    ASSERT_TRUE(film.compare());
}

TEST(LearnedRooms, ContradictIfCamerasShowOtherPeople) {
    WalkedFilm film;
    for (std::size_t c = 0; c < 2; ++c)  // of another instant
        std::rotate(film.pictures[c].begin(), film.pictures[c].begin() + 2, film.pictures[c].end());
    const auto agreement = film.compare();
    ASSERT_TRUE(agreement);
    EXPECT_LT(agreement->explained, 0.8);
    const std::string doubt = doubt_learned_rooms(*agreement);
    EXPECT_THAT(doubt, HasSubstr("learned_rooms_contradict explained=0."));
    EXPECT_THAT(doubt, HasSubstr("worst=" + agreement->worst));
    EXPECT_THAT(doubt, HasSubstr("turned on the spot"));
    EXPECT_THAT(doubt, HasSubstr("calibrate import --masks"));
}

TEST(LearnedRooms, AreNotComparedWithTwoCamerasOrWithoutPeople) {
    WalkedFilm film;
    EXPECT_FALSE(film.compare(2));
    EXPECT_TRUE(film.compare(3));
    for (std::size_t c = 0; c < film.pictures.size(); ++c)
        for (auto& picture : film.pictures[c]) picture = film.film.empty(c);
    EXPECT_FALSE(film.compare());
}

}  // namespace
}  // namespace atrium::site_node
