#include "tests/support/random.hpp"
#include "viewer/control/site_selection.hpp"
#include "viewer/control/view_flight.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::viewer {
namespace {

using renderer::ViewCamera;

TEST(SiteSelection, HidesAndShowsAgain) {
    SiteSelection sites;
    EXPECT_TRUE(sites.shows("alice"));
    sites.toggle("alice");
    EXPECT_FALSE(sites.shows("alice"));
    EXPECT_TRUE(sites.shows("bob"));
    sites.toggle("alice");
    EXPECT_TRUE(sites.shows("alice"));
}

TEST(SiteSelection, SoloEndsWithoutForgettingWhatIsHidden) {
    SiteSelection sites;
    sites.toggle("carol");
    sites.toggle_solo("alice");
    EXPECT_TRUE(sites.shows("alice"));
    EXPECT_FALSE(sites.shows("bob"));
    sites.toggle_solo("bob");
    EXPECT_FALSE(sites.shows("alice"));
    EXPECT_TRUE(sites.shows("bob"));
    sites.toggle_solo("bob");
    EXPECT_TRUE(sites.shows("alice"));
    EXPECT_FALSE(sites.shows("carol"));
}

TEST(SiteSelection, ShowingAnotherSiteEndsTheSolo) {
    SiteSelection sites;
    sites.toggle_solo("alice");
    sites.toggle("bob");
    EXPECT_TRUE(sites.shows("bob")) << "it was not to be seen, so the key shows it";
    EXPECT_TRUE(sites.shows("alice"));
    sites.toggle_solo("alice");
    sites.toggle("alice");
    EXPECT_FALSE(sites.shows("alice"));
    EXPECT_TRUE(sites.shows("bob"));
}

ViewCamera random_view(test::Random& random) {
    ViewCamera view;
    view.target_m = test::random_in_cube(random, 5.0);
    const double azimuth = test::between(random, -4.0, 4.0);
    const double elevation = test::between(random, -1.4, 1.4);
    const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth),
                                    std::sin(elevation));
    view.position_m = view.target_m + test::between(random, 0.3, 10.0) * direction;
    view.fov_deg = test::between(random, 10.0, 90.0);
    return view;
}

TEST(ViewFlight, GoesFromOneViewToTheOtherAtASafeDistance) {
    test::Random random(7);
    for (int trial = 0; trial < 200; ++trial) {
        const ViewCamera from = random_view(random);
        const ViewCamera to = random_view(random);
        EXPECT_EQ(between(from, to, 0.0), from);
        EXPECT_EQ(between(from, to, 1.0), to);
        const auto distance = [](const ViewCamera& view) {
            return (view.position_m - view.target_m).norm();
        };
        const double least = std::min(distance(from), distance(to));
        const double most = std::max(distance(from), distance(to));
        for (const double share : {0.01, 0.3, 0.5, 0.99}) {
            const ViewCamera view = between(from, to, share);
            EXPECT_GE(distance(view), least - 1e-9);
            EXPECT_LE(distance(view), most + 1e-9);
        }
        const ViewCamera near = between(from, to, 1e-6);
        EXPECT_LT((near.position_m - from.position_m).norm(), 1e-3) << "no jump at the start";
    }
}

TEST(ViewFlight, EndsAtItsGoalAndThenLetsTheCameraGo) {
    const ViewFlight::Clock::time_point begin{std::chrono::hours(1)};
    const ViewCamera from{.position_m = {3, 0, 2}, .target_m = {0, 0, 1}};
    const ViewCamera to{.position_m = {-3, 1, 2}, .target_m = {1, 0, 1}, .fov_deg = 30.0};
    ViewFlight flight;
    EXPECT_EQ(flight.update(from, begin), from);
    flight.start(from, to, begin);
    EXPECT_EQ(flight.update(from, begin), from);
    const ViewCamera half = flight.update(from, begin + ViewFlight::kDuration / 2);
    EXPECT_NE(half, from);
    EXPECT_NE(half, to);
    EXPECT_EQ(flight.update(half, begin + ViewFlight::kDuration), to);
    EXPECT_FALSE(flight.is_on());
    EXPECT_EQ(flight.update(from, begin + std::chrono::seconds(9)), from);
}

}  // namespace
}  // namespace atrium::viewer
