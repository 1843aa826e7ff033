#include "tests/unit/recording/player_fixture.hpp"

namespace atrium::recording {
namespace {

using namespace recording::testing;
using std::chrono::nanoseconds;

class PlayerTime : public PlayerTest {};

TEST_F(PlayerTime, PlaysEverySampleBitForBitInOrder) {
    for (std::uint64_t seed = 200; seed < 204; ++seed) {
        SCOPED_TRACE(seed);
        const auto samples = random_world(seed, 150);
        open(make(samples));
        play_to_the_end();
        for (const auto& [topic, payloads] : payloads_of(samples))
            EXPECT_EQ(ear_->payloads(topic), payloads) << topic;
        EXPECT_EQ(player_->state().num_refused, 0u) << player_->state().fault;
        EXPECT_EQ(player_->state().num_damaged, 0u);
        EXPECT_EQ(player_->state().num_written, samples.size());
    }
}

// The player's clock is never ahead of the recording; how late it is depends on the machine.

TEST_F(PlayerTime, PlaysNothingBeforeItsTime) {
    std::vector<Recorded> samples;
    for (std::uint64_t i = 0; i < 60; ++i)
        samples.push_back(recorded(state(i), at(0.05 * static_cast<double>(i))));
    open(make(samples));
    player_->set_speed(4.0);
    bus::Reader<bus::SceneState> reader =
        value(bus::Reader<bus::SceneState>::create(*participant_));
    const auto begin = std::chrono::steady_clock::now();
    const Timestamp begin_time = Timestamp::now();
    start();
    player_->play();
    std::size_t num = 0;
    ASSERT_TRUE(comes_true([&] {
        reader.take_written([&](bus::SceneState&& one, Timestamp written) {
            const auto due = nanoseconds(static_cast<std::int64_t>(one.tick) * 50'000'000 / 4);
            EXPECT_GE(std::chrono::steady_clock::now() - begin, due);
            // 1 ms older than its record, as recorded
            EXPECT_GE(written, begin_time + due + std::chrono::milliseconds(-1));
            EXPECT_LE(written, Timestamp::now() + std::chrono::milliseconds(-1));
            ++num;
        });
        return player_->state().is_at_end && num == samples.size();
    }));
}

TEST_F(PlayerTime, ShowsTheMomentAfterEachSeek) {
    const auto samples = random_world(300, 500);
    const auto world = make(samples);
    open(world);
    start();
    test::Random random(5);
    for (int i = 0; i < 60; ++i) {
        const nanoseconds time = world->duration() * test::between(random, 0, 1000) / 1000;
        player_->seek(time);
        shown();
        EXPECT_EQ(player_->state().time, time);
        Ear::Alive expected;
        if (time.count() > 0) {
            for (const KeyedSample& one : moment(world, world->begin() + time)) {
                expected[{std::string(one.sample.topic->name()), one.key}] = {
                    one.sample.raw.cdr.begin(), one.sample.raw.cdr.end()};
            }
        }
        EXPECT_EQ(ear_->alive(), expected) << time.count();
    }
}

TEST_F(PlayerTime, PlaysFromASeekThatIsNotShownYet) {
    const auto samples = random_world(301, 100);
    const auto world = make(samples);
    open(world);
    player_->step(5);
    player_->seek(world->duration());  // instead of the steps
    start();
    shown();
    EXPECT_EQ(player_->state().time, world->duration());
    player_->play();
    ASSERT_TRUE(comes_true([&] { return player_->state().is_at_end; }));
    thread_.request_stop();
    thread_.join();
    player_->set_speed(0.05);
    player_->seek(world->duration() / 2);
    player_->play();  // not from the beginning, although it is at the end
    start();
    shown();
    EXPECT_GE(player_->state().time, world->duration() / 2);
    EXPECT_TRUE(player_->state().is_playing);
}

// Seeking is not enough: what is played from there on must be what follows.

TEST_F(PlayerTime, PlaysOnFromWhereItWasSoughtTo) {
    const auto samples = random_world(301, 200);
    const auto world = make(samples);
    open(world);
    start();
    player_->seek(world->duration() / 2);
    shown();
    ear_->forget();
    std::vector<Recorded> rest;
    for (const Recorded& sample : samples) {
        if (sample.time > world->begin() + world->duration() / 2) rest.push_back(sample);
    }
    player_->play();
    ASSERT_TRUE(comes_true([&] { return player_->state().is_at_end; }));
    for (const auto& [topic, payloads] : payloads_of(rest))
        EXPECT_EQ(ear_->payloads(topic), payloads) << topic;
    // Again from the start, although it is at the end.
    ear_->forget();
    player_->play();
    ASSERT_TRUE(comes_true([&] {
        return player_->state().is_at_end &&
               player_->state().num_written > samples.size() + rest.size();
    }));
    EXPECT_EQ(ear_->payloads("SceneState"), payloads_of(samples)["SceneState"]);
}

TEST_F(PlayerTime, EndsAllInstancesWhenItStops) {
    const auto samples = random_world(302, 100);
    open(make(samples));
    start();
    player_->seek(std::chrono::hours(1));  // to the end
    shown();
    EXPECT_EQ(player_->state().time, player_->world().duration());
    EXPECT_FALSE(ear_->alive().empty());
    thread_.request_stop();
    thread_.join();
    EXPECT_TRUE(ear_->alive().empty());
}

TEST_F(PlayerTime, StepsFromFrameToFrame) {
    std::vector<Recorded> samples;
    std::vector<nanoseconds> times;
    for (std::uint64_t i = 0; i < 30; ++i) {
        const double time_s =
            i < 15 ? 0.1 * static_cast<double>(i) : 20.0 + static_cast<double>(i);  // a long pause
        samples.push_back(recorded(state(i), at(time_s)));
        samples.push_back(recorded(texture("alice", 0, i), at(time_s + 0.01)));
        samples.push_back(recorded(texture("alice", 1, i), at(time_s + 0.02)));
        samples.push_back(recorded(mesh("alice", i), at(time_s + 0.03)));
        times.push_back(samples.back().time - kBegin);
    }
    open(make(samples));
    start();
    const auto step_to = [&](int num, std::size_t frame) {
        player_->step(num);
        shown();
        EXPECT_EQ(player_->state().time, times[frame]);
        EXPECT_FALSE(player_->state().is_playing);
        EXPECT_EQ((ear_->alive().at({"SiteMesh", "alice"})), bus::to_cdr(mesh("alice", frame)));
    };
    for (std::size_t i = 0; i < 30; ++i) step_to(1, i);
    step_to(1, 29);  // the last
    for (std::size_t i = 29; i-- > 0;) step_to(-1, i);
    step_to(-1, 0);
    step_to(7, 7);
    step_to(-3, 4);
    step_to(1'000'000'000, 29);
    step_to(-1'000'000'000, 0);
    player_->seek(times[10]);
    step_to(2, 12);  // at once after a seek
}

TEST_F(PlayerTime, StepsByStatesWithoutPeople) {
    std::vector<Recorded> samples;
    for (std::uint64_t i = 0; i < 5; ++i)
        samples.push_back(recorded(state(i), at(0.1 * static_cast<double>(i))));
    open(make(samples));
    start();
    player_->step(2);
    shown();
    EXPECT_EQ(player_->state().time, samples[2].time - kBegin);
}

TEST_F(PlayerTime, PausesAndGoesOn) {
    const auto samples = random_world(303, 200);
    // It never gets to the last sample: from the end, play would begin anew.
    auto with_an_end = samples;
    with_an_end.push_back(recorded(state(0), samples.back().time + std::chrono::hours(10)));
    open(make(with_an_end));
    start();
    player_->play();
    for (int i = 0; i < 20; ++i) {
        const auto num_written = player_->state().num_written;
        comes_true([&] {
            return player_->state().num_written > num_written || num_written == samples.size();
        });
        player_->pause();
        player_->set_speed(20.0);
        player_->play();
    }
    ASSERT_TRUE(comes_true([&] { return player_->state().num_written >= samples.size(); }));
    for (const auto& [topic, payloads] : payloads_of(samples))
        EXPECT_EQ(ear_->payloads(topic), payloads) << topic;
}

}  // namespace
}  // namespace atrium::recording
