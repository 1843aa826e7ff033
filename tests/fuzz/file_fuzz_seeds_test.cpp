#include "tests/fuzz/file_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

// Inputs that a fuzzer found to reach code that no other input reaches, with any compiler.
namespace atrium::test {
namespace {

using Check = std::string (*)(std::span<const std::uint8_t>, bool&);

void replay(const std::string& name, Check check, int least_accepted, int least_refused) {
    int num_accepted = 0;
    int num_refused = 0;
    const std::filesystem::path folder = ATRIUM_SOURCE_DIR "/tests/fuzz/seeds/" + name;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
        bool was_accepted = false;
        EXPECT_EQ(check(bytes, was_accepted), "") << entry.path();
        ++(was_accepted ? num_accepted : num_refused);
    }
    // else the inputs have lost their meaning
    EXPECT_GE(num_accepted, least_accepted);
    EXPECT_GE(num_refused, least_refused);
}

TEST(FileFuzzSeeds, Rigs) { replay("file_rig", check_rig_bytes, 1, 3); }
TEST(FileFuzzSeeds, Views) { replay("file_views", check_views_bytes, 1, 3); }
TEST(FileFuzzSeeds, Profiles) { replay("file_profiles", check_profiles_bytes, 1, 3); }
TEST(FileFuzzSeeds, Backgrounds) { replay("file_background", check_background_bytes, 1, 3); }

}  // namespace
}  // namespace atrium::test
