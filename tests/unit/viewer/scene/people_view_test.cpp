#include "viewer/scene/people_view.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

TEST(PeopleView, FadesOnlySilentPeople) {
    using std::chrono::milliseconds;
    EXPECT_EQ(opacity_after(milliseconds(0)), 1.0);
    EXPECT_EQ(opacity_after(milliseconds(400)), 1.0) << "two of five frames a second may be lost";
    double before = 1.0;
    for (int ms = 700; ms <= 1400; ms += 100) {
        EXPECT_LT(opacity_after(milliseconds(ms)), before);
        before = opacity_after(milliseconds(ms));
    }
    EXPECT_GT(opacity_after(std::chrono::hours(1)), 0.2)
        << "a person must stay visible while the site exists";
}

TEST(PeopleView, DrawsWhomTheUserWantsToSeeButNotTheOwnBody) {
    PeopleView people;
    EXPECT_TRUE(people.is_drawn("alice"));
    SiteSelection sites;
    sites.toggle("bob");
    people.show_only(sites, "alice");
    EXPECT_FALSE(people.is_drawn("alice")) << "the camera is in the head";
    EXPECT_FALSE(people.is_drawn("bob")) << "hidden";
    EXPECT_TRUE(people.is_drawn("carol"));
    people.show_only(sites, "");
    EXPECT_TRUE(people.is_drawn("alice"));
}

}  // namespace
}  // namespace atrium::viewer
