// Folders in which several calibrations, or files of other kinds, lie side by side.
#include "tests/unit/calibrate/foreign_texts.hpp"
#include "tools/calibrate/formats/format.hpp"
#include "tools/calibrate/formats/rig_file.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::calibrate {
namespace {

using testing::HasSubstr;

class FolderOfFiles : public testing::Test {
protected:
    Expected<ForeignRig> read() const {
        const auto files = with_folders_opened({folder_.path()});
        if (!files) return tl::unexpected(files.error());
        return read_foreign(*files, "auto");
    }
    std::string error() const {
        const auto rig = read();
        return rig ? "no error" : rig.error().message;
    }
    // One file per camera, with the keys at the top.
    void write_each(const test::Cameras& cameras) const {
        for (const auto& camera : cameras) {
            std::string text = test::opencv_yaml({camera}, 1.0);
            text.erase(text.find(camera.name), camera.name.size() + 2);
            for (std::size_t at = 0; (at = text.find("\n   ", at)) != std::string::npos; ++at)
                text.erase(at + 1, 3);
            folder_.write(camera.name + ".yaml", text);
        }
    }

    atrium::test::Random random_{78};
    test::Folder folder_;
    test::Cameras cameras_ = test::random_room(random_, 4);
};

TEST_F(FolderOfFiles, WithTwoCalibrationsOfTheSameCamerasIsRefused) {
    const auto older = folder_.write("20240212.qca.txt", test::qualisys_xml(cameras_));
    EXPECT_TRUE(read());
    const auto newer = folder_.write("20240304.qca.txt", test::qualisys_xml(cameras_));
    EXPECT_THAT(error(),
                HasSubstr("this folder holds 2 calibrations with the same cameras: " +
                          older.string() + ", " + newer.string() + "; give one of them"));
}

TEST_F(FolderOfFiles, OfAnyFormatMayHoldOneCalibrationOfACamera) {
    folder_.write("a.toml", test::anipose_toml(cameras_, 1000.0));
    folder_.write("b.toml", test::anipose_toml({cameras_[1], cameras_[2]}, 1000.0));
    EXPECT_THAT(error(), HasSubstr("2 calibrations with the same cameras"));
    folder_.write("b.toml", "# no camera\n");
    EXPECT_TRUE(read());
}

TEST_F(FolderOfFiles, WithAPartInEachFileIsOneCalibration) {
    write_each(cameras_);
    const auto each = read();
    ASSERT_TRUE(each) << each.error().message;
    EXPECT_EQ(each->cameras.size(), cameras_.size());
    const test::Folder halves;
    const Files files{
        halves.write("a.xcp", test::vicon_xcp({cameras_[0], cameras_[1]})),
        halves.write("b.xcp", test::vicon_xcp({cameras_[2], cameras_[3]})),
    };
    const auto both = read_foreign(files, "auto");
    ASSERT_TRUE(both) << both.error().message;
    EXPECT_EQ(both->cameras.size(), cameras_.size());
}

TEST_F(FolderOfFiles, AboveThatOfTheCalibrationNamesIt) {
    EXPECT_THAT(error(), HasSubstr("a folder without a calibration"));
    folder_.write("Data/notes.txt", "nothing");
    const auto file = folder_.write("qtm/Calibrations/a.qca.xml", test::qualisys_xml(cameras_));
    EXPECT_THAT(error(),
                HasSubstr("but below it there is '" + file.string() + "'; give that of these"));
    const auto other = folder_.write("other/b.yml", "a: 1\n");
    folder_.write("one/two/three/c.yml", "a: 1\n");
    EXPECT_THAT(error(), HasSubstr("there are '" + other.string() + "', '" + file.string() + "';"));
}

TEST_F(FolderOfFiles, OfOneCameraEachNamesThemWithoutTheWordsOfAll) {
    const std::vector<std::string> places{"door", "window", "desk", "shelf"};
    for (std::size_t i = 0; i < places.size(); ++i) cameras_[i].name = places[i] + "_calib";
    write_each(cameras_);
    const auto rig = read();
    ASSERT_TRUE(rig) << rig.error().message;
    std::vector<std::string> names;
    for (const ForeignCamera& camera : rig->cameras) names.push_back(camera.name);
    EXPECT_THAT(names, testing::UnorderedElementsAreArray(places));
}

TEST(WordsOfCalibration, AreDroppedIfAllNamesHaveThemAndStayNames) {
    using Names = std::vector<std::string>;
    const auto without = without_calibration_words;
    EXPECT_EQ(without({"door_calib", "left door_calib"}), (Names{"door", "left door"}));
    EXPECT_EQ(without({"a-Camera-Calibration", "b-Camera-Calibration"}), (Names{"a", "b"}));
    EXPECT_EQ(without({"calib_left", "calib_right"}), (Names{"left", "right"}));
    EXPECT_EQ(without({"A_intrinsics", "B_intrinsics"}), (Names{"A", "B"}));
    // not all, no letter left, two alike, no word of its own, one file
    for (const Names& names : {Names{"door_calib", "desk"},
                               Names{"1_calib", "2_calib"},
                               Names{"calib_a", "a_calib"},
                               Names{"cam_left", "cam_right"},
                               Names{"localib", "recalib"},
                               Names{"calib", "calib_2"},
                               Names{"door_calib"}})
        EXPECT_EQ(without(names), names);
}

TEST_F(FolderOfFiles, MayHoldTheRigOfAnEarlierImport) {
    config::Rig rig;
    rig.cameras = cameras_;
    const auto lab = folder_.write("lab.toml", rig_text(rig, {"Imported from somewhere."}));
    EXPECT_THAT(error(), HasSubstr("lab.toml: this is a rig.toml of Atrium already"));
    write_each(cameras_);
    const auto beside = read();
    ASSERT_TRUE(beside) << beside.error().message;
    EXPECT_EQ(beside->format, "OpenCV");
    EXPECT_FALSE(read_foreign({lab}, "auto"));  // named by the user
}

TEST_F(FolderOfFiles, OfColmapMayHoldTheRigOfAnEarlierImport) {
    config::Rig rig;
    rig.cameras = cameras_;
    folder_.write("rig.toml", rig_text(rig, {}));
    folder_.write("sparse/0/cameras.bin", test::colmap_cameras_bin(cameras_));
    folder_.write("sparse/0/images.bin", test::colmap_images_bin(cameras_));
    const auto model = read();
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_EQ(model->format, "COLMAP");
}

TEST(FilesOfTwoFolders, WithTheSameCamerasAreRefused) {
    atrium::test::Random random(79);
    const test::Folder folder;
    const std::string text = test::opencv_yaml(test::random_room(random, 3), 1.0);
    const auto rig =
        read_foreign({folder.write("old/a.yml", text), folder.write("new/a.yml", text)}, "auto");
    ASSERT_FALSE(rig);
    EXPECT_THAT(rig.error().message, HasSubstr("these files are 2 calibrations with the same"));
}

}  // namespace
}  // namespace atrium::calibrate
