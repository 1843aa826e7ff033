#include "core/recording/cursor.hpp"

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace atrium::recording {
namespace {

using namespace recording::testing;

class CursorTest : public ::testing::Test {
protected:
    // Chunks whose times overlap: each holds messages of any time.
    std::shared_ptr<const WorldFile> overlapping(std::uint64_t seed) {
        const auto path = folder_ / ("o" + std::to_string(seed) + ".mcap");
        test::Random random(seed);
        auto writer = value(mcap::Writer::create(path, 4));
        EXPECT_TRUE(writer.add(mcap::Channel{0, "SiteMesh", "cdr", {}}));
        EXPECT_TRUE(writer.add(mcap::Channel{0, "elsewhere", "cdr", {}}));
        samples_.clear();
        for (std::uint64_t i = 0; i < 400; ++i) {
            const Timestamp time = at(test::between(random, 0, 1000) * 0.01);
            const Recorded sample = recorded(mesh("alice", i), time);
            writer.write(static_cast<std::size_t>(test::between(random, 0, 3)),
                         {0, 0, time, sample.written, sample.cdr});
            writer.write(0, {1, 0, time, time, {}});  // not of Atrium
            samples_.push_back(kept(sample));
            if (test::between(random, 0, 15) == 0) {
                EXPECT_TRUE(writer.flush(static_cast<std::size_t>(test::between(random, 0, 3))));
            }
        }
        EXPECT_TRUE(writer.finish());
        return value(WorldFile::open(path));
    }

    test::TemporaryFolder folder_;
    std::vector<Kept> samples_;
};

TEST_F(CursorTest, GoesByTimeThroughOverlappingChunks) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto world = overlapping(seed);
        auto played = all_samples(world);
        EXPECT_TRUE(
            std::ranges::is_sorted(played, {}, [](const Kept& one) { return std::get<2>(one); }));
        std::ranges::sort(played);
        std::ranges::sort(samples_);
        EXPECT_EQ(played, samples_);
    }
}

TEST_F(CursorTest, SeeksToAndBehindATime) {
    const auto world = overlapping(1);
    test::Random random(2);
    Cursor cursor(world);
    for (int round = 0; round < 200; ++round) {
        const Timestamp time = at(test::between(random, -50, 1050) * 0.01);
        const bool is_behind = round % 2 == 0;
        if (is_behind)
            cursor.seek_behind(time);
        else
            cursor.seek_to(time);
        std::vector<Kept> expected;
        for (const Kept& one : samples_) {
            if (is_behind ? std::get<2>(one) > time.ns : std::get<2>(one) >= time.ns)
                expected.push_back(one);
        }
        std::vector<Kept> played;
        // Some are left before all are played: the next seek is from the middle.
        const std::size_t num = round % 3 == 0 ? 5 : 1000;
        for (const PlayedSample* next = cursor.peek(); next != nullptr && played.size() < num;
             next = cursor.peek()) {
            played.push_back(kept(*next));
            cursor.pop();
        }
        if (num > expected.size()) {
            std::ranges::sort(played);
            std::ranges::sort(expected);
            EXPECT_EQ(played, expected);
        } else {
            ASSERT_FALSE(played.empty());
            EXPECT_EQ(std::get<2>(played[0]),
                      std::get<2>(std::ranges::min(
                          expected, {}, [](const Kept& one) { return std::get<2>(one); })));
        }
    }
}

TEST_F(CursorTest, StaysAtTheNextSampleUntilItIsTaken) {
    const auto world = overlapping(3);
    Cursor cursor(world);
    const PlayedSample* const first = cursor.peek();
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(cursor.peek(), first);
    EXPECT_EQ(first->time, world->begin());
    cursor.seek_behind(world->end());
    EXPECT_EQ(cursor.peek(), nullptr);
    EXPECT_EQ(cursor.peek(), nullptr);
    cursor.seek_to(world->begin());
    EXPECT_NE(cursor.peek(), nullptr);
}

TEST_F(CursorTest, LeavesOutDamagedChunksAndCountsThem) {
    const auto samples = random_world(9, 600);
    write_recording(writer_options(folder_ / "a.mcap"), samples, 40);
    const auto whole = value(WorldFile::open(folder_ / "a.mcap"));
    const auto& chunks = whole->file().contents().chunks;
    ASSERT_GT(chunks.size(), 8u);
    const std::size_t damaged = chunks.size() / 2;
    std::vector<Kept> expected;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        if (i == damaged) continue;
        for (const mcap::Message& message : value(whole->file().read(i)).messages) {
            const RecordedChannel channel = whole->channel(message.channel);
            expected.push_back(kept(PlayedSample{message.log_time,
                                                 channel.topic,
                                                 {channel.kind, message.publish_time, message.data},
                                                 nullptr}));
        }
    }
    {
        std::fstream file(folder_ / "a.mcap", std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(
            static_cast<std::streamoff>(chunks[damaged].offset + chunks[damaged].length / 2));
        file.write("\x55\xAA\x55\xAA", 4);
    }
    Cursor cursor(value(WorldFile::open(folder_ / "a.mcap")));
    std::vector<Kept> played;
    for (const PlayedSample* next = cursor.peek(); next != nullptr; next = cursor.peek()) {
        played.push_back(kept(*next));
        cursor.pop();
    }
    EXPECT_EQ(cursor.num_damaged(), 1u);
    EXPECT_THAT(cursor.damage(), ::testing::HasSubstr("a.mcap: chunk "));
    std::ranges::sort(expected);
    std::ranges::sort(played);
    EXPECT_EQ(played, expected);
}

}  // namespace
}  // namespace atrium::recording
