#include "tools/plan/costs.hpp"

#include "tests/unit/plan/a_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium::plan {
namespace {

constexpr const char* kGood = R"([machine]
name = "test"
score = 120.5
measured = "today"
[picture]
silhouette_ms = [0.1, 0.2]
texture_ms = [0.3, 0.4]
texture_bytes = [500, 600]
segments = [7, 8]
[hull]
us_per_segment = 0.25
power = 1.5
two_threads = 1.6
[mesh]
triangles_per_segment = 4
ms_per_ktriangle = 0.5
bytes_per_triangle = 1.5
[message]
ms = [0.2, 0.05]
)";

class CostsFile : public ::testing::Test {
protected:
    Expected<Costs> load(const std::string& text) {
        std::ofstream(file_) << text;
        return load_costs(file_);
    }
    void TearDown() override { std::filesystem::remove(file_); }
    std::filesystem::path file_ = std::filesystem::path(::testing::TempDir()) /
                                  ("costs_" + std::to_string(getpid()) + ".toml");
};

TEST_F(CostsFile, IsRead) {
    const auto costs = load(kGood);
    ASSERT_TRUE(costs) << costs.error().message;
    EXPECT_DOUBLE_EQ(costs->score, 120.5);
    EXPECT_DOUBLE_EQ(costs->silhouette_ms.of(2.0), 0.5);
    EXPECT_DOUBLE_EQ(costs->texture_bytes.of(1.0), 1100.0);
    EXPECT_DOUBLE_EQ(costs->message_ms.of(1.0), 0.25);
}

TEST_F(CostsFile, NamesWhatIsMissing) {
    std::string text = kGood;
    text.erase(text.find("power"), std::string("power = 1.5\n").size());
    EXPECT_THAT(load(text).error().message, ::testing::HasSubstr("power"));
    EXPECT_THAT(load_costs("/nowhere/costs.toml").error().message,
                ::testing::HasSubstr("/nowhere/costs.toml"));
}

TEST(Costs, TheHullFollowsAmdahl) {
    Costs costs = testing::round_costs();
    EXPECT_NEAR(costs.hull_ms(16, 1000, 1), 8.0, 1e-9);
    EXPECT_NEAR(costs.hull_ms(16, 1000, 4), 2.0, 1e-9);
    costs.hull_two_threads = 1.6;  // a quarter is serial
    EXPECT_NEAR(costs.hull_ms(16, 1000, 2), 8.0 / 1.6, 1e-9);
    EXPECT_NEAR(costs.hull_ms(16, 1000, 4), 8.0 * (0.25 + 0.75 / 4), 1e-9);
}

}  // namespace
}  // namespace atrium::plan
