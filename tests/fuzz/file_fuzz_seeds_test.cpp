#include "tests/fuzz/file_check.hpp"
#include "tests/fuzz/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>

// Inputs that a fuzzer found to reach code that no other input reaches, with any compiler.
namespace atrium::test {
namespace {

TEST(FileFuzzSeeds, Rigs) { replay("file_rig", check_rig_bytes, 1, 3); }
TEST(FileFuzzSeeds, Views) { replay("file_views", check_views_bytes, 1, 3); }
TEST(FileFuzzSeeds, Profiles) { replay("file_profiles", check_profiles_bytes, 1, 3); }
TEST(FileFuzzSeeds, Backgrounds) { replay("file_background", check_background_bytes, 1, 3); }

}  // namespace
}  // namespace atrium::test
