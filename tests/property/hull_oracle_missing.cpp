#include <gtest/gtest.h>

namespace {

TEST(ExactIntersection, EqualsTheHull) {
    GTEST_SKIP() << "CGAL (libcgal-dev) was not found when this was configured";
}

}  // namespace
