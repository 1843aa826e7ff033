#include "world_server/site_register.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace atrium::world_server {
namespace {

const NamedPlacement kAlice{
    "alice",
    {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ())), {2, 0, 0}}};

TEST(SiteRegister, PlacesASiteOnArrival) {
    SiteRegister sites({kAlice}, 4);
    const auto placement = sites.arrive("alice");
    ASSERT_TRUE(placement && *placement);
    EXPECT_EQ((*placement)->world_from_site.translation, kAlice.world_from_site.translation);
    EXPECT_FALSE(sites.arrive("alice").value().has_value()) << "the site is already present";
}

TEST(SiteRegister, AsksForTheNameThatTheWorldFileMayMean) {
    NamedPlacement upper = kAlice;
    upper.site = "Alice";
    SiteRegister sites({upper}, 4);
    EXPECT_EQ(sites.ask_meant("alice"), "did you mean Alice?");
    EXPECT_EQ(sites.ask_meant("ALICE"), "did you mean Alice?");
    EXPECT_EQ(sites.ask_meant("alise"), "did you mean Alice?");
    EXPECT_EQ(sites.ask_meant("Alice"), "") << "named";
    EXPECT_EQ(sites.ask_meant("bob"), "");
    ASSERT_TRUE(sites.arrive("Alice"));
    EXPECT_EQ(sites.ask_meant("alice"), "") << "Alice is another site, which is present";
}

TEST(SiteRegister, PlacesUnnamedSitesOnARingAndKeepsThem) {
    SiteRegister sites({kAlice}, 3);
    const auto first = sites.arrive("x");
    const auto second = sites.arrive("y");
    ASSERT_TRUE(first && *first && second && *second);
    for (const auto& placement : {**first, **second}) {
        EXPECT_NEAR(placement.world_from_site.translation.norm(), 1.8, 1e-9);
        const Eigen::Vector3d ahead = placement.world_from_site * Eigen::Vector3d(1.8, 0, 0);
        EXPECT_LT(ahead.norm(), 1e-9) << "the site must face the centre";
    }
    EXPECT_GT(
        ((*first)->world_from_site.translation - (*second)->world_from_site.translation).norm(),
        3.0);
    const auto third = sites.arrive("z");
    ASSERT_FALSE(third);
    EXPECT_EQ(third.error().kind, ErrorKind::kUnavailable);
    EXPECT_TRUE(sites.arrive("alice")) << "a named site must always have room";

    sites.leave("x");
    EXPECT_EQ(sites.num_present(), 2U);
    const auto again = sites.arrive("x");
    ASSERT_TRUE(again && *again);
    EXPECT_EQ((*again)->world_from_site.translation, (*first)->world_from_site.translation);
}

}  // namespace
}  // namespace atrium::world_server
