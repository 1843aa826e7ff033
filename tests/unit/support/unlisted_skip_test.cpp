#include <gtest/gtest.h>

namespace {

TEST(Skip, FailsWithoutAListedReason) { GTEST_SKIP() << "the machine was too busy"; }

}  // namespace
