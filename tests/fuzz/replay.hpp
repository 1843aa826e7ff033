#pragma once

#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace atrium::test {

/// Runs `check(bytes, was_accepted)`, which returns the violation, on all files of seeds/`name`.
/// Expects minimum numbers of accepted and refused inputs. With fewer the seeds are outdated.
template <typename Check>
void replay(const std::string& name, const Check& check, int least_accepted, int least_refused) {
    int num_accepted = 0;
    int num_refused = 0;
    const std::filesystem::path folder = atrium::test::source_dir() + "/tests/fuzz/seeds/" + name;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
        bool was_accepted = false;
        EXPECT_EQ(check(bytes, was_accepted), "") << entry.path();
        ++(was_accepted ? num_accepted : num_refused);
    }
    EXPECT_GE(num_accepted, least_accepted);
    EXPECT_GE(num_refused, least_refused);
}

}  // namespace atrium::test
