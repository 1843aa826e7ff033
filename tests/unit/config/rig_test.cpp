#include "core/config/rig.hpp"

#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace atrium::config {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kCamera = R"(width = 640
height = 480
fx = 500
fy = 500
cx = 319.5
cy = 239.5
rotation = [0, 1, 0, 0, 0, -1, -1, 0, 0]
translation = [0, 1, 3]
)";

std::string camera(const std::string& name) {
    return "[[camera]]\nname = \"" + name + "\"\n" + kCamera;
}

Expected<Rig> load(const std::string& text) {
    const auto file = std::filesystem::path(testing::TempDir()) / "rig_under_test.toml";
    std::ofstream(file) << text;
    return load_rig(file);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
    return text;
}

TEST(LoadRig, ReadsCamerasRateAndBounds) {
    const auto rig = load("units = \"m\"\nrate_hz = 25\n" + camera("a") + camera("b") +
                          "[bounds]\nmin = [-1, -1, 0]\nmax = [1, 1, 2]\n");
    ASSERT_TRUE(rig) << rig.error().message;
    EXPECT_EQ(rig->rate_hz, 25);
    ASSERT_EQ(rig->cameras.size(), 2u);
    EXPECT_EQ(rig->cameras[1].name, "b");
    EXPECT_EQ(rig->bounds_site.max.z(), 2);
    // the camera looks along -x of the site from x = 3, z = 1
    EXPECT_LT((rig->cameras[0].centre_site() - Eigen::Vector3d(3, 0, 1)).norm(), 1e-9);
}

TEST(LoadRig, ConvertsItsUnitsToMetres) {
    const auto metres = load(camera("a") + camera("b"));
    ASSERT_TRUE(metres) << metres.error().message;
    EXPECT_FALSE(metres->has_bounds);
    const auto in_mm = [](std::string text) {
        return replaced(std::move(text), "[0, 1, 3]", "[0, 1000, 3000]");
    };
    const auto rig = load("units = \"mm\"\n" + in_mm(camera("a")) + in_mm(camera("b")) +
                          "[bounds]\nmin = [-1000, -1000, 0]\nmax = [1000, 1000, 2000]\n");
    ASSERT_TRUE(rig) << rig.error().message;
    EXPECT_EQ(rig->unit_m, 0.001);
    EXPECT_TRUE(rig->has_bounds);
    EXPECT_LT((rig->bounds_site.max - Eigen::Vector3d(1, 1, 2)).norm(), 1e-12);
    EXPECT_LT((rig->cameras[0].centre_site() - metres->cameras[0].centre_site()).norm(), 1e-12);
    const auto too_far = load(camera("a") + replaced(camera("b"), "[0, 1, 3]", "[0, 1, 30000]"));
    ASSERT_FALSE(too_far);
    EXPECT_THAT(too_far.error().message,
                AllOf(HasSubstr("camera[1].translation"), HasSubstr("units = \"mm\"")));
}

TEST(LoadRig, NamesTheCameraWithASingularMatrix) {
    const auto rig = load(camera("good") + replaced(camera("bad"),
                                                    "[0, 1, 0, 0, 0, -1, -1, 0, 0]",
                                                    "[0, 1, 0, 0, 1, 0, 0, 1, 0]"));
    ASSERT_FALSE(rig);
    EXPECT_THAT(
        rig.error().message,
        AllOf(HasSubstr("camera[1].rotation"), HasSubstr("'bad'"), HasSubstr("rotation matrix")));
}

TEST(LoadRig, SaysHowToImportWhatOtherToolsWrote) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path(testing::TempDir()) / "pictures_of_another_tool";
    fs::create_directories(folder / "cam1");
    const std::string import = "calibrate import CALIBRATION --recording '" + folder.string() + "'";
    EXPECT_THAT(load_rig(folder).error().message,
                AllOf(HasSubstr("no rig.toml"), HasSubstr(import)));
    std::ofstream(folder / "extri.yml") << "%YAML:1.0\n";
    EXPECT_THAT(load_rig(folder / "extri.yml").error().message,
                HasSubstr("`calibrate import '" + (folder / "extri.yml").string()));
}

TEST(LoadRig, RefusesMirroredRotations) {
    EXPECT_FALSE(load(camera("a") + replaced(camera("b"), "[0, 1, 0,", "[0, -1, 0,")));
}

TEST(LoadRig, RefusesImpossibleCameras) {
    const std::string good = camera("a");
    for (const auto& [from, to] : {std::pair<std::string, std::string>{"fx = 500", "fx = 0"},
                                   {"width = 640", "width = -1"},
                                   {"width = 640", "width = 640.5"},
                                   {"cx = 319.5", "cx = nan"},
                                   {"translation = [0, 1, 3]", "translation = [0, 1]"},
                                   {"translation = [0, 1, 3]", ""},
                                   {"name = \"a\"", "name = \"a/b\""},
                                   {"name = \"a\"", "name = \"b\""}}) {
        EXPECT_FALSE(load(camera("b") + replaced(good, from, to))) << to;
    }
    EXPECT_FALSE(load(camera("only_one")));
    EXPECT_FALSE(load("units = \"km\"\n" + camera("a") + camera("b")));
}

TEST(LoadRig, ReportsAMissingFile) {
    const auto rig = load_rig("/nonexistent/recording");
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().kind, ErrorKind::kNotFound);
    EXPECT_THAT(rig.error().message, HasSubstr("/nonexistent/recording"));
}

TEST(LoadRig, ReadsTheRealRecordings) {
    const std::filesystem::path recordings =
        atrium::test::source_dir() + "/../shared/data/recordings";
    if (!std::filesystem::exists(recordings))
        GTEST_SKIP() << atrium::test::skip::kNoSharedData << recordings;
    for (const char* name : {"ring20", "dancer", "horseman", "fourpersons_a"}) {
        const auto rig = load_rig(recordings / name);
        EXPECT_TRUE(rig) << rig.error().message;
    }
}

TEST(Rig, FingerprintDiffersWithEveryNumberAndName) {
    const std::string text = camera("a") + camera("b");
    const auto rig = load(text);
    ASSERT_TRUE(rig) << rig.error().message;
    EXPECT_EQ(fingerprint(*load(text)), fingerprint(*rig));
    EXPECT_EQ(fingerprint(*load("rate_hz = 12\n" + text)), fingerprint(*rig));
    for (const auto& [from, to] :
         {std::pair("\"b\"", "\"c\""),
          std::pair("width = 640", "width = 642"),
          std::pair("height = 480", "height = 482"),
          std::pair("fx = 500", "fx = 500.01"),
          std::pair("fy = 500", "fy = 500.01"),
          std::pair("cx = 319.5", "cx = 319.6"),
          std::pair("cy = 239.5", "cy = 239.6"),
          std::pair("[0, 1, 3]", "[0, 1, 3.0001]"),
          std::pair("fx = 500", "distortion = [0.001, 0, 0, 0, 0]\nfx = 500"),
          std::pair("[0, 1, 0, 0, 0, -1, -1, 0, 0]", "[0, 1, 0, 0, 0, 1, 1, 0, 0]")}) {
        const auto other = load(replaced(text, from, to));
        ASSERT_TRUE(other) << other.error().message;
        EXPECT_NE(fingerprint(*other), fingerprint(*rig)) << to;
    }
}

}  // namespace
}  // namespace atrium::config
