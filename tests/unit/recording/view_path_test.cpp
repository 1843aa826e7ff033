#include "core/recording/view_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace atrium::recording {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

class ViewPathFile : public ::testing::Test {
protected:
    void TearDown() override { std::filesystem::remove(file_); }
    Error error_of(const std::string& text) {
        std::ofstream(file_) << text;
        const auto path = ViewPath::load(file_);
        EXPECT_FALSE(path) << text;
        return path ? Error{} : path.error();
    }
    const std::filesystem::path file_ = std::filesystem::temp_directory_path() /
                                        ("view_path_" + std::to_string(getpid()) + ".json");
};

TEST_F(ViewPathFile, ComesBackAsItWas) {
    std::mt19937 random(22);
    std::uniform_real_distribution<double> place(-5.0, 5.0);
    ViewPath path;
    for (int i = 0; i < 20; ++i) {
        path.add({milliseconds(1000 * i),
                  {place(random), place(random), 2.0},
                  {place(random), place(random), 1.0},
                  30.0 + i});
    }
    ASSERT_TRUE(path.save(file_));
    const auto loaded = ViewPath::load(file_);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_EQ(loaded->keys().size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) {
        EXPECT_EQ(loaded->keys()[i].time, path.keys()[i].time);
        EXPECT_EQ(loaded->keys()[i].position_m, path.keys()[i].position_m);
        EXPECT_EQ(loaded->keys()[i].target_m, path.keys()[i].target_m);
        EXPECT_EQ(loaded->keys()[i].fov_deg, path.keys()[i].fov_deg);
    }
}

TEST(ViewPath, LeadsThroughItsKeysAndStandsStillOutside) {
    ViewPath path;
    path.add({milliseconds(3000), {3.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, 60.0});
    path.add({milliseconds(1000), {1.0, -2.0, 1.0}, {0.0, 0.0, 1.0}, 40.0});
    path.add({milliseconds(2000), {2.0, -1.0, 1.5}, {0.0, 0.0, 1.0}, 50.0});
    for (const ViewKey& key : path.keys()) {
        EXPECT_LT((path.at(key.time).position_m - key.position_m).norm(), 1e-9);
        EXPECT_NEAR(path.at(key.time).fov_deg, key.fov_deg, 1e-9);
    }
    EXPECT_EQ(path.at(milliseconds(0)).position_m, path.keys().front().position_m);
    EXPECT_EQ(path.at(milliseconds(9000)).position_m, path.keys().back().position_m);
    EXPECT_EQ(path.number_at(milliseconds(2500)), 2u);
}

// Between two keys alone the way is straight, and no speed jumps at a key.
TEST(ViewPath, MovesSmoothly) {
    ViewPath two;
    two.add({milliseconds(0), {0.0, 0.0, 1.0}, {0.0, 5.0, 1.0}, 40.0});
    two.add({milliseconds(2000), {4.0, 0.0, 1.0}, {4.0, 5.0, 1.0}, 40.0});
    EXPECT_NEAR(two.at(milliseconds(500)).position_m.x(), 1.0, 1e-9);
    ViewPath path;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-3.0, 3.0);
    for (int i = 0; i < 8; ++i)
        path.add({milliseconds(700 * i + 40 * i * i),
                  {place(random), place(random), 1.0},
                  {0, 0, 9},
                  40});
    for (std::size_t i = 1; i + 1 < path.keys().size(); ++i) {
        const auto time = path.keys()[i].time;
        constexpr milliseconds kStep{1};
        const Eigen::Vector3d before = path.at(time).position_m - path.at(time - kStep).position_m;
        const Eigen::Vector3d behind = path.at(time + kStep).position_m - path.at(time).position_m;
        EXPECT_LT((before - behind).norm(), 1e-4) << i;
    }
}

TEST(ViewPath, ReplacesAKeyOfTheSameTime) {
    ViewPath path;
    path.add({milliseconds(1000), {1.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, 40.0});
    path.add({milliseconds(1004), {2.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, 40.0});
    ASSERT_EQ(path.keys().size(), 1u);
    EXPECT_EQ(path.keys()[0].position_m.x(), 2.0);
}

TEST_F(ViewPathFile, SaysWhatIsWrong) {
    EXPECT_THAT(error_of("").message, HasSubstr("is JSON with"));
    EXPECT_THAT(error_of("{\"keys\": []}").message, HasSubstr("there is none"));
    EXPECT_THAT(error_of(R"({"keys": [{"time_s": -1}]})").message, HasSubstr("keys[0].time_s"));
    const std::string good =
        R"({"time_s": 1, "position_m": [1, 2, 3], "target_m": [0, 0, 1], "fov_deg": 40})";
    EXPECT_THAT(error_of(R"({"keys": [)" + good + "," + good + "]}").message,
                HasSubstr("keys[1].time_s: must be later"));
    EXPECT_THAT(
        error_of(R"({"keys": [{"time_s": 1, "position_m": [1, 2], "target_m": [0, 0, 1]}]})")
            .message,
        HasSubstr("position_m"));
    EXPECT_THAT(
        error_of(R"({"keys": [{"time_s": 1, "position_m": [0, 0, 1], "target_m": [0, 0, 1]}]})")
            .message,
        HasSubstr("must differ"));
    EXPECT_THAT(
        error_of(
            R"({"keys": [{"time_s": 1, "position_m": [0, 0, 2], "target_m": [0, 0, 1], "fov_deg": 0}]})")
            .message,
        HasSubstr("fov_deg"));
    EXPECT_EQ(ViewPath::load("/nonexistent/path.json").error().kind, ErrorKind::kNotFound);
}

}  // namespace
}  // namespace atrium::recording
