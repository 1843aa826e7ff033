#include "viewer/control/start_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::viewer {
namespace {

using renderer::ViewCamera;

const ViewCamera kUsualView{
    .position_m = {2.6, -3.6, 1.9}, .target_m = {0.0, 0.0, 0.95}, .fov_deg = 38.0};
constexpr int kViewWide = 960;
constexpr int kViewTall = 540;
constexpr double kViewAspect = static_cast<double>(kViewWide) / kViewTall;

const StartView::Clock::time_point kStartNow{};

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
    EXPECT_FALSE(start.update(people, kViewAspect, {}, kStartNow));
    people["a"] = person_at(0.0, 1.8, {0.0, -1.0, 0.0});
    EXPECT_FALSE(start.update(people, kViewAspect, {}, kStartNow));
    people["b"] = person_at(0.0, -1.8, {0.0, 1.0, 0.0});
    EXPECT_TRUE(start.update(people, kViewAspect, {}, kStartNow));
    people["a"].middle.x() += 3.0;
    people["c"] = person_at(4.0, 0.0);
    EXPECT_FALSE(start.update(people, kViewAspect, {}, kStartNow));
    EXPECT_FALSE(StartView(kUsualView, 0, false).update(people, kViewAspect, {}, kStartNow))
        << "the user gave a view";
}

TEST(StartView, IsChosenAgainWhenOthersTakeThePlaceOfThosePeople) {
    StartView start(kUsualView, 0, true);
    const FollowCamera::Places first{{"lab", person_at(0.0, 1.8)}};
    const FollowCamera::Places both{{"lab", person_at(0.0, 1.8)}, {"hall", person_at(0.0, -9.0)}};
    const FollowCamera::Places second{{"hall", person_at(0.0, -9.0)}};
    EXPECT_TRUE(start.update(first, kViewAspect, {}, kStartNow));
    EXPECT_FALSE(start.update({}, kViewAspect, {}, kStartNow));
    EXPECT_FALSE(start.update(first, kViewAspect, {}, kStartNow)) << "the same one is back";
    EXPECT_FALSE(start.update(both, kViewAspect, {}, kStartNow)) << "one of two is seen";
    const auto view = start.update(second, kViewAspect, {}, kStartNow);
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->target_m.y(), -9.0, 1e-9);
    EXPECT_FALSE(start.update(second, kViewAspect, {}, kStartNow));
}

TEST(StartView, IsChosenAgainWhenTheSiteGetsItsPlace) {
    StartView start(kUsualView, 0, true);
    EXPECT_TRUE(start.update({{"lab", person_at(0.0, 0.0)}}, kViewAspect, {}, kStartNow));
    const FollowCamera::Places placed{{"lab", person_at(0.0, 1.8, {0.0, -1.0, 0.0})}};
    const auto view = start.update(placed, kViewAspect, {}, kStartNow);
    ASSERT_TRUE(view);
    EXPECT_NEAR(view->target_m.y(), 1.8, 1e-9);
    EXPECT_FALSE(start.update(placed, kViewAspect, {}, kStartNow));
}

// Walls around a place, without a roof, as far as `half_m` and as high as `tall_m`.
Sight walled(double half_m, double tall_m) {
    Sight sight;
    sight.free_m = [=](const Ray& ray) {
        double free_m = std::numeric_limits<double>::infinity();
        for (const int axis : {0, 1}) {
            for (const double wall : {-half_m, half_m}) {
                const double t = (wall - ray.origin[axis]) / ray.direction[axis];
                const Eigen::Vector3d at = ray.origin + t * ray.direction;
                const bool is_hit = t > 0.0 && at.z() >= 0.0 && at.z() <= tall_m &&
                                    std::abs(at[1 - axis]) <= half_m;
                if (is_hit) free_m = std::min(free_m, t);
            }
        }
        return free_m;
    };
    return sight;
}

double free_share(const ViewCamera& view, const Eigen::Vector3d& at, const Sight& sight) {
    const Eigen::Vector3d way = view.position_m - at;
    return sight.free_m({at, way.normalized()}) / way.norm();
}

// A pillar of 0.6 m.
std::function<double(const Ray&)> pillar_at(const Eigen::Vector2d& pillar) {
    return [=](const Ray& ray) {
        const double level = ray.direction.head<2>().norm();
        const Eigen::Vector2d along = ray.direction.head<2>() / level;
        const Eigen::Vector2d to = pillar - ray.origin.head<2>();
        const double ahead = to.dot(along);
        const bool is_hit = ahead > 0.0 && (to - ahead * along).norm() < 0.3;
        return is_hit ? (ahead - 0.3) / level : std::numeric_limits<double>::infinity();
    };
}

TEST(StartView, LooksFromAnotherSideIfSomethingHidesThePerson) {
    const FollowCamera::Places one{{"lab", person_at(0.0, 0.0, {0.0, -1.0, 0.0})}};
    const ViewCamera usual = view_of_people(one, kUsualView, kViewAspect);
    Sight sight;
    sight.free_m = pillar_at(0.5 * usual.position_m.head<2>());  // halfway to the usual eye
    ASSERT_LT(free_share(usual, one.at("lab").middle, sight), 1.0);
    const ViewCamera view = view_of_people(one, kUsualView, kViewAspect, sight);
    for (const Eigen::Vector3d& at : {one.at("lab").eyes, one.at("lab").middle})
        EXPECT_GE(free_share(view, at, sight), 1.0);
    EXPECT_GT(framed(view, one).margin, 0.05) << "and all of the person";
    EXPECT_GT(framed(view, one).tall, 0.6);
    EXPECT_NEAR(view.position_m.z(), usual.position_m.z(), 0.3) << "from the side, not from above";
    EXPECT_GT(view.position_m.head<2>().dot(usual.position_m.head<2>()), 0.0);
}

// Things that may move away are avoided as well, but rather looked through than walls.
TEST(StartView, AvoidsWhatMayMoveAwayUnlessThatHelpsNothing) {
    const FollowCamera::Places one{{"lab", person_at(0.0, 0.0, {0.0, -1.0, 0.0})}};
    const ViewCamera usual = view_of_people(one, kUsualView, kViewAspect);
    Sight tower;
    tower.free_of_loose_m = pillar_at(0.5 * usual.position_m.head<2>());
    const ViewCamera beside = view_of_people(one, kUsualView, kViewAspect, tower);
    Sight as_if_fixed;
    as_if_fixed.free_m = tower.free_of_loose_m;
    EXPECT_EQ(beside.position_m,
              view_of_people(one, kUsualView, kViewAspect, as_if_fixed).position_m);

    Sight low = tower;  // only what is below the middle
    low.free_of_loose_m = [&](const Ray& ray) {
        return ray.origin.z() < 0.6 ? tower.free_of_loose_m(ray)
                                    : std::numeric_limits<double>::infinity();
    };
    EXPECT_EQ(view_of_people(one, kUsualView, kViewAspect, low).position_m, usual.position_m);

    Sight everywhere;  // in the middle of a heap
    everywhere.free_of_loose_m = [](const Ray&) { return 0.5; };
    EXPECT_TRUE(view_of_people(one, kUsualView, kViewAspect, everywhere)
                    .position_m.isApprox(usual.position_m, 1e-9));
}

TEST(StartView, LooksOverTheWallsOfABooth) {
    const FollowCamera::Places one{{"lab", person_at(0.0, 0.0, {0.0, -1.0, 0.0})}};
    const Sight booth = walled(1.5, 2.2);
    ASSERT_LT(free_share(view_of_people(one, kUsualView, kViewAspect), {0, 0, 0.85}, booth), 1.0);
    const ViewCamera view = view_of_people(one, kUsualView, kViewAspect, booth);
    EXPECT_GE(free_share(view, {0, 0, 0.85}, booth), 1.0);
    EXPECT_GT(framed(view, one).margin, 0.02);
}

TEST(StartView, StaysInAClosedRoom) {
    const FollowCamera::Places one{{"lab", person_at(0.5, 0.3, {0.0, -1.0, 0.0})}};
    const Sight room = walled(2.0, 100.0);
    const ViewCamera view = view_of_people(one, kUsualView, kViewAspect, room);
    EXPECT_LT(view.position_m.head<2>().cwiseAbs().maxCoeff(), 2.0 - 0.05) << "inside";
    EXPECT_GE(free_share(view, one.at("lab").middle, room), 1.0);
    EXPECT_GT((view.position_m - view.target_m).norm(), 1.5) << "as far away as it can";
}

TEST(StartView, WaitsForModelsAndLooksAgainWhenTheyCome) {
    const FollowCamera::Places one{{"lab", person_at(0.0, 0.0, {0.0, -1.0, 0.0})}};
    Sight loading;
    loading.is_complete = false;
    using std::chrono::seconds;
    StartView patient(kUsualView, 0, true);
    EXPECT_FALSE(patient.update(one, kViewAspect, loading, kStartNow));
    EXPECT_FALSE(patient.update(one, kViewAspect, loading, kStartNow + seconds(4)));
    EXPECT_TRUE(patient.update(one, kViewAspect, loading, kStartNow + seconds(6)))
        << "not for ever";

    StartView start(kUsualView, 0, true);
    const auto before = start.update(one, kViewAspect, {}, kStartNow);
    ASSERT_TRUE(before);
    EXPECT_FALSE(start.update(one, kViewAspect, {}, kStartNow + seconds(1)));
    Sight booth = walled(1.5, 2.2);
    booth.revision = 1;
    const auto after = start.update(one, kViewAspect, booth, kStartNow + seconds(1));
    ASSERT_TRUE(after);
    EXPECT_GT((after->position_m - before->position_m).norm(), 0.5);
    EXPECT_FALSE(start.update(one, kViewAspect, booth, kStartNow + seconds(1)));
    booth.revision = 2;
    EXPECT_FALSE(start.update(one, kViewAspect, booth, kStartNow + seconds(9)))
        << "somebody builds a wall much later";
}

}  // namespace
}  // namespace atrium::viewer
