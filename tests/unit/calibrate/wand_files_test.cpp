// Files of wands and of light points.
#include "tools/calibrate/adjust/wand.hpp"
#include "tools/calibrate/wand/light_points.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WandFiles : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("atrium-wand-" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path write(const std::string& text) {
        std::ofstream(folder_ / "file") << text;
        return folder_ / "file";
    }
    fs::path folder_;
};

TEST_F(WandFiles, PointsReturnAsTheyWere) {
    const LightPoints points{{"north", {{0, 2, {1.25, 2.5}}, {7, std::nullopt, {0.0, 1023.125}}}},
                             {"east", {{7, 0, {3.0, 4.0}}}}};
    ASSERT_TRUE(save_light_points(points, folder_ / "points.csv"));
    const auto read = load_light_points(folder_ / "points.csv");
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->size(), 2U);
    for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_EQ((*read)[c].name, points[c].name);
        ASSERT_EQ((*read)[c].points.size(), points[c].points.size());
        for (std::size_t i = 0; i < points[c].points.size(); ++i) {
            EXPECT_EQ((*read)[c].points[i].instant, points[c].points[i].instant);
            EXPECT_EQ((*read)[c].points[i].light, points[c].points[i].light);
            EXPECT_EQ((*read)[c].points[i].px, points[c].points[i].px);
        }
    }
}

TEST_F(WandFiles, PointsMayHaveOtherColumnsAndLineEnds) {
    const auto read = load_light_points(write(
        "\xEF\xBB\xBFx_px, y_px, score, instant, camera\r\n1, 2, 0.5, 9, a\r\n\r\n3,4,1,8,a"));
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ((*read)[0].points.size(), 2U);
    EXPECT_EQ((*read)[0].points[0].instant, 8U) << "in order of time";
    EXPECT_EQ((*read)[0].points[0].px, Eigen::Vector2d(3, 4));
}

TEST_F(WandFiles, ErrorsOfPointsNameTheLine) {
    const std::string head = "camera,instant,light,x_px,y_px\n";
    const std::pair<std::string, const char*> cases[]{
        {"", "holds no points"},
        {head, "holds no points"},
        {"camera;instant;x_px;y_px\n", "it has semicolons"},
        {"camera,instant,x,y\n", "'x_px' is missing"},
        {head + "a,1,0,2,3\na,1,0,2,5,3\n", "file:3: has 6 fields; the first line names 5"},
        {head + "a,-1,0,2,3\n", "instant '-1' is not a whole number"},
        {head + "a,1.5,0,2,3\n", "instant '1.5'"},
        {head + "a,1,16,2,3\n", "light '16' is not a whole number of 0 to 15"},
        {head + "a,1,,nan,3\n", "x_px 'nan' is not a place"},
        {head + "a,1,,2,1e9\n", "y_px '1e9' is not a place"},
        {head + "a b,1,,2,3\n", "camera 'a b': a name has"},
    };
    for (const auto& [text, expected] : cases) {
        const auto read = load_light_points(write(text));
        ASSERT_FALSE(read) << text;
        EXPECT_THAT(read.error().message, HasSubstr(expected)) << text;
    }
    EXPECT_EQ(load_light_points(folder_ / "none").error().kind, ErrorKind::kNotFound);
}

TEST_F(WandFiles, WandsAreChecked) {
    const auto wand =
        load_wand(write("[[light]]\nposition_m = [0, 0, 0]\n"
                        "[[light]]\nposition_m = [0, 0.0002, 0.1]\n"
                        "[[light]]\nposition_m = [0, 0, 0.3]\n"));
    ASSERT_TRUE(wand) << wand.error().message;
    EXPECT_EQ(wand->form(), WandForm::kLine) << "within half a millimetre";
    EXPECT_NEAR(wand->length_m(), 0.3, 1e-12);
    const std::pair<const char*, const char*> cases[]{
        {"", "has 0 [[light]]; must have 1 to 16"},
        {"[[light]]\n", "position_m"},
        {"[[light]]\nposition_mm = [0, 0, 1]\n", "write position_m, in metres"},
        {"[[light]]\nposition_m = [0, 0, 300]\n", "file:2"},
        {"[[light]]\nposition_m = [0, 0, 0]\n[[light]]\nposition_m = [0, 0, 0.005]\n",
         "must be at least 1 cm from light 0"},
        {"[[light]]\nposition_m = [0, 0, -4]\n[[light]]\nposition_m = [0, 0, 4]\n",
         "its lights are 8.00 m apart"},
        {"[[lights]]\nposition_m = [0, 0, 0]\n", "did you mean light"},
    };
    for (const auto& [text, expected] : cases) {
        const auto read = load_wand(write(text));
        ASSERT_FALSE(read) << text;
        EXPECT_THAT(read.error().message, HasSubstr(expected)) << text;
    }
}

}  // namespace
}  // namespace atrium::calibrate
