#include "tests/support/skips.hpp"

#include <gtest/gtest.h>

namespace {

TEST(ExactIntersection, EqualsTheHull) { GTEST_SKIP() << atrium::test::skip::kNoCgal; }

}  // namespace
