#include "site_node/rig_check/length_mistakes.hpp"

#include "site_node/rig_check/hull_size.hpp"
#include "tests/support/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace atrium::rig_check {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kRooms = 400;

// What somebody did wrong with the lengths of a rig, and the cure that must be named.
struct Wrong {
    const char* what;
    double read_per_true;  // how many times too large the lengths are
    double unit_m;         // of the key `units`
    const char* cure;
};

// Widths from a small room to a hall, most of them near 5 m.
double random_width_m(test::Random& random) {
    double exponent = 0.0;
    for (int i = 0; i < 3; ++i) exponent += test::between(random, -0.5, 0.5);
    return 5.0 * std::exp(exponent);
}

// In which share of rooms the cure is named first, and among those that are told.
struct Hits {
    double first = 0.0;
    double told = 0.0;
};
Hits hits_of(const Wrong& wrong) {
    Hits hits;
    for (int seed = 0; seed < kRooms; ++seed) {
        test::Random random(static_cast<std::uint64_t>(seed));
        const double read_m = random_width_m(random) * wrong.read_per_true;
        const auto mistakes = likely_length_mistakes(read_m, kRoomWidth, wrong.unit_m);
        if (mistakes.empty()) continue;
        hits.first +=
            mistakes.front().cure.find(wrong.cure) != std::string::npos ? 1.0 / kRooms : 0.0;
        const std::string text = explain(mistakes, kRoomWidth);
        hits.told += text.find(wrong.cure) != std::string::npos ? 1.0 / kRooms : 0.0;
    }
    return hits;
}

TEST(LengthMistakes, NamesTheCommonMistakesFirst) {
    for (const Wrong& wrong : {Wrong{"mm taken for m", 1000.0, 1.0, "\"mm\""},
                               Wrong{"cm taken for m", 100.0, 1.0, "\"cm\""},
                               Wrong{"mm imported as cm", 10.0, 1.0, "--units mm"},
                               Wrong{"m imported as mm", 1e-3, 1.0, "--units m"},
                               Wrong{"mm with the key cm", 10.0, 0.01, "\"mm\""},
                               Wrong{"cm with the key mm", 0.1, 0.001, "\"cm\""},
                               Wrong{"m with the key mm", 0.001, 0.001, "\"m\""}}) {
        const Hits hits = hits_of(wrong);
        EXPECT_GT(hits.first, 0.9) << wrong.what;
        EXPECT_GT(hits.told, 0.99) << wrong.what;
    }
}

// Rare units are told beside the likelier one.
TEST(LengthMistakes, NamesInchesAndFeetToo) {
    for (const Wrong& wrong : {Wrong{"inches taken for m", 1.0 / 0.0254, 1.0, "\"in\""},
                               Wrong{"inches with the key mm", 1e-3 / 0.0254, 0.001, "\"in\""}}) {
        EXPECT_GT(hits_of(wrong).told, 0.9) << wrong.what;
    }
}

// Lengths in mm that were imported as cm: the site named inches or feet.
TEST(LengthMistakes, FindsMillimetresImportedAsCentimetres) {
    const std::string room = explain(likely_length_mistakes(36.2, kRoomWidth, 1.0), kRoomWidth);
    EXPECT_THAT(room, HasSubstr("millimetres look taken for centimetres (3.62 m"));
    EXPECT_THAT(room, Not(HasSubstr("taken for inches"))) << "the cure is the same";
    const auto person = check_size({{-4.0, -3.0, 0.0}, {4.0, 3.0, 17.1}}, 70.0, 0.95);
    ASSERT_TRUE(person);
    EXPECT_THAT(*person, HasSubstr("millimetres look taken for centimetres (1.71 m tall"));
    EXPECT_THAT(*person, HasSubstr("--units mm"));
}

TEST(LengthMistakes, SaysNothingWhereNoUnitMakesARoom) {
    EXPECT_TRUE(likely_length_mistakes(1e9, kRoomWidth, 1.0).empty());
    EXPECT_EQ(explain({}, kRoomWidth), "");
}

}  // namespace
}  // namespace atrium::rig_check
