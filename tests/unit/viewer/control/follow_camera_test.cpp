#include "viewer/control/follow_camera.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using renderer::ViewCamera;
using std::chrono::milliseconds;

const ViewCamera kCamera{.position_m = {3, 0, 2}, .target_m = {0, 0, 1}};
const FollowCamera::Clock::time_point kFirstMesh{std::chrono::hours(1)};

PersonPlace standing_at(double x, double y) { return {{x, y, 0.9}, {x, y, 1.65}, {x, y, 1.8}}; }

TEST(PersonPlace, HasTheEyesInTheHead) {
    // a body with one arm far out, and a head beside its middle
    std::vector<Eigen::Vector3f> vertices;
    for (float z = 0.0F; z <= 1.45F; z += 0.05F)
        for (const float x : {-0.2F, 0.2F}) vertices.emplace_back(x, 0.1F * x, z);
    vertices.emplace_back(0.9F, 0.0F, 1.2F);
    for (float z = 1.46F; z <= 1.701F; z += 0.02F)
        for (const float x : {0.0F, 0.2F}) vertices.emplace_back(x, 0.05F, z);
    const PersonPlace place = place_of(vertices);
    EXPECT_LT((place.eyes - Eigen::Vector3d(0.1, 0.05, 1.58)).norm(), 0.03);
    EXPECT_LT((place.top - Eigen::Vector3d(0.1, 0.05, 1.7)).norm(), 0.01);
    EXPECT_NEAR(place.middle.x(), 0.35, 1e-6);
    EXPECT_NEAR(place.middle.z(), 0.85, 1e-3);
}

TEST(PersonPlace, ARaisedArmIsNoHead) {
    std::vector<Eigen::Vector3f> vertices;
    const auto fill = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
        for (int i = 0; i < 1000; ++i) {
            const Eigen::Vector3f share(static_cast<float>(i % 10) / 9.0f,
                                        static_cast<float>(i / 10 % 10) / 9.0f,
                                        static_cast<float>(i / 100) / 9.0f);
            vertices.emplace_back(low + share.cwiseProduct(high - low));
        }
    };
    fill({-0.2f, -0.1f, 0.0f}, {0.2f, 0.1f, 1.45f});
    fill({-0.1f, -0.1f, 1.5f}, {0.1f, 0.1f, 1.75f});
    const PersonPlace resting = place_of(vertices);
    fill({0.5f, -0.05f, 1.4f}, {0.6f, 0.05f, 1.8f});
    const PersonPlace raised = place_of(vertices);
    EXPECT_LT((raised.eyes - resting.eyes).norm(), 0.01);
    EXPECT_LT((raised.top - resting.top).norm(), 0.01);
    EXPECT_GT(raised.middle.x(), resting.middle.x() + 0.1);
}

TEST(FollowCamera, FollowsTheNearestUntilToggled) {
    FollowCamera follow_camera;
    FollowCamera::Places places{{"alice", standing_at(-0.4, 0)}, {"bob", standing_at(2, 2)}};
    follow_camera.toggle_follow(kCamera, places);
    EXPECT_EQ(follow_camera.name(), "alice");
    EXPECT_FALSE(follow_camera.is_first_person());
    ViewCamera camera = kCamera;
    auto now = kFirstMesh;
    for (int i = 0; i < 200; ++i) {
        places["alice"] = standing_at(-0.4 + 0.01 * std::min(i, 100), 0);
        camera = follow_camera.update(camera, places, now += milliseconds(16));
    }
    EXPECT_LT((camera.target_m - places["alice"].middle).norm(), 0.01);
    EXPECT_LT(
        (camera.position_m - camera.target_m - (kCamera.position_m - kCamera.target_m)).norm(),
        1e-9)
        << "the view must keep its side";
    follow_camera.toggle_follow(camera, places);
    EXPECT_EQ(follow_camera.name(), "");
    places["alice"] = standing_at(-2, 0);
    EXPECT_EQ(follow_camera.update(camera, places, now += milliseconds(16)), camera);
}

TEST(FollowCamera, KeepsAViewThatTheUserMovesWhileFollowing) {
    FollowCamera follow_camera;
    const FollowCamera::Places places{{"alice", standing_at(0, 0)}};
    follow_camera.toggle_follow(kCamera, places);
    ViewCamera camera = kCamera;
    auto now = kFirstMesh;
    for (int i = 0; i < 200; ++i)
        camera = follow_camera.update(camera, places, now += milliseconds(16));
    // orbiting moves only the eye, and the follow_camera must not undo it
    camera.position_m += Eigen::Vector3d(0, 1, 0.2);
    const ViewCamera moved = follow_camera.update(camera, places, now += milliseconds(16));
    EXPECT_LT((moved.position_m - camera.position_m).norm(), 1e-6);
}

TEST(FollowCamera, LooksAheadInTheEyesOfAPersonAlone) {
    FollowCamera follow_camera;
    const FollowCamera::Places places{{"bob", standing_at(2, 2)}};
    follow_camera.toggle_first_person(1, places);
    const ViewCamera camera = follow_camera.update(kCamera, places, kFirstMesh);
    EXPECT_LT((camera.target_m - camera.position_m - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-9)
        << "as the camera looked before";
}

TEST(FollowCamera, LooksAtTheNearestThingInTheEyesOfAPersonAlone) {
    FollowCamera follow_camera;
    const FollowCamera::Places places{{"bob", standing_at(2, 2)}};
    const std::vector<Eigen::Vector3d> things{{2, 9, 0}, {2, 4, 0.2}, {2.1, 1.8, 1.2}};
    follow_camera.toggle_first_person(1, places, things);
    const ViewCamera camera = follow_camera.update(kCamera, places, kFirstMesh);
    EXPECT_LT((camera.target_m - camera.position_m - Eigen::Vector3d(0, 1, 0)).norm(), 1e-9)
        << "level, and not at the one within reach";
}

TEST(FollowCamera, SeesThroughTheEyesOfTheChosenPerson) {
    FollowCamera follow_camera;
    FollowCamera::Places places{{"alice", standing_at(-0.4, 0)}, {"bob", standing_at(2, 2)}};
    follow_camera.toggle_first_person(3, places);
    EXPECT_FALSE(follow_camera.is_first_person()) << "there are only two people";
    follow_camera.toggle_first_person(2, places);
    EXPECT_TRUE(follow_camera.is_first_person());
    ViewCamera camera = follow_camera.update(kCamera, places, kFirstMesh);
    EXPECT_LT((camera.position_m - places["bob"].eyes).norm(), 1e-12);
    EXPECT_NEAR(camera.target_m.z(), camera.position_m.z(), 1e-12) << "level";
    Eigen::Vector3d to_alice = places["alice"].eyes - places["bob"].eyes;
    EXPECT_LT((camera.target_m - camera.position_m - to_alice.normalized()).norm(), 1e-9)
        << "towards the other person";
    // a head that flickers by 5 cm between pictures hardly moves the view
    auto now = kFirstMesh;
    double shaken_m = 0.0;
    for (int i = 0; i < 100; ++i) {
        places["bob"].eyes.z() = 1.65 + (i % 2 == 0 ? 0.025 : -0.025);
        const ViewCamera next = follow_camera.update(camera, places, now += milliseconds(16));
        shaken_m = std::max(shaken_m, (next.position_m - camera.position_m).norm());
        camera = next;
    }
    EXPECT_LT(shaken_m, 0.01);
    follow_camera.leave_eyes();
    EXPECT_FALSE(follow_camera.is_first_person());
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    EXPECT_EQ(camera, kCamera) << "outside the person again";
    follow_camera.leave_eyes();
    EXPECT_EQ(follow_camera.update(camera, places, now += milliseconds(16)), kCamera);
    follow_camera.toggle_first_person(2, places);
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    follow_camera.toggle_first_person(2, places);
    EXPECT_FALSE(follow_camera.is_first_person()) << "the same number again must leave the eyes";
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    EXPECT_EQ(camera, kCamera) << "outside the person again";
    follow_camera.toggle_first_person(2, places);
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    follow_camera.toggle_first_person(1, places);
    EXPECT_EQ(follow_camera.name(), "alice");
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    EXPECT_LT((camera.position_m - places["alice"].eyes).norm(), 1e-12);
    follow_camera.toggle_first_person(1, places);
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    EXPECT_EQ(camera, kCamera) << "from eyes to other eyes and out";
    follow_camera.toggle_first_person(1, places);
    camera = follow_camera.update(camera, places, now += milliseconds(16));
    places.erase("alice");
    EXPECT_EQ(follow_camera.update(camera, places, now += milliseconds(16)), camera);
    EXPECT_FALSE(follow_camera.is_first_person()) << "the person has left";
}

}  // namespace
}  // namespace atrium::viewer
