#include "tests/fuzz/hull_check.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

// Fuzzer inputs that reach code that no other input reaches, with any compiler.
namespace atrium::test {
namespace {

std::vector<std::filesystem::path> seed_files() {
    std::vector<std::filesystem::path> files;
    for (const auto& entry :
         std::filesystem::directory_iterator(atrium::test::source_dir() + "/tests/fuzz/seeds/hull"))
        files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(HullFuzzSeeds, GiveASoundMeshOrNone) {
    for (const std::filesystem::path& file : seed_files()) {
        const std::vector<std::uint8_t> bytes = bytes_of(file);
        ASSERT_FALSE(bytes.empty()) << file;
        EXPECT_EQ(check_hull(decode_hull_input(bytes)), "") << file;
    }
}

// Otherwise the seeds are outdated, and the test above checks nothing.
TEST(HullFuzzSeeds, ReachHullsAndRefusals) {
    std::map<hull::HullStatus, int> count;
    hull::HullScratch scratch;
    for (const std::filesystem::path& file : seed_files()) {
        const HullInput input = decode_hull_input(bytes_of(file));
        ++count[compute_visual_hull(input.views, input.options, scratch).status];
    }
    EXPECT_GE(count[hull::HullStatus::kOk], 10);
    EXPECT_GE(count[hull::HullStatus::kEmptyIntersection], 3);
    EXPECT_GE(count[hull::HullStatus::kInvalidInput], 3);
    EXPECT_GE(count[hull::HullStatus::kTooComplex], 3);
}

}  // namespace
}  // namespace atrium::test
