#include "tests/fuzz/replay.hpp"
#include "tests/fuzz/wire_check.hpp"
#include "tests/support/sanitized.hpp"

#include <gtest/gtest.h>

// Samples of every topic as they come from the network: good ones, damaged ones, and fuzzer inputs
// that reach code that no other input reaches.
namespace atrium::test {
namespace {

class EveryTopic : public ::testing::TestWithParam<WireCheck> {};
INSTANTIATE_TEST_SUITE_P(WireFuzzSeeds,
                         EveryTopic,
                         ::testing::ValuesIn(wire_checks().begin(), wire_checks().end()),
                         [](const auto& topic) { return std::string(topic.param.topic); });

TEST_P(EveryTopic, AcceptsItsSamples) {
    const auto samples = GetParam().samples();
    ASSERT_FALSE(samples.empty());
    for (const Bytes& bytes : samples) {
        bool was_accepted = false;
        EXPECT_EQ(GetParam().check(bytes, was_accepted), "");
        EXPECT_TRUE(was_accepted) << "of " << bytes.size() << " bytes, the first "
                                  << static_cast<int>(bytes.front());
    }
}

TEST_P(EveryTopic, SurvivesEveryTruncation) {
    for (const Bytes& bytes : GetParam().samples()) {
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            bool was_accepted = false;
            ASSERT_EQ(GetParam().check({bytes.data(), size}, was_accepted), "") << size;
        }
    }
}

TEST_P(EveryTopic, SurvivesEveryChangedByte) {
    int num_refused = 0;
    for (Bytes bytes : GetParam().samples()) {
        for (std::size_t i = 1; i < bytes.size(); ++i) {
            for (const std::uint8_t change : {0x01, 0x80, 0xff}) {
                if (kSanitized && change != 0xff && i % 4 != 0) continue;
                bytes[i] ^= change;
                bool was_accepted = false;
                ASSERT_EQ(GetParam().check(bytes, was_accepted), "") << "byte " << i;
                num_refused += was_accepted ? 0 : 1;
                bytes[i] ^= change;
            }
        }
    }
    EXPECT_GT(num_refused, 0);
}

TEST_P(EveryTopic, SurvivesFuzzerInputs) {
    replay("wire_" + std::string(GetParam().topic), GetParam().check, 2, 2);
}

}  // namespace
}  // namespace atrium::test
