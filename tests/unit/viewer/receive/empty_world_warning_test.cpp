#include "viewer/receive/empty_world_warning.hpp"

#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;

const EmptyWorldWarning::Clock::time_point kEmptySince{100s};

TEST(EmptyWorldWarning, WarnsOnceIfNobodyCame) {
    bus::Presence viewer;
    viewer.kind = bus::ProgramKind::kViewer;
    EmptyWorldWarning empty_world("atrium");
    EXPECT_FALSE(empty_world.update({viewer}, kEmptySince, false));
    EXPECT_FALSE(
        empty_world.update({viewer}, kEmptySince + EmptyWorldWarning::kPatience - 1ms, false));
    EXPECT_TRUE(empty_world.update({viewer}, kEmptySince + EmptyWorldWarning::kPatience, false));
    EXPECT_FALSE(empty_world.update({viewer}, kEmptySince + 60s, true)) << "once";

    EmptyWorldWarning short_run("atrium");
    EXPECT_TRUE(short_run.update({viewer}, kEmptySince, true));

    EmptyWorldWarning in_company("atrium");
    bus::Presence site;
    site.kind = bus::ProgramKind::kSiteNode;
    EXPECT_FALSE(in_company.update({viewer, site}, kEmptySince, false));
    EXPECT_FALSE(in_company.update({viewer}, kEmptySince + 60s, true)) << "people may leave again";
}

}  // namespace
}  // namespace atrium::viewer
