#include "viewer/overlay/label_layout.hpp"

#include "tests/support/random.hpp"
#include "viewer/overlay/label_scale.hpp"
#include "viewer/overlay/text_picture.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using renderer::EyeView;
using renderer::Label;

const EyeView kLabelEye =
    renderer::eye_of({.position_m = {0, -4, 1}, .target_m = {0, 0, 1}, .fov_deg = 40.0}, 1280, 720);

Label label_at(const Eigen::Vector3d& at_world) {
    return {.picture = draw_text("camera"), .at_world = at_world, .height = 0.04};
}

// Top and bottom of the label in the picture, as shares of its height, and left and right.
struct Edges {
    double low, high, left, right;
};
Edges edges_of(const Label& label) {
    const Eigen::Vector4d clip = kLabelEye.clip_from_world() * label.at_world.homogeneous();
    const double foot = 0.5 * clip.y() / clip.w() + label.raised * label.height;
    const double middle = 0.5 * 1280.0 / 720.0 * clip.x() / clip.w();
    const double half = 0.5 * label.height * label.picture->width / label.picture->height;
    return {foot, foot + label.height, middle - half, middle + half};
}
// Whether letters cover letters: the pictures have an empty border.
bool cover_each_other(const Label& a, const Label& b) {
    constexpr double kBorder = 0.25 * 0.04;
    const Edges x = edges_of(a);
    const Edges y = edges_of(b);
    return x.left < y.right - kBorder && y.left < x.right - kBorder && x.low < y.high - kBorder &&
           y.low < x.high - kBorder;
}

TEST(LabelLayout, LeavesLabelsThatDoNotTouch) {
    std::vector<Label> labels{label_at({-1, 0, 1}), label_at({1, 0, 1}), label_at({0, 0, 1.5})};
    separate_labels(labels, 0, kLabelEye);
    ASSERT_EQ(labels.size(), 3U);
    for (const Label& label : labels) EXPECT_EQ(label.raised, 0.0);
}

TEST(LabelLayout, KeepsALabelInThePicture) {
    test::Random random(5);
    for (int i = 0; i < 200; ++i) {
        const Label there = label_at({test::between(random, -3.0, 3.0),
                                      test::between(random, -2.0, 2.0),
                                      test::between(random, -1.0, 3.0)});
        Label label = there;
        keep_in_picture(label, kLabelEye);
        const Edges before = edges_of(there);
        const Edges after = edges_of(label);
        constexpr double kEdge = 0.5 * 1280.0 / 720.0;
        constexpr double kBorder = 0.1 * 0.04 + 1e-9;  // without letters
        EXPECT_GE(after.low, -0.5 - kBorder);
        EXPECT_LE(after.high, 0.5 + kBorder);
        EXPECT_GE(after.left, -kEdge - kBorder);
        EXPECT_LE(after.right, kEdge + kBorder);
        const bool was_inside =
            before.low > -0.5 && before.high < 0.5 && before.left > -kEdge && before.right < kEdge;
        EXPECT_TRUE(!was_inside || label.at_world == there.at_world);
    }
}

TEST(LabelLayout, StacksLabelsOfOnePlaceAndDropsWhatHasNoRoom) {
    std::vector<Label> labels(9, label_at({0, 0, 1}));
    separate_labels(labels, 0, kLabelEye);
    EXPECT_GE(labels.size(), 3U);
    EXPECT_LT(labels.size(), 9U);
    for (std::size_t i = 0; i < labels.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(cover_each_other(labels[i], labels[j]));
}

TEST(LabelLayout, KeepsEveryNameOfAPerson) {
    std::vector<Label> labels(9, label_at({0, 0, 1}));
    separate_labels(labels, 9, kLabelEye);
    EXPECT_EQ(labels.size(), 9U);
    EXPECT_EQ(labels[0].raised, 0.0);
}

TEST(LabelLayout, NoneCoversAnotherForRandomPlaces) {
    test::Random random(3);
    for (int trial = 0; trial < 50; ++trial) {
        std::vector<Label> labels;
        for (int i = 0; i < 30; ++i)
            labels.push_back(
                label_at(Eigen::Vector3d(0, 0, 1) + test::random_in_cube(random, 1.0)));
        labels.push_back(label_at({0, -9, 1}));  // behind the eye
        separate_labels(labels, 0, kLabelEye);
        EXPECT_GT(labels.size(), 10U);
        for (std::size_t i = 0; i < labels.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_FALSE(labels[i].at_world.y() > -4 && labels[j].at_world.y() > -4 &&
                             cover_each_other(labels[i], labels[j]));
    }
}

TEST(LabelLayout, TellsWhatTheLabelsCover) {
    std::vector<Label> labels{label_at({0, 0, 1}), label_at({0, -9, 1}), label_at({1, 0, 1})};
    labels[2].opacity = 0.0;
    const auto boxes = label_boxes(labels, kLabelEye);
    ASSERT_EQ(boxes.size(), 1U) << "not those behind the eye, or hidden";
    EXPECT_NEAR(boxes[0].center().x(), 0.5f, 1e-3f);
    EXPECT_NEAR(boxes[0].max().y(), 0.5f, 1e-3f) << "it stands on its place";
    EXPECT_NEAR(boxes[0].sizes().y(), 0.04f, 1e-3f);
}

TEST(TextPicture, HasThePixelsOfTheLabel) {
    EXPECT_EQ(text_height_px(0.05, 720), 36);
    EXPECT_EQ(text_height_px(0.05, 2160), 108);
    EXPECT_EQ(text_height_px(0.05, 0), text_height_px(0.05, 20)) << "small, but not empty";
    const auto small = draw_text("alice", 36);
    const auto large = draw_text("alice", 108);
    EXPECT_EQ(small->height, 36);
    EXPECT_EQ(large->height, 108);
    EXPECT_NEAR(static_cast<double>(large->width) / small->width, 3.0, 0.15);
}

TEST(LabelScale, KeepsTheShareOfThePictureUnlessTheUserChoosesOne) {
    EXPECT_EQ(label_scale_of(0.0, 720), 1.0);
    EXPECT_EQ(label_scale_of(0.0, 2160), 1.0);
    EXPECT_EQ(label_scale_of(2.0, 720), 2.0);
    EXPECT_NEAR(label_scale_of(1.0, 2160), 1.0 / 3.0, 1e-9);
}

}  // namespace
}  // namespace atrium::viewer
