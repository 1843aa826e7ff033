#include "tests/support/skips.hpp"

#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace atrium::test::skip {
namespace {

TEST(Skip, IsAllowedForAListedReasonOnly) {
    EXPECT_TRUE(is_allowed(std::string(kNoNetwork) + "/dev/net/tun: not permitted"));
    EXPECT_TRUE(is_allowed(kNoCgal));
    EXPECT_FALSE(is_allowed("the machine was too busy"));
    EXPECT_FALSE(is_allowed(""));
}

TEST(Skip, IsRefusedForMissingDataWhenTheDataIsThere) {
    const bool is_there = std::filesystem::exists(atrium::test::source_dir() + "/../shared/data");
    EXPECT_EQ(is_allowed(std::string(kNoSharedData) + "a wrong path"), !is_there);
}

}  // namespace
}  // namespace atrium::test::skip
