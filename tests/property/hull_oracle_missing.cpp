#include <gtest/gtest.h>

namespace {

TEST(ExactIntersection, IsTheHull) {
    GTEST_SKIP() << "CGAL (libcgal-dev) was not found when this was configured";
}

}  // namespace
