// Damaged and hostile files: an error or a rig, never a crash, and never more than a moment.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/conclude.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/names/rig_name.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>

namespace atrium::calibrate {
namespace {

struct Sample {
    std::string name;
    std::string text;
    std::string format;
};

std::vector<Sample> samples() {
    atrium::test::Random random(11);
    const auto cameras = test::random_room(random, 3);
    return {{"a.yml", test::opencv_yaml(cameras, 1.0), "opencv"},
            {"a.xml", test::opencv_xml(cameras), "opencv"},
            {"a.json", test::opencv_json(cameras), "opencv"},
            {"a.qca.txt", test::qualisys_xml(cameras), "qualisys"},
            {"a.xcp", test::vicon_xcp(cameras), "vicon"},
            {"a.toml", test::anipose_toml(cameras, 1.0), "anipose"},
            {"a.yaml", test::kalibr_yaml(cameras), "kalibr"},
            {"cameras.bin", test::colmap_cameras_bin(cameras), "colmap"},
            {"images.bin", test::colmap_images_bin(cameras), "colmap"},
            {"t/cameras.txt", test::colmap_cameras_txt(cameras), "colmap"},
            {"t/images.txt", test::colmap_images_txt(cameras, 1.0), "colmap"}};
}

// Reads and, if that is possible, concludes. Every rig that comes out is finite.
void read_hostile(const Files& files, const std::string& format) {
    const auto foreign = read_foreign(files, format);
    if (!foreign) {
        EXPECT_FALSE(foreign.error().message.empty());
        return;
    }
    Said said;
    said.units = "m";
    said.size = {640, 480};
    const auto result = conclude(*foreign, said);
    if (!result) return;
    for (const auto& camera : result->rig.cameras) {
        EXPECT_TRUE(camera.camera_from_site.translation.allFinite());
        EXPECT_TRUE(camera.camera_from_site.rotation.coeffs().allFinite());
        EXPECT_GT(camera.intrinsics.fx, 0.0);
    }
}

// All other files of the sample's format are whole.
void for_each_damage(const std::function<std::string(const std::string&, int)>& damage, int count) {
    const test::Folder folder;
    const auto all = samples();
    for (const Sample& sample : all) folder.write(sample.name, sample.text);
    for (const Sample& sample : all) {
        for (int i = 0; i < count; ++i) {
            const auto file = folder.write(sample.name, damage(sample.text, i));
            read_hostile({file}, sample.format);
        }
        folder.write(sample.name, sample.text);
    }
}

TEST(Hostile, TruncatedFiles) {
    for_each_damage(
        [](const std::string& text, int i) {
            return text.substr(0, text.size() * static_cast<std::size_t>(i) / 40);
        },
        40);
}

// Other numbers with --gtest_shuffle --gtest_repeat=100.
atrium::test::Random hostile_random(int seed) {
    return atrium::test::Random(
        static_cast<std::uint64_t>(seed + 100 * testing::UnitTest::GetInstance()->random_seed()));
}

TEST(Hostile, ChangedBytes) {
    atrium::test::Random random = hostile_random(3);
    const std::string alphabet = "0129-.eE+[]{}:,\"'<>/&!#%\n \tnaif\\\x7f\xff";
    for_each_damage(
        [&](std::string text, int) {
            for (int k = 0; k < 4; ++k) {
                const int at = atrium::test::between(random, 0, static_cast<int>(text.size()) - 1);
                const int c =
                    atrium::test::between(random, 0, static_cast<int>(alphabet.size()) - 1);
                text[static_cast<std::size_t>(at)] = alphabet[static_cast<std::size_t>(c)];
            }
            return text;
        },
        60);
}

TEST(Hostile, NumbersThatAreNone) {
    const std::vector<std::string> numbers{"nan",
                                           ".nan",
                                           "inf",
                                           "-.inf",
                                           "1e999",
                                           "NaN",
                                           "null",
                                           "\"x\"",
                                           "-1",
                                           "0",
                                           "99999999999999999999",
                                           "[]",
                                           ""};
    atrium::test::Random random = hostile_random(4);
    for_each_damage(
        [&](std::string text, int i) {
            // replaces one number
            const auto start = static_cast<std::size_t>(
                atrium::test::between(random, 0, static_cast<int>(text.size()) - 1));
            const std::size_t begin = text.find_first_of("0123456789", start);
            if (begin == std::string::npos) return text;
            const std::size_t end = text.find_first_not_of("0123456789.e+-", begin);
            const std::string& other = numbers[static_cast<std::size_t>(i) % numbers.size()];
            return text.replace(begin, std::min(end, text.size()) - begin, other);
        },
        52);
}

TEST(Hostile, HugeCountsInBinaryModels) {
    for_each_damage(
        [](std::string text, int i) {
            if (text.size() < 16) return text;
            // the first count, or the number of points of an image
            const std::size_t at = i < 4 ? 0 : text.size() - 32;
            for (std::size_t k = 0; k < 8; ++k) text[at + k] = static_cast<char>(0xff >> (i % 4));
            return text;
        },
        8);
}

TEST(Hostile, DeepNesting) {
    const test::Folder folder;
    const std::string open(100'000, '[');
    std::string elements;
    std::string lines = "%YAML:1.0\n---\n";
    std::string dashes = "%YAML:1.0\n---\na:\n ";
    for (int i = 0; i < 20'000; ++i) elements += "<a>";
    for (int i = 0; i < 2'000; ++i) lines += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
    for (int i = 0; i < 20'000; ++i) dashes += "- ";
    for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
             {"a.json", "{\"a\":" + open},
             {"a.yml", "%YAML:1.0\n---\na: " + open},
             {"b.yml", lines},
             {"c.yml", dashes},
             {"a.toml", "a = " + open},
             {"a.xml", "<?xml version=\"1.0\"?><opencv_storage>" + elements},
             {"q.xml", "<calibration><cameras>" + elements}}) {
        const auto file = folder.write(name, text);
        for (const char* format : {"opencv", "qualisys", "vicon", "anipose", "kalibr"}) {
            const auto rig = read_foreign({file}, format);
            ASSERT_FALSE(rig) << name;
            EXPECT_THAT(rig.error().message, testing::HasSubstr(name));
        }
    }
}

TEST(Hostile, NamesOfCamerasAreMadeSafe) {
    const test::Folder folder;
    atrium::test::Random random(8);
    auto cameras = test::random_room(random, 4);
    cameras[0].name = "../../etc";
    cameras[1].name = "..";
    cameras[2].name = "a b";
    cameras[3].name = "a/b";
    const auto rig = read_foreign({folder.write("a.json", test::opencv_json(cameras))}, "auto");
    ASSERT_TRUE(rig) << rig.error().message;
    for (const ForeignCamera& camera : rig->cameras) {
        EXPECT_TRUE(config::is_valid_name(camera.name)) << camera.name;
        EXPECT_NE(camera.name, "..");
    }
    EXPECT_EQ(rig->notes.size(), 4u);
}

TEST(Hostile, NamesInOtherAlphabetsStayReadable) {
    EXPECT_EQ(rig_name("Tür 2"), "Tuer_2");
    EXPECT_EQ(rig_name("Tu\u0308r 2"), "Tuer_2");  // decomposed, as macOS writes it
    EXPECT_EQ(rig_name("Straße"), "Strasse");
    EXPECT_EQ(rig_name("côté Édouard"), "cote_Edouard");
    EXPECT_EQ(rig_name("Łódź"), "Lodz");
    EXPECT_EQ(rig_name("左cam1"), "_cam1");
    EXPECT_EQ(rig_name("左"), "");
    EXPECT_EQ(rig_name("a\xff\xe5"), "a__");
    EXPECT_EQ(rig_name(std::string(70, 'x')), std::string(60, 'x'));
}

TEST(Hostile, NamesThatARigCannotHaveDoNotTakeThoseOfOthers) {
    const test::Folder folder;
    atrium::test::Random random(8);
    auto cameras = test::random_room(random, 4);
    cameras[0].name = "左";
    cameras[1].name = "cam1";
    cameras[2].name = "Tür";
    cameras[3].name = "Tuer";
    const auto rig = read_foreign({folder.write("a.json", test::opencv_json(cameras))}, "auto");
    ASSERT_TRUE(rig) << rig.error().message;
    std::map<std::string, std::string> names;
    for (const ForeignCamera& camera : rig->cameras) names[camera.known_name()] = camera.name;
    EXPECT_EQ(names.at("cam1"), "cam1");
    EXPECT_EQ(names.at("Tuer"), "Tuer");
    EXPECT_EQ(names.at("Tür"), "Tuer_2");
    EXPECT_EQ(names.size(), 4u);
    EXPECT_EQ(rig->notes.size(), 2u);
}

// A file that was cut off says so, with the line where it ends.
TEST(Hostile, NamesTheLineOfAFileThatIsCutOff) {
    atrium::test::Random random(3);
    const test::Folder folder;
    const auto cameras = test::random_room(random, 3);
    const std::string yaml = test::opencv_yaml(cameras, 1.0);
    const std::string toml = test::caliscope_toml(cameras);
    const auto error_of = [&](const std::string& name, const std::string& text) {
        const auto rig = read_foreign({folder.write(name, text)}, "auto");
        return rig ? std::string() : rig.error().message;
    };
    const std::size_t in_data = yaml.find("data: [", yaml.size() / 2) + 20;
    EXPECT_THAT(error_of("a.yml", yaml.substr(0, in_data)),
                testing::AllOf(testing::HasSubstr("FileStorage: line "),
                               testing::HasSubstr("the file may be cut off"),
                               testing::Not(testing::HasSubstr("persistence"))));
    const std::size_t in_key = toml.find("matrix", toml.size() / 2) + 3;
    EXPECT_THAT(error_of("a.toml", toml.substr(0, in_key)),
                testing::AllOf(testing::HasSubstr("TOML: line "),
                               testing::HasSubstr("the file may be cut off"),
                               testing::Not(testing::HasSubstr("toml::"))));
}

}  // namespace
}  // namespace atrium::calibrate
