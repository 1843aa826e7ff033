// Numbers that cannot be read: the message names file, camera and value, and no camera is dropped.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/formats/format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::calibrate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kTwoOfOne = "a decimal comma makes two numbers of one";

class UnreadableNumbers : public testing::Test {
protected:
    std::string error_of(const std::string& name, const std::string& text) const {
        const auto rig = read_foreign({folder_.write(name, text)}, "auto");
        return rig ? "no error" : rig.error().message;
    }
    // With a comma for the first decimal point behind `places`, one after the other.
    static std::string with_comma(std::string text, const std::vector<std::string>& places) {
        std::size_t at = 0;
        for (const std::string& place : places) {
            at = text.find(place, at);
            EXPECT_NE(at, std::string::npos) << place;
            at += place.size();
        }
        text.at(text.find('.', at)) = ',';
        return text;
    }

    atrium::test::Random random_{77};
    test::Folder folder_;
    test::Cameras cameras_ = test::random_room(random_, 5);
};

TEST_F(UnreadableNumbers, AreNamedIfTheyHaveCommas) {
    std::string qualisys = test::qualisys_xml(cameras_);
    const std::size_t r11 = qualisys.find("r11=\"");
    const std::size_t point = qualisys.find('.', r11);
    const std::string good = qualisys.substr(r11 + 5, qualisys.find('"', r11 + 5) - r11 - 5);
    qualisys[point] = ',';
    std::string word = good;
    word[word.find('.')] = ',';
    EXPECT_THAT(error_of("a.qca.txt", qualisys),
                HasSubstr("camera 'cam1': <transform> r11: '" + word +
                          "' is not a number; decimals have a point"));
    std::string vicon = test::vicon_xcp(cameras_);
    vicon[vicon.find('.', vicon.find("POSITION=\""))] = ',';
    EXPECT_THAT(error_of("a.xcp", vicon),
                AllOf(HasSubstr("<KeyFrame> POSITION: '"), HasSubstr("decimals have a point")));
    // in an XML of OpenCV, and as a scalar
    std::string xml = test::opencv_xml(cameras_);
    xml[xml.find('.', xml.find("<data>"))] = ',';
    EXPECT_THAT(error_of("a.xml", xml), HasSubstr("decimals have a point"));
    EXPECT_THAT(error_of("a.yml",
                         "%YAML:1.0\n---\ncam1:\n   fx: 900,5\n   fy: 900.5\n   cx: 320.0\n"
                         "   cy: 240.0\ncam2:\n   fx: 900,5\n   fy: 1.0\n   cx: 1.0\n   cy: 1.0\n"),
                HasSubstr("'900,5' is not a number; decimals have a point"));
    // a list takes the comma for a separator
    EXPECT_THAT(error_of("b.yml",
                         "%YAML:1.0\n---\ncam1:\n   K: [ 900,5, 0,0, 320,0, 0,0, 900,5, 240,0, "
                         "0,0, 0,0, 1,0 ]\n"),
                HasSubstr("a decimal comma makes two numbers of one"));
    folder_.write("model/images.txt", test::colmap_images_txt(cameras_, 1.0));
    std::string colmap = test::colmap_cameras_txt(cameras_);
    colmap[colmap.find('.', colmap.find("OPENCV"))] = ',';
    folder_.write("model/cameras.txt", colmap);
    const auto model = read_foreign({folder_.path() / "model"}, "auto");
    ASSERT_FALSE(model);
    EXPECT_THAT(model.error().message,
                AllOf(HasSubstr("cameras.txt:"), HasSubstr("decimals have a point")));
}

// A camera for markers may have pictures, so its errors are told as well; it is not left out.
TEST_F(UnreadableNumbers, OfACameraForMarkersAreNamed) {
    std::string good = test::qualisys_xml(cameras_);
    good.replace(good.find("model=\"Miqus Video\""), 19, "model=\"Oqus 210c\"");
    const std::size_t x = good.find(" x=\"", good.find("Oqus 210c"));
    const std::size_t end = good.find('"', x + 4);
    const auto with_x = [&](const std::string& word) {
        return std::string(good).replace(x + 4, end - x - 4, word);
    };
    EXPECT_THAT(error_of("a.qca.xml", with_x("424,099058")),
                AllOf(HasSubstr("a.qca.xml: camera 'cam1': <transform> x: '424,099058' is not a "
                                "number; decimals have a point: 424.099058")));
    EXPECT_THAT(error_of("b.qca.xml", with_x("12.5mm")),
                HasSubstr("camera 'cam1': <transform> x: '12.5mm' is not a number; copy"));
    for (const char* unset : {"nan", "", "-1.#IND", "-nan(ind)"}) {
        const auto rig = read_foreign({folder_.write("c.qca.xml", with_x(unset))}, "auto");
        ASSERT_TRUE(rig) << rig.error().message;
        EXPECT_EQ(rig->cameras.size(), 4U);
        EXPECT_THAT(rig->left_out.at("cam1"), HasSubstr("<transform> lacks a number x"));
    }
}

// Four other cameras are whole, so a rig would remain without the one.
TEST_F(UnreadableNumbers, OfOneCameraOfJsonAreNamed) {
    const auto text = [](const char* k, const char* distortion) {
        std::string all = "{";
        for (const char* name : {"a", "b", "c"}) {
            const bool is_last = name[0] == 'c';
            all += std::string("\"") + name +
                   "\": {\"K\": " + (is_last ? k : "[900, 0, 320, 0, 900, 240, 0, 0, 1]") +
                   ", \"dist\": " + (is_last ? distortion : "[0, 0, 0, 0]") +
                   ", \"R\": [0, 0, 0], \"t\": [0, 0, 2]}" + (is_last ? "}" : ", ");
        }
        return all;
    };
    const char* good = "[900, 0, 320, 0, 900, 240, 0, 0, 1]";
    EXPECT_EQ(error_of("a.all", text(good, "[0, 0, 0, 0]")), "no error");
    EXPECT_THAT(error_of("b.all", text("\"900,5 0 320 0 900 240 0 0 1\"", "[0, 0, 0, 0]")),
                HasSubstr("b.all: c.K: '900,5' is not a number; decimals have a point: 900.5"));
    EXPECT_THAT(error_of("c.json", text("[900, 0, 320, 0, \"9oo\", 240, 0, 0, 1]", "[0]")),
                HasSubstr("c.json: c.K: '9oo' is not a number; write numbers without quotes"));
    EXPECT_THAT(error_of("d.json", text(good, "[-0,21, 0.05, 0.1, 0.1, 0.1]")),
                AllOf(HasSubstr("camera 'c': its distortion has 6 numbers"), HasSubstr(kTwoOfOne)));
    EXPECT_THAT(error_of("e.json", text("[900,5, 0, 320, 0, 900, 240, 0, 0, 1]", "[0]")),
                AllOf(HasSubstr("camera 'c': its camera matrix"), HasSubstr(kTwoOfOne)));
    EXPECT_THAT(error_of("f.json", R"({"a": {"fx": 900,5, "fy": 900}})"),
                HasSubstr("is it a decimal comma? decimals have a point"));
}

TEST_F(UnreadableNumbers, OfOneCameraOfOpenCvAreNamed) {
    // at the top of a file with several cameras, and a coefficient by name
    EXPECT_THAT(error_of("a.yml", "%YAML:1.0\n---\nK_01: \"900,5 0\"\nT_01: [1.0, 2.0, 3.0]\n"),
                HasSubstr("a.yml: K_01: '900,5' is not a number; decimals have a point"));
    EXPECT_THAT(
        error_of("b.json",
                 R"({"a": {"fx": 9, "fy": 9, "cx": 3, "cy": 3, "k1": "0,1", "model": "1,5"}})"),
        HasSubstr("b.json: a.k1: '0,1' is not a number"));
    const std::string yaml = test::opencv_yaml(cameras_, 1000.0);
    for (const char* key : {" T:", " R:", " camera_matrix:"}) {
        EXPECT_THAT(error_of("c.yml", with_comma(yaml, {"cam3:", key, "data"})),
                    AllOf(HasSubstr("c.yml: "), HasSubstr("a decimal comma")))
            << key;
    }
    EXPECT_THAT(error_of("d.yml",
                         "%YAML:1.0\n---\nK_1: [9.5, 0, 3, 0, 9.5, 2, 0, 0, 1]\nR_1: [0, 0, 0]\n"
                         "T_1: [1,5, 2, 3]\n"),
                AllOf(HasSubstr("camera '1': its pose must be"), HasSubstr(kTwoOfOne)));
    const std::string xml = test::opencv_xml(cameras_);
    for (const char* key : {"rvec", "tvec", "Distortion_Coefficients"}) {
        EXPECT_THAT(
            error_of("e.xml", with_comma(xml, {"<cam3>", key})),
            AllOf(HasSubstr("e.xml"), HasSubstr("' is not a number; decimals have a point")))
            << key;
    }
}

TEST_F(UnreadableNumbers, OfOneCameraOfViconAreNamed) {
    const std::string xcp = test::vicon_xcp(cameras_);
    for (const char* key : {"ORIENTATION=\"", "PRINCIPAL_POINT=\"", "VICON_RADIAL2=\""}) {
        EXPECT_THAT(error_of("a.xcp", with_comma(xcp, {"DEVICEID=\"cam3\"", key})),
                    AllOf(HasSubstr("camera 'cam3': <KeyFrame> "),
                          HasSubstr("' is not a number; decimals have a point: ")))
            << key;
    }
    std::string junk = xcp;
    junk.insert(junk.find("POSITION=\"", junk.find("cam3")) + 10, "x");
    EXPECT_THAT(error_of("b.xcp", junk), HasSubstr("camera 'cam3': <KeyFrame> POSITION: 'x"));
}

TEST_F(UnreadableNumbers, OfOneImageOfColmapAreNamed) {
    const std::string cameras = test::colmap_cameras_txt(cameras_);
    const std::string images = test::colmap_images_txt(cameras_, 1.0);
    const auto error = [&](const std::string& of_cameras, const std::string& of_images) {
        folder_.write("model/cameras.txt", of_cameras);
        folder_.write("model/images.txt", of_images);
        const auto rig = read_foreign({folder_.path() / "model"}, "auto");
        return rig ? "no error" : rig.error().message;
    };
    EXPECT_EQ(error(cameras, images), "no error");
    EXPECT_THAT(error(cameras, with_comma(images, {"\n3 "})),
                AllOf(HasSubstr("images.txt:6: '"), HasSubstr("decimals have a point: ")));
    EXPECT_THAT(error(with_comma(cameras, {"\n3 OPENCV"}), images),
                AllOf(HasSubstr("cameras.txt:4: '"), HasSubstr("decimals have a point: ")));
    std::string junk = cameras;
    junk.insert(junk.find('.', junk.find("\n3 OPENCV")), "x");
    EXPECT_THAT(error(junk, images),
                AllOf(HasSubstr("cameras.txt:4: '"), HasSubstr("not a number")));
}

TEST_F(UnreadableNumbers, OfOneCameraOfKalibrAreNamed) {
    const std::string yaml = test::kalibr_yaml(cameras_);
    for (const char* key : {"T_cn_cnm1", "distortion_coeffs", "intrinsics"}) {
        EXPECT_THAT(error_of("a.yaml", with_comma(yaml, {"cam2:", key})),
                    AllOf(HasSubstr("camera 'cam2': "), HasSubstr(kTwoOfOne)))
            << key;
    }
}

TEST_F(UnreadableNumbers, OfOneCameraOfTomlAreNamed) {
    const std::string toml = test::anipose_toml(cameras_, 1000.0);
    for (const char* key : {"matrix", "distortions", "rotation", "translation"}) {
        EXPECT_THAT(error_of("a.toml", with_comma(toml, {"\"cam3\"", key})),
                    AllOf(HasSubstr("a.toml: "), HasSubstr("a decimal comma")))
            << key;
    }
    EXPECT_THAT(error_of("b.toml", with_comma(toml, {"error = "})),
                AllOf(HasSubstr("b.toml: not valid TOML: line "),
                      HasSubstr("'0,5' is not a number; decimals have a point: 0.5")));
}

}  // namespace
}  // namespace atrium::calibrate
