#include "tests/unit/recording/player_fixture.hpp"

namespace atrium::recording {
namespace {

using namespace recording::testing;
using std::chrono::nanoseconds;

class PlayerSelection : public PlayerTest {};

TEST_F(PlayerSelection, LoopsBetweenItsMarks) {
    std::vector<Recorded> samples;
    for (std::uint64_t i = 0; i < 100; ++i)
        samples.push_back(recorded(state(i), at(0.1 * static_cast<double>(i))));
    open(make(samples));
    player_->set_marks(std::chrono::milliseconds(2950), std::chrono::milliseconds(5050));
    player_->set_loop(true);
    start();
    player_->play();
    std::vector<std::uint64_t> ticks;
    ASSERT_TRUE(comes_true([&] {
        ticks.clear();
        for (const auto& cdr : ear_->payloads("SceneState"))
            ticks.push_back(
                value(bus::from_raw<bus::SceneState>({bus::RawKind::kSample, {}, cdr})).tick);
        return ticks.size() > 70;
    }));
    EXPECT_FALSE(player_->state().is_at_end);
    // The moment in front of the mark, then 30 to 50, and again.
    for (std::size_t i = 0; i < ticks.size(); ++i) EXPECT_EQ(ticks[i], 29 + i % 22);
    player_->set_loop(false);
    ASSERT_TRUE(comes_true([&] { return player_->state().is_at_end; }));
    EXPECT_EQ(player_->state().time, std::chrono::milliseconds(5050));
}

TEST_F(PlayerSelection, KeepsItsMarksInOrder) {
    open(make({recorded(state(0), at(0.0)), recorded(state(1), at(10.0))}));
    player_->set_marks(std::chrono::seconds(3), std::chrono::seconds(2));
    EXPECT_EQ(player_->state().in.count(), 0);
    EXPECT_EQ(player_->state().out, std::chrono::seconds(10));
    player_->set_marks(std::chrono::seconds(-3), std::chrono::seconds(20));
    EXPECT_EQ(player_->state().in.count(), 0);
    EXPECT_EQ(player_->state().out, std::chrono::seconds(10));
    player_->set_speed(1000.0);
    EXPECT_EQ(player_->state().speed, 20.0);
    player_->set_speed(0.0);
    EXPECT_EQ(player_->state().speed, 0.05);
    player_->seek(std::chrono::hours(-1));
    start();
    shown();
    EXPECT_EQ(player_->state().time.count(), 0);
}

TEST_F(PlayerSelection, LoopsARecordingOfOneMomentWithoutHurry) {
    open(make({recorded(description("alice"), at(0.0))}));
    player_->set_loop(true);
    start();
    player_->play();
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_TRUE(comes_true([&] { return player_->state().num_written >= 4; }));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(300));
}

TEST_F(PlayerSelection, PlaysOneOfTwoSitesUnderAnotherNameAndElsewhere) {
    std::vector<Recorded> samples;
    for (const std::string site : {"alice", "bob"}) {
        samples.push_back(recorded(description(site), at(0.0)));
        samples.push_back(recorded(placement(site, 5.0), at(0.1)));
        samples.push_back(recorded(texture(site, 0, 1), at(0.2)));
        samples.push_back(recorded(texture(site, 1, 1), at(0.2)));
        samples.push_back(recorded(mesh(site, 1), at(0.3)));
    }
    samples.push_back(recorded(state(1), at(0.4)));
    samples.push_back(recorded(mesh("alice", 1), at(0.5), bus::RawKind::kDisposed));
    std::ranges::stable_sort(samples, {}, &Recorded::time);
    geometry::RigidTransform place;
    place.translation = {-1.0, 2.0, 0.0};
    const PlaySelection selection{.sites = {"alice"},
                                  .topics = {},
                                  .names = {{"alice", "anna"}},
                                  .places = {{"anna", place}}};
    open(make(samples), selection);
    play_to_the_end();
    bus::SitePlacement moved = placement("anna", 0.0);
    moved.world_from_site = place;
    EXPECT_EQ(ear_->payloads("SiteDescription"), Payloads{bus::to_cdr(description("anna"))});
    EXPECT_EQ(ear_->payloads("SitePlacement"), Payloads{bus::to_cdr(moved)});
    EXPECT_EQ(ear_->payloads("SiteMesh"), Payloads{bus::to_cdr(mesh("anna", 1))});
    EXPECT_EQ(ear_->payloads("CameraTexture").size(), 2u);
    EXPECT_TRUE(ear_->payloads("SceneState").empty());           // it belongs to no site
    EXPECT_FALSE(ear_->alive().contains({"SiteMesh", "anna"}));  // it ended
    EXPECT_EQ(player_->state().num_refused, 0u);
    // After a seek, too: its instances are those of the new name.
    player_->seek(std::chrono::milliseconds(350));
    shown();
    EXPECT_EQ((ear_->alive().at({"SiteMesh", "anna"})), bus::to_cdr(mesh("anna", 1)));
    player_->seek(std::chrono::milliseconds(50));
    shown();
    // Description and place: what came within the first second was there before.
    EXPECT_EQ(ear_->alive().size(), 2u);
}

TEST_F(PlayerSelection, PlaysOnlyTheTopicsThatAreWanted) {
    const auto samples = random_world(304, 100);
    PlaySelection selection;
    selection.topics = {"SceneState", "SiteDescription"};
    open(make(samples), selection);
    play_to_the_end();
    auto expected = payloads_of(samples);
    EXPECT_EQ(ear_->payloads("SceneState"), expected["SceneState"]);
    EXPECT_EQ(ear_->payloads("SiteDescription"), expected["SiteDescription"]);
    for (const Heard& one : ear_->take())
        EXPECT_TRUE(selection.topics.contains(std::string(one.topic->name())));
}

TEST_F(PlayerSelection, LeavesOutDamagedChunksAndSamplesAndCountsThem) {
    const auto samples = random_world(305, 300);
    const auto path = folder_ / "d.mcap";
    auto options = writer_options(path);
    {
        auto writer = value(WorldWriter::create(options));
        for (std::size_t i = 0; i < samples.size(); ++i) {
            ASSERT_TRUE(writer.write(samples[i]));
            if (i == 150) {
                Recorded broken = samples[0];
                broken.topic = bus::find_raw_topic("SceneState");
                broken.time = samples[i].time;
                broken.cdr.assign(20, std::byte{0xFF});
                ASSERT_TRUE(writer.write(broken));
            }
            if (i % 40 == 39) {
                ASSERT_TRUE(
                    writer.flush_due(std::chrono::steady_clock::now() + std::chrono::hours(1)));
            }
        }
        ASSERT_TRUE(writer.finish());
    }
    const auto chunks = value(mcap::File::open(path)).contents().chunks;
    const mcap::ChunkIndex& last = chunks.back();
    {
        std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(static_cast<std::streamoff>(last.offset + last.length / 2));
        file.write("\x55\xAA\x55\xAA", 4);
    }
    open(value(WorldFile::open(path)));
    play_to_the_end();
    EXPECT_EQ(player_->state().num_damaged, 1u);
    EXPECT_EQ(player_->state().num_refused, 1u);
    EXPECT_NE(player_->state().fault, "");
    LeftOut left_out;
    EXPECT_EQ(left_out.update({}), std::nullopt);
    EXPECT_EQ(left_out.update(player_->state()),
              "left_out refused=1 damaged=1 reason=\"" + player_->state().fault + "\"");
    EXPECT_EQ(left_out.update(player_->state()), std::nullopt) << "told once";
    auto expected = payloads_of(samples)["SceneState"];
    const auto played = ear_->payloads("SceneState");
    ASSERT_LE(played.size(), expected.size());
    expected.resize(played.size());  // the damaged chunk is the last
    EXPECT_EQ(played, expected);
    EXPECT_GT(played.size(), 10u);
}

TEST_F(PlayerSelection, IsRobustAgainstManyAtOnce) {
    const auto samples = random_world(306, 200);
    const auto world = make(samples);
    open(world);
    start();
    std::vector<std::jthread> users;
    for (std::uint64_t user = 0; user < 3; ++user) {
        users.emplace_back([&, user] {
            test::Random random(user);
            for (int i = 0; i < 200; ++i) {
                switch (test::between(random, 0, 6)) {
                    case 0:
                        player_->play();
                        break;
                    case 1:
                        player_->pause();
                        break;
                    case 2:
                        player_->step(test::between(random, -3, 3));
                        break;
                    case 3:
                        player_->seek(world->duration() * test::between(random, 0, 100) / 100);
                        break;
                    case 4:
                        player_->set_speed(test::between(random, 0.05, 20.0));
                        break;
                    case 5:
                        player_->set_loop(test::between(random, 0, 1) == 0);
                        break;
                    default:
                        static_cast<void>(player_->state());
                }
            }
        });
    }
    users.clear();
    player_->pause();
    player_->seek(world->duration() / 2);
    shown();
    EXPECT_EQ(player_->state().time, world->duration() / 2);
    EXPECT_EQ(player_->state().num_refused, 0u) << player_->state().fault;
}

}  // namespace
}  // namespace atrium::recording
