#include "viewer/control/start_view.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace atrium::viewer {
namespace {

using renderer::ViewCamera;

const ViewCamera kUsualView{
    .position_m = {2.6, -3.6, 1.9}, .target_m = {0.0, 0.0, 0.95}, .fov_deg = 38.0};
constexpr int kViewWide = 960;
constexpr int kViewTall = 540;
constexpr double kViewAspect = static_cast<double>(kViewWide) / kViewTall;

// A standing person of 1.7 m whose arms reach 1.2 m.
PersonPlace person_at(double x, double y, const Eigen::Vector3d& front = Eigen::Vector3d::Zero()) {
    return {.middle = {x, y, 0.85},
            .eyes = {x, y, 1.6},
            .top = {x, y, 1.7},
            .size = {0.4, 1.2, 1.7},
            .front = front};
}

// The part of the picture that the people take, as shares of its height.
struct Framed {
    double margin = 1.0;  // the smallest, to any border
    double tall = 0.0;
};
Framed framed(const ViewCamera& camera, const FollowCamera::Places& people) {
    Eigen::AlignedBox2d seen;
    for (const auto& [name, place] : people) {
        for (const double z : {0.0, 1.7}) {
            for (const Eigen::Vector2d& side : {Eigen::Vector2d(0.6, 0.0),
                                                Eigen::Vector2d(-0.6, 0.0),
                                                Eigen::Vector2d(0.0, 0.6),
                                                Eigen::Vector2d(0.0, -0.6)})
                seen.extend(renderer::project_px(
                    camera,
                    {place.middle.x() + side.x(), place.middle.y() + side.y(), z},
                    kViewWide,
                    kViewTall));
        }
    }
    return {std::min({seen.min().x(),
                      seen.min().y(),
                      kViewWide - seen.max().x(),
                      kViewTall - seen.max().y()}) /
                kViewTall,
            seen.sizes().y() / kViewTall};
}

TEST(StartView, FramesAPersonOnTheRingFromTheFront) {
    const FollowCamera::Places one{{"lab", person_at(0.0, 1.8, {0.0, -1.0, 0.0})}};
    const ViewCamera view = view_of_people(one, kUsualView, kViewAspect);
    const Framed seen = framed(view, one);
    EXPECT_GT(seen.margin, 0.05);
    EXPECT_GT(seen.tall, 0.6);
    const Eigen::Vector2d to_eye = (view.position_m - view.target_m).head<2>().normalized();
    EXPECT_NEAR(to_eye.y(), -std::cos(std::numbers::pi / 6.0), 1e-9);
    EXPECT_GT(to_eye.x(), 0.0) << "towards the usual side";
    // where the second site of a world without places stands
    EXPECT_GT((view.position_m.head<2>() - Eigen::Vector2d(0.0, -1.8)).norm(), 1.5);
    // the usual view cuts nothing off, but the person is small
    EXPECT_LT(framed(kUsualView, one).tall, 0.8 * seen.tall);
    const FollowCamera::Places other{{"lab", person_at(-1.8, 0.0, {1.0, 0.0, 0.0})}};
    EXPECT_GT(view_of_people(other, kUsualView, kViewAspect).position_m.x(), 0.0);
}

// Somebody who comes into the room: the first mesh is an arm.
TEST(StartView, LeavesRoomForTheRestOfAPerson) {
    PersonPlace arm = person_at(0.0, 1.8);
    arm.size = {0.1, 0.5, 0.1};
    const FollowCamera::Places whole{{"lab", person_at(0.0, 1.8)}};
    EXPECT_GT(framed(view_of_people({{"lab", arm}}, kUsualView, kViewAspect), whole).margin, 0.05);
}

TEST(StartView, FramesPeopleWithoutACommonFrontFromTheUsualSide) {
    const FollowCamera::Places two{{"a", person_at(0.0, 1.8, {0.0, -1.0, 0.0})},
                                   {"b", person_at(0.0, -1.8, {0.0, 1.0, 0.0})}};
    for (const auto& people : {two, FollowCamera::Places{{"a", person_at(5.0, -2.0)}}}) {
        const ViewCamera view = view_of_people(people, kUsualView, kViewAspect);
        EXPECT_GT(framed(view, people).margin, 0.05);
        EXPECT_LT(((view.position_m - view.target_m).normalized() -
                   (kUsualView.position_m - kUsualView.target_m).normalized())
                      .norm(),
                  1e-9);
    }
}

TEST(StartView, IsChosenOnceWhenAllAwaitedPeopleAreThere) {
    StartView start(kUsualView, 2, true);
    FollowCamera::Places people;
    EXPECT_FALSE(start.update(people, kViewAspect));
    people["a"] = person_at(0.0, 1.8, {0.0, -1.0, 0.0});
    EXPECT_FALSE(start.update(people, kViewAspect));
    people["b"] = person_at(0.0, -1.8, {0.0, 1.0, 0.0});
    EXPECT_TRUE(start.update(people, kViewAspect));
    people["a"].middle.x() += 3.0;
    people["c"] = person_at(4.0, 0.0);
    EXPECT_FALSE(start.update(people, kViewAspect));
    EXPECT_FALSE(StartView(kUsualView, 0, false).update(people, kViewAspect))
        << "the user gave a view";
}

TEST(StartView, IsChosenAgainWhenOthersTakeThePlaceOfThosePeople) {
    StartView start(kUsualView, 0, true);
    const FollowCamera::Places first{{"lab", person_at(0.0, 1.8)}};
    const FollowCamera::Places both{{"lab", person_at(0.0, 1.8)}, {"hall", person_at(0.0, -9.0)}};
    const FollowCamera::Places second{{"hall", person_at(0.0, -9.0)}};
    EXPECT_TRUE(start.update(first, kViewAspect));
    EXPECT_FALSE(start.update({}, kViewAspect));
    EXPECT_FALSE(start.update(first, kViewAspect)) << "the same one is back";
    EXPECT_FALSE(start.update(both, kViewAspect)) << "one of two is seen";
    const auto view = start.update(second, kViewAspect);
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->target_m.y(), -9.0, 1e-9);
    EXPECT_FALSE(start.update(second, kViewAspect));
}

TEST(StartView, IsChosenAgainWhenTheSiteGetsItsPlace) {
    StartView start(kUsualView, 0, true);
    EXPECT_TRUE(start.update({{"lab", person_at(0.0, 0.0)}}, kViewAspect));
    const FollowCamera::Places placed{{"lab", person_at(0.0, 1.8, {0.0, -1.0, 0.0})}};
    const auto view = start.update(placed, kViewAspect);
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->target_m.y(), 1.8, 1e-9);
    EXPECT_FALSE(start.update(placed, kViewAspect));
}

}  // namespace
}  // namespace atrium::viewer
