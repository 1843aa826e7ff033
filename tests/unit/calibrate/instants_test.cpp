#include "tools/calibrate/recording/instants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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
    EXPECT_THAT(found.error().message, HasSubstr("or leave cameras out: --cameras '!NAME'"));
}

TEST(OtherInstants, AreThoseOfCamerasWithoutANumberOfMost) {
    const auto found = find_other_instants({{"a", shots_of({1, 2, 3})},
                                            {"b", shots_of({2, 3, 4})},
                                            {"c", shots_of({3})},
                                            {"phone", shots_of({4711, 4712})},
                                            {"video", Shots{"v.mp4", true, {}, "v"}}});
    EXPECT_THAT(found.cameras, testing::ElementsAre("phone"));
    EXPECT_EQ(Numbering{}.text(found.first, found.last), "1 to 4");
}

TEST(OtherInstants, NeedAMajorityAndShareNothing) {
    const auto others = [](const std::map<std::string, Shots>& frames) {
        return find_other_instants(frames).cameras;
    };
    // two against two, one against one, and one with a gap
    EXPECT_THAT(others({{"a", shots_of({1})},
                        {"b", shots_of({1})},
                        {"c", shots_of({5})},
                        {"d", shots_of({5})}}),
                testing::IsEmpty());
    EXPECT_THAT(others({{"a", shots_of({1})}, {"b", shots_of({2})}}), testing::IsEmpty());
    EXPECT_THAT(
        others({{"a", shots_of({1, 2})}, {"b", shots_of({1, 2, 3})}, {"c", shots_of({3, 4})}}),
        testing::IsEmpty());
    EXPECT_THAT(others({}), testing::IsEmpty());
}

TEST(Instants, OfEveryTenthPictureFollowEachOther) {
    std::map<std::string, Shots> frames{{"a", shots_of({1000, 1010, 1020, 1040})},
                                        {"b", shots_of({1000, 1010, 1030, 1040})}};
    const Numbering numbering = numbering_of(frames);
    EXPECT_EQ(numbering.first, 1000U);
    EXPECT_EQ(numbering.step, 10U);
    count_by_one(frames, numbering);
    const auto numbers_of = [&](const Shots& shots) {
        std::vector<std::size_t> numbers;
        for (const auto& [number, file] : shots.pictures) numbers.push_back(number);
        return numbers;
    };
    EXPECT_THAT(numbers_of(frames["a"]), testing::ElementsAre(1000, 1001, 1002, 1004));
    EXPECT_THAT(numbers_of(frames["b"]), testing::ElementsAre(1000, 1001, 1003, 1004));
    EXPECT_THAT(compare_instants(frames, numbering)->doubt,
                HasSubstr("'a' has no 1030; 'b' has no 1020"))
        << "as the files are named";
    // masks: of the same numbers without the first, of own numbers, and of each picture
    std::map<std::string, Shots> masks{{"a", shots_of({1010, 1030})}};
    count_by_one(masks, numbering);
    EXPECT_THAT(numbers_of(masks["a"]), testing::ElementsAre(1001, 1003));
    masks = {{"a", shots_of({1, 11, 21})}};
    count_by_one(masks, numbering);
    EXPECT_THAT(numbers_of(masks["a"]), testing::ElementsAre(1, 2, 3));
    masks = {{"a", shots_of({1, 2, 3})}};
    count_by_one(masks, numbering);
    EXPECT_THAT(numbers_of(masks["a"]), testing::ElementsAre(1, 2, 3));
}

TEST(Instants, OfThreePicturesHaveNoPattern) {
    EXPECT_EQ(numbering_of({{"a", shots_of({3, 10, 17})}}).step, 1U);
}

TEST(Instants, OfVideosAreNotJudgedByNumbers) {
    Shots video;
    video.is_video = true;
    const auto found = compare_instants({{"a", video}, {"b", video}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->doubt, "");
}

TEST(Instants, OfVideosOfDifferentLengthsNameTheShorterOnes) {
    Shots video;
    video.is_video = true;
    const std::map<std::string, Shots> frames{{"a", video}, {"b", video}, {"c", video}};
    const auto of_length = [](std::size_t num_frames) {
        return Look{64, 48, 25.0, 0.0, num_frames};
    };
    EXPECT_EQ(doubt_of_lengths(frames,
                               {{"a", of_length(60)}, {"b", of_length(60)}, {"c", of_length(60)}}),
              "");
    EXPECT_THAT(doubt_of_lengths(
                    frames, {{"a", of_length(60)}, {"b", of_length(50)}, {"c", of_length(59)}}),
                HasSubstr("50 to 60 pictures: 'b' has 50, 'c' has 59. Picture N"));
}

TEST(Instants, OfVideosWithAListOfTimesAreDoubted) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path(testing::TempDir()) / "atrium-listed-times";
    fs::remove_all(folder);
    fs::create_directories(folder);
    Shots video;
    video.is_video = true;
    video.path = folder / "cam_0.mp4";
    const std::map<std::string, Shots> frames{{"a", video}, {"b", video}};
    std::ofstream(folder / "points.csv") << "x,y\n";
    EXPECT_EQ(doubt_of_listed_times(frames), "");
    std::ofstream(folder / "timestamps.csv") << "cam_id,frame_time\n0,0.1\n";
    EXPECT_THAT(doubt_of_listed_times(frames), HasSubstr("timestamps.csv is not read. Picture N"));
    video.is_video = false;
    EXPECT_EQ(doubt_of_listed_times({{"a", video}, {"b", video}}), "") << "pictures have names";
    fs::remove_all(folder);
}

}  // namespace
}  // namespace atrium::calibrate
