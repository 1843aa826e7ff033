#include "viewer/receive/empty_world_warning.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;

const EmptyWorldWarning::Clock::time_point kEmptySince{100s};
const std::string kPlace = "world=atrium";

TEST(EmptyWorldWarning, WarnsOnceIfNobodyCame) {
    bus::Presence viewer;
    viewer.kind = bus::ProgramKind::kViewer;
    EmptyWorldWarning empty_world;
    EXPECT_FALSE(empty_world.update({viewer}, kPlace, kEmptySince, false));
    EXPECT_FALSE(empty_world.update(
        {viewer}, kPlace, kEmptySince + EmptyWorldWarning::kPatience - 1ms, false));
    EXPECT_TRUE(
        empty_world.update({viewer}, kPlace, kEmptySince + EmptyWorldWarning::kPatience, false));
    EXPECT_FALSE(empty_world.update({viewer}, kPlace, kEmptySince + 60s, true)) << "once";
    EXPECT_FALSE(empty_world.has_met_others()) << "such a world is not worth remembering";

    EmptyWorldWarning short_run;
    EXPECT_TRUE(short_run.update({viewer}, kPlace, kEmptySince, true));

    EmptyWorldWarning in_company;
    bus::Presence site;
    site.kind = bus::ProgramKind::kSiteNode;
    EXPECT_FALSE(in_company.update({viewer, site}, kPlace, kEmptySince, false));
    EXPECT_FALSE(in_company.update({viewer}, kPlace, kEmptySince + 60s, true))
        << "people may leave again";
    EXPECT_TRUE(in_company.has_met_others());
}

}  // namespace
}  // namespace atrium::viewer
