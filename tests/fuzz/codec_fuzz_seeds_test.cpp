#include "tests/fuzz/codec_check.hpp"
#include "tests/fuzz/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>

// Fuzzer inputs that reach code that no other input reaches, with any compiler.
namespace atrium::test {
namespace {

TEST(CodecFuzzSeeds, KeepTheMeshDecodersPromises) { replay("codec_mesh", check_mesh_bytes, 3, 10); }
TEST(CodecFuzzSeeds, KeepTheMaskDecodersPromises) { replay("codec_mask", check_mask_bytes, 3, 3); }
TEST(CodecFuzzSeeds, KeepTheTextureDecodersPromises) {
    replay("codec_texture", check_texture_bytes, 3, 10);
}

}  // namespace
}  // namespace atrium::test
