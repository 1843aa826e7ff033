#include "tools/calibrate/recording/instants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::calibrate {
namespace {

using testing::HasSubstr;

Shots shots_of(std::initializer_list<std::size_t> numbers) {
    Shots shots;
    for (const std::size_t number : numbers) shots.pictures[number] = "x.png";
    return shots;
}

TEST(Instants, AreCompleteIfAllCamerasHaveTheSameNumbers) {
    // no camera has 12: that is no gap
    const auto found =
        compare_instants({{"a", shots_of({10, 11, 13})}, {"b", shots_of({10, 11, 13})}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->first_complete, 10U);
    EXPECT_EQ(found->doubt, "");
}

TEST(Instants, NamesTheGapsOfEachCamera) {
    const auto found = compare_instants({{"a", shots_of({4, 5, 6, 8, 9})},
                                         {"b", shots_of({5, 6, 8, 9})},
                                         {"c", shots_of({4, 5, 9})}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->first_complete, 5U);
    EXPECT_THAT(found->doubt, HasSubstr("2 of 5 instants are complete"));
    EXPECT_THAT(found->doubt, HasSubstr("'b' has no 4; 'c' has no 6 to 8"));
}

TEST(Instants, CountsManyGaps) {
    Shots all, odd;
    for (std::size_t i = 0; i < 20; ++i) {
        all.pictures[i] = "x.png";
        if (i % 2 == 1) odd.pictures[i] = "x.png";
    }
    const auto found = compare_instants({{"a", all}, {"b", odd}});
    ASSERT_TRUE(found);
    EXPECT_THAT(found->doubt, HasSubstr("'b' has no 0, 2, 4 and 7 more gaps"));
}

TEST(Instants, NeedOneNumberInCommon) {
    const auto found = compare_instants({{"a", shots_of({1, 2})}, {"b", shots_of({3})}});
    ASSERT_FALSE(found);
    EXPECT_THAT(found.error().message, HasSubstr("1 to 2 of 'a', 3 of 'b'"));
}

TEST(Instants, OfVideosAreNotJudgedByNumbers) {
    Shots video;
    video.is_video = true;
    const auto found = compare_instants({{"a", video}, {"b", video}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->doubt, "");
}

}  // namespace
}  // namespace atrium::calibrate
