#include "tests/fuzz/file_check.hpp"
#include "tests/fuzz/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>

// Fuzzer inputs that reach code that no other input reaches, with any compiler.
namespace atrium::test {
namespace {

TEST(FileFuzzSeeds, KeepTheRigReadersPromises) { replay("file_rig", check_rig_bytes, 1, 3); }
TEST(FileFuzzSeeds, KeepTheViewsReadersPromises) { replay("file_views", check_views_bytes, 1, 3); }
TEST(FileFuzzSeeds, KeepTheProfileReadersPromises) {
    replay("file_profiles", check_profiles_bytes, 1, 3);
}
TEST(FileFuzzSeeds, KeepTheBackgroundReadersPromises) {
    replay("file_background", check_background_bytes, 1, 3);
}
TEST(FileFuzzSeeds, KeepTheRawPictureReadersPromises) { replay("file_raw", check_raw_bytes, 3, 3); }
TEST(FileFuzzSeeds, KeepTheRecordingReadersPromises) {
    replay("file_recording", check_recording_bytes, 1, 3);
}
TEST(FileFuzzSeeds, KeepTheBundleReadersPromises) {
    replay("file_bundle", check_bundle_bytes, 3, 3);
}

}  // namespace
}  // namespace atrium::test
