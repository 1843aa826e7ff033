#include "viewer/overlay/name_tags.hpp"

#include "viewer/overlay/text_picture.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

const NameTags::Clock::time_point kFirstTag{std::chrono::hours(1)};
const Eigen::Vector3d kEye(0, -3, 1.6);

TEST(NameTags, StandOverAllHeadsExceptTheEyesInUse) {
    NameTags tags;
    const std::map<std::string, NameTags::Person> people{{"alice", {{0, 0, 1.7}}},
                                                         {"bob", {{1, 0, 1.8}}}};
    const auto both = tags.update(people, "", kEye, kFirstTag);
    ASSERT_EQ(both.size(), 2U);
    EXPECT_NEAR(both[0].at_world.z(), 1.76, 1e-9);
    EXPECT_EQ(both[1].at_world.x(), 1.0);
    EXPECT_EQ(both[0].opacity, 1.0);
    const auto one = tags.update(people, "alice", kEye, kFirstTag);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_EQ(one[0].picture, both[1].picture) << "the picture must be drawn only once";
    EXPECT_TRUE(tags.update({}, "", kEye, kFirstTag).empty());
}

TEST(NameTags, FadeWithThePersonAndTheDistance) {
    NameTags tags;
    const auto opacity_at = [&](double distance_m, double opacity) {
        const auto labels =
            tags.update({{"alice", {{0, 0, 1.7}, opacity}}}, "", {0, -distance_m, 1.7}, kFirstTag);
        return labels.empty() ? 0.0 : labels[0].opacity;
    };
    EXPECT_EQ(opacity_at(2, 1.0), 1.0);
    EXPECT_EQ(opacity_at(2, 0.35), 0.35);
    EXPECT_NEAR(opacity_at(14, 1.0), 0.5, 1e-9);
    EXPECT_NEAR(opacity_at(14, 0.5), 0.25, 1e-9);
    EXPECT_EQ(opacity_at(25, 1.0), 0.0);
}

TEST(NameTags, FollowAHeadWithoutFlicker) {
    NameTags tags;
    auto now = kFirstTag;
    const auto height_m = [&](double top_m) {
        now += milliseconds(16);
        return tags.update({{"alice", {{0, 0, top_m}}}}, "", kEye, now).at(0).at_world.z();
    };
    double least_m = height_m(1.7);
    double most_m = least_m;
    for (int i = 0; i < 100; ++i) {
        const double at_m = height_m(i % 2 == 0 ? 1.73 : 1.67);
        least_m = std::min(least_m, at_m);
        most_m = std::max(most_m, at_m);
    }
    EXPECT_LT(most_m - least_m, 0.02);
    for (int i = 0; i < 100; ++i) height_m(1.2);
    EXPECT_NEAR(height_m(1.2), 1.26, 0.01) << "the tag must follow a person who sits down";
    EXPECT_NEAR(height_m(0.4), 0.46, 1e-9) << "the tag must follow a jump immediately";
}

TEST(TextPicture, HasWhiteLettersWithADarkRim) {
    const auto picture = draw_text("alice");
    ASSERT_EQ(picture->rgba.size(), std::size_t{4} * 64 * static_cast<std::size_t>(picture->width));
    std::size_t num_white = 0;
    std::size_t num_dark = 0;
    std::size_t num_clear = 0;
    for (std::size_t i = 0; i < picture->rgba.size(); i += 4) {
        ASSERT_LE(picture->rgba[i], picture->rgba[i + 3]) << "colours must be multiplied by alpha";
        num_white += picture->rgba[i] > 200 ? 1 : 0;
        num_dark += picture->rgba[i] < 20 && picture->rgba[i + 3] > 120 ? 1 : 0;
        num_clear += picture->rgba[i + 3] == 0 ? 1 : 0;
    }
    EXPECT_GT(num_white, 300U);
    EXPECT_GT(num_dark, num_white);
    EXPECT_GT(num_clear, num_dark / 2);
    for (int x = 0; x < picture->width; ++x)
        EXPECT_LT(picture->rgba[4 * static_cast<std::size_t>(x) + 3], 30)
            << "the text must not be cut off";
}

TEST(TextPicture, AcceptsAnyBytes) {
    EXPECT_EQ(draw_text("a\x01\xff\n").get()->rgba, draw_text("a???").get()->rgba);
    EXPECT_EQ(draw_text(std::string(100'000, 'x'))->rgba, draw_text(std::string(63, 'x'))->rgba);
    EXPECT_GT(draw_text("")->width, 0);
}

}  // namespace
}  // namespace atrium::viewer
