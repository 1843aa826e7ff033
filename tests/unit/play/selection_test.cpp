#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"
#include "tools/play/describe.hpp"
#include "tools/play/play.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace atrium::play {
namespace {

using namespace recording::testing;
using ::testing::HasSubstr;

class PlaySelectionTest : public ::testing::Test {
protected:
    void SetUp() override {
        std::vector<recording::Recorded> samples;
        for (const std::string site : {"alice", "bob"}) {
            samples.push_back(recorded(description(site), at(0.0)));
            samples.push_back(recorded(presence(bus::ProgramKind::kSiteNode, site), at(0.0)));
        }
        samples.push_back(recorded(state(1), at(1.0)));
        samples.push_back(recorded(state(2), at(2.0)));
        write_recording(writer_options(folder_ / "a.mcap"), samples);
        world_ = value(recording::WorldFile::open(folder_ / "a.mcap"));
        config_.file = folder_ / "a.mcap";
    }
    std::string mistake() {
        const auto selection = selection_of(config_, *world_);
        if (selection) return "";
        EXPECT_EQ(selection.error().kind, ErrorKind::kConfiguration);
        return selection.error().message;
    }

    test::TemporaryFolder folder_;
    std::shared_ptr<const recording::WorldFile> world_;
    PlayConfig config_;
};

TEST_F(PlaySelectionTest, TakesSitesTopicsNamesAndPlaces) {
    config_.sites = "alice,bob";
    config_.topics = "SceneState";
    config_.rename = "alice=anna";
    config_.place = "anna=1.5,-2,90;bob=0,0,0";
    const auto selection = value(selection_of(config_, *world_));
    EXPECT_EQ(selection.sites, (std::set<std::string>{"alice", "bob"}));
    EXPECT_EQ(selection.topics, std::set<std::string>{"SceneState"});
    EXPECT_EQ(selection.names.at("alice"), "anna");
    const geometry::RigidTransform& place = selection.places.at("anna");
    EXPECT_EQ(place.translation, Eigen::Vector3d(1.5, -2.0, 0.0));
    EXPECT_LT((place.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

TEST_F(PlaySelectionTest, RepairNamesWhatItCannotMend) {
    config_.repair = true;
    EXPECT_TRUE(run_play(config_, {})) << "complete";
    const mcap::ChunkIndex chunk = world_->file().contents().chunks.front();
    {
        std::fstream file(config_.file, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(chunk.offset + chunk.length / 2));
        file.write("\x55\xAA\x55\xAA", 4);
    }
    const auto done = run_play(config_, {});
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kInvalidData);
    EXPECT_THAT(done.error().message, HasSubstr("a.mcap: 1 of "));
}

TEST_F(PlaySelectionTest, NamesTheMistake) {
    config_.sites = "alice,carol";
    EXPECT_EQ(mistake(), "sites: the recording has no site 'carol'; it has alice, bob");
    config_.sites = "";
    config_.topics = "SiteMesh";
    EXPECT_EQ(mistake(),
              "topics: the recording has no topic 'SiteMesh'; it has Presence, SceneState, "
              "SiteDescription");
    config_.topics = "";
    for (const char* rename : {"alice", "alice=", "alice=a b", "=x"}) {
        config_.rename = rename;
        EXPECT_NE(mistake(), "") << rename;
    }
    config_.rename = "carol=anna";
    EXPECT_THAT(mistake(), HasSubstr("rename: the recording has no site 'carol'"));
    config_.rename = "";
    for (const char* place : {"alice",
                              "alice=1,2",
                              "alice=1,2,3,4",
                              "alice=a,b,c",
                              "alice=nan,0,0",
                              "alice=1e9,0,0",
                              "a b=1,2,3"}) {
        config_.place = place;
        EXPECT_THAT(mistake(), HasSubstr("write SITE=X,Y,YAW")) << place;
    }
}

// Two people of one name would be one person on the bus, who jumps.
TEST_F(PlaySelectionTest, RefusesTwoSitesOfOneName) {
    config_.rename = "alice=bob";
    EXPECT_EQ(mistake(), "rename: two sites would be named 'bob'");
    config_.rename = "alice=x,bob=x";
    EXPECT_EQ(mistake(), "rename: two sites would be named 'x'");
    config_.rename = "alice=bob,bob=alice";
    EXPECT_EQ(mistake(), "");
    config_.rename = "alice=bob";
    config_.sites = "alice";  // the other is not played
    EXPECT_EQ(mistake(), "");
}

TEST_F(PlaySelectionTest, RefusesAPlaceOfNobody) {
    config_.rename = "alice=anna";
    config_.place = "alice=1,0,0";
    EXPECT_EQ(mistake(), "place: no site is played as 'alice'; there are anna, bob");
}

TEST_F(PlaySelectionTest, ChecksItsTimes) {
    config_.from_s = 5.0;
    EXPECT_TRUE(check(config_));
    config_.to_s = 5.0;
    ASSERT_FALSE(check(config_));
    EXPECT_THAT(check(config_).error().message, HasSubstr("to: must be later than from (5)"));
    config_.file.clear();
    EXPECT_THAT(check(config_).error().message, HasSubstr("FILE is missing"));
}

TEST_F(PlaySelectionTest, DescribesARecording) {
    const std::string text = describe(*world_);
    EXPECT_THAT(text, HasSubstr("a.mcap: world studio, 2.0 s, "));
    EXPECT_THAT(text, HasSubstr("sites: alice, bob\n"));
    EXPECT_THAT(text, HasSubstr("program: site alice on host, version 1\n"));
    EXPECT_THAT(text, HasSubstr("2 SceneState         1.0/s\n"));
    const auto json = nlohmann::json::parse(describe_json(*world_));
    EXPECT_EQ(json["world"], "studio");
    EXPECT_EQ(json["duration_s"], 2.0);
    EXPECT_EQ(json["num_samples"]["SceneState"], 2);
    EXPECT_EQ(json["fault"], "");
    EXPECT_EQ(json["programs"][0]["kind"], "site");
}

TEST_F(PlaySelectionTest, DescribesADamagedRecording) {
    std::filesystem::resize_file(folder_ / "a.mcap",
                                 std::filesystem::file_size(folder_ / "a.mcap") - 100);
    const auto world = value(recording::WorldFile::open(folder_ / "a.mcap"));
    EXPECT_THAT(describe(*world), HasSubstr("--repair completes it"));
    EXPECT_NE(nlohmann::json::parse(describe_json(*world))["fault"], "");
}

}  // namespace
}  // namespace atrium::play
