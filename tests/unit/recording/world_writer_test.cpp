#include "core/recording/world_writer.hpp"

#include "core/recording/topic_roles.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/recording/recording_samples.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace atrium::recording {
namespace {

using namespace recording::testing;

class WorldWriterTest : public ::testing::Test {
protected:
    test::TemporaryFolder folder_;
};

TEST_F(WorldWriterTest, KeepsRandomWorldsInOrder) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const auto samples = random_world(seed, 300);
        const auto path = folder_ / ("w" + std::to_string(seed) + ".mcap");
        write_recording(writer_options(path), samples, 1 + static_cast<int>(seed) * 5);
        const auto world = value(WorldFile::open(path));
        std::vector<Kept> expected;
        for (const Recorded& sample : samples) expected.push_back(kept(sample));
        std::ranges::stable_sort(expected, {}, [](const Kept& one) { return std::get<2>(one); });
        // Samples of the same nanosecond may change places between the lanes.
        auto played = all_samples(world);
        EXPECT_TRUE(
            std::ranges::is_sorted(played, {}, [](const Kept& one) { return std::get<2>(one); }));
        std::ranges::sort(expected);
        std::ranges::sort(played);
        EXPECT_EQ(played, expected);
        EXPECT_EQ(world->begin(), samples.front().time);
        EXPECT_EQ(world->end(), samples.back().time);
        EXPECT_EQ(world->world(), "studio");
        EXPECT_EQ(world->version(), "0.1");
        EXPECT_TRUE(world->foreign_topics().empty());
        std::map<std::string, std::uint64_t> nums;
        for (const Recorded& sample : samples) {
            if (sample.kind == bus::RawKind::kSample) ++nums[std::string(sample.topic->name())];
        }
        EXPECT_EQ(world->num_samples(), nums);
    }
}

// A reader that joins must find them without the chunks of pictures.
TEST_F(WorldWriterTest, PutsWhatIsKeptIntoChunksOfItsOwn) {
    write_recording(writer_options(folder_ / "a.mcap"), random_world(3, 300));
    const auto world = value(WorldFile::open(folder_ / "a.mcap"));
    const auto& chunks = world->file().contents().chunks;
    for (const mcap::ChunkIndex& chunk : chunks) {
        std::set<bool> roles;
        for (const auto& [channel, at] : chunk.message_indexes) {
            const auto* const topic = world->channel(channel).topic;
            roles.insert(topic != nullptr && is_kept(*topic));
        }
        EXPECT_EQ(roles.size(), 1u);
    }
    EXPECT_FALSE(world->kept().empty());
    for (const WorldFile::Kept& one : world->kept()) EXPECT_TRUE(is_kept(*one.sample.topic));
    EXPECT_EQ(world->sites(), (std::vector<std::string>{"alice", "bob"}));
}

TEST_F(WorldWriterTest, NumbersTheMessagesOfEachChannel) {
    write_recording(writer_options(folder_ / "a.mcap"), random_world(4, 200));
    const auto file = value(mcap::File::open(folder_ / "a.mcap"));
    std::map<std::uint16_t, std::vector<std::uint32_t>> sequences;
    for (std::size_t i = 0; i < file.contents().chunks.size(); ++i) {
        for (const mcap::Message& message : value(file.read(i)).messages)
            sequences[message.channel].push_back(message.sequence);
    }
    EXPECT_GT(sequences.size(), 5u);
    for (const auto& [channel, numbers] : sequences) {
        for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], i);
    }
}

TEST_F(WorldWriterTest, SaysWhatItsChannelsAre) {
    auto writer = value(WorldWriter::create(writer_options(folder_ / "a.mcap")));
    ASSERT_TRUE(writer.write(recorded(mesh("alice", 1), at(0.0))));
    ASSERT_TRUE(writer.write(recorded(mesh("alice", 1), at(0.1), bus::RawKind::kDisposed)));
    ASSERT_TRUE(writer.write(recorded(mesh("alice", 1), at(0.2), bus::RawKind::kLost)));
    ASSERT_TRUE(writer.note(at(0.3), R"({"num_samples":3})"));
    ASSERT_TRUE(writer.finish());
    const auto file = value(mcap::File::open(folder_ / "a.mcap"));
    std::map<std::string, std::pair<std::string, std::string>> channels;
    for (const auto& [id, channel] : file.contents().channels) {
        const mcap::Schema& schema = file.contents().schemas.at(channel.schema);
        channels[channel.topic] = {channel.message_encoding, schema.encoding + " " + schema.name};
    }
    const std::pair<std::string, std::string> cdr{"cdr", "omgidl atrium::SiteMesh"};
    EXPECT_EQ(channels,
              (decltype(channels){{"SiteMesh", cdr},
                                  {"SiteMesh/disposed", cdr},
                                  {"SiteMesh/lost", cdr},
                                  {"recorder", {"json", "jsonschema atrium.Recorder"}}}));
}

// Each part opens, and holds all that was kept when it began.
TEST_F(WorldWriterTest, CutsFilesThatCanEachBePlayedAlone) {
    for (const bool by_time : {true, false}) {
        SCOPED_TRACE(by_time);
        const auto samples = random_world(by_time ? 5 : 6, 1500);
        WriterOptions options = writer_options(folder_ / (by_time ? "t.mcap" : "b.mcap"));
        if (by_time)
            options.cut_after = std::chrono::seconds(2);
        else
            options.cut_bytes = 20'000;
        // The first file's time begins now: the samples' do, too.
        auto moved = samples;
        const auto shift = Timestamp::now() - kBegin;
        for (Recorded& sample : moved) {
            sample.time = sample.time + shift;
            sample.written = sample.written + shift;
        }
        const auto files = write_recording(options, moved, 10);
        ASSERT_GT(files.size(), 3u);
        EXPECT_EQ(files[1].filename(), by_time ? "t-2.mcap" : "b-2.mcap");

        std::vector<Kept> all;
        std::map<std::pair<std::string, std::string>, std::vector<std::byte>> alive;
        for (std::size_t part = 0; part < files.size(); ++part) {
            SCOPED_TRACE(files[part]);
            const auto world = value(WorldFile::open(files[part]));
            EXPECT_EQ(world->file().fault(), "");
            auto played = all_samples(world);
            // It begins with what was alive at the end of the last part.
            std::map<std::pair<std::string, std::string>, std::vector<std::byte>> begun;
            const std::size_t num_begun = alive.size();
            for (std::size_t i = 0; i < num_begun; ++i) {
                const auto* const topic = bus::find_raw_topic(std::get<0>(played.at(i)));
                ASSERT_TRUE(is_kept(*topic));
                const auto key =
                    value(topic->key_of({std::get<1>(played[i]), {}, std::get<4>(played[i])}));
                begun[{std::get<0>(played[i]), key}] = std::get<4>(played[i]);
            }
            EXPECT_EQ(begun, alive);
            played.erase(played.begin(), played.begin() + static_cast<std::ptrdiff_t>(num_begun));
            for (Kept& one : played) {
                const auto* const topic = bus::find_raw_topic(std::get<0>(one));
                if (is_kept(*topic)) {
                    const auto key = value(topic->key_of({std::get<1>(one), {}, std::get<4>(one)}));
                    if (std::get<1>(one) == bus::RawKind::kSample)
                        alive[{std::get<0>(one), key}] = std::get<4>(one);
                    else
                        alive.erase({std::get<0>(one), key});
                }
                all.push_back(std::move(one));
            }
        }
        std::vector<Kept> expected;
        for (const Recorded& sample : moved) expected.push_back(kept(sample));
        std::ranges::sort(expected);
        std::ranges::sort(all);
        EXPECT_EQ(all, expected);
    }
}

TEST_F(WorldWriterTest, LeavesOutNumbersOfFilesThatExist) {
    std::ofstream(folder_ / "a-2.mcap") << "an older recording";
    WriterOptions options = writer_options(folder_ / "a.mcap");
    options.cut_bytes = 5'000;
    const auto files = write_recording(options, random_world(7, 200), 10);
    ASSERT_GT(files.size(), 2u);
    EXPECT_EQ(files[1].filename(), "a-3.mcap");
    std::ifstream stream(folder_ / "a-2.mcap");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "an older recording");
}

TEST_F(WorldWriterTest, FlushesWhatWaitedLong) {
    auto writer = value(WorldWriter::create(writer_options(folder_ / "a.mcap")));
    const auto now = std::chrono::steady_clock::now();
    ASSERT_TRUE(writer.write(recorded(mesh("alice", 1), at(0.0))));
    ASSERT_TRUE(writer.flush_due(now));
    EXPECT_FALSE(mcap::File::open(folder_ / "a.mcap"));  // no chunk yet
    ASSERT_TRUE(writer.flush_due(now + 2 * WorldWriter::kFlushAfter));
    EXPECT_TRUE(mcap::File::open(folder_ / "a.mcap"));
    ASSERT_TRUE(writer.finish());
}

TEST_F(WorldWriterTest, PartsHaveNumbersBeforeTheEnding) {
    EXPECT_EQ(part_name("x/a.mcap", 1), "x/a.mcap");
    EXPECT_EQ(part_name("x/a.mcap", 2), "x/a-2.mcap");
    EXPECT_EQ(part_name("a.b.mcap", 12), "a.b-12.mcap");
}

TEST_F(WorldWriterTest, RefusesAFileWithoutTopicsOfAtrium) {
    auto writer = value(mcap::Writer::create(folder_ / "a.mcap", 1));
    ASSERT_TRUE(writer.add(mcap::Channel{0, "/robot/pose", "cdr", {}}));
    writer.write(0, {0, 0, kBegin, kBegin, {}});
    ASSERT_TRUE(writer.finish());
    const auto world = WorldFile::open(folder_ / "a.mcap");
    ASSERT_FALSE(world);
    EXPECT_THAT(world.error().message, ::testing::HasSubstr("it is no recording of Atrium"));
}

TEST_F(WorldWriterTest, TellsTopicsOfAnotherVersion) {
    auto writer = value(mcap::Writer::create(folder_ / "a.mcap", 1));
    const auto schema = value(writer.add(mcap::Schema{"atrium::SiteMesh", "omgidl", "other"}));
    ASSERT_TRUE(writer.add(mcap::Channel{schema, "SiteMesh", "cdr", {}}));
    const Recorded sample = recorded(mesh("alice", 1), kBegin);
    writer.write(0, {0, 0, kBegin, kBegin, sample.cdr});
    ASSERT_TRUE(writer.finish());
    const auto world = value(WorldFile::open(folder_ / "a.mcap"));
    EXPECT_EQ(world->foreign_topics(), std::vector<std::string>{"SiteMesh"});
    EXPECT_EQ(all_samples(world).size(), 1u);
}

TEST_F(WorldWriterTest, SaysWhatItLeavesOutOfTooMuchKept) {
    auto writer = value(mcap::Writer::create(folder_ / "a.mcap", 1));
    ASSERT_TRUE(writer.add(mcap::Channel{0, "SiteDescription", "cdr", {}}));
    const Recorded one = recorded(description("alice"), kBegin);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const Timestamp time = kBegin + std::chrono::seconds(i);
        writer.write(0, {0, i, time, time, one.cdr});
        ASSERT_TRUE(writer.flush(0));
    }
    ASSERT_TRUE(writer.finish());
    const auto whole = value(WorldFile::open(folder_ / "a.mcap"));
    EXPECT_EQ(whole->kept().size(), 4u);
    EXPECT_THAT(whole->warnings(),
                ::testing::Not(::testing::Contains(::testing::HasSubstr("too_much_kept"))));
    const auto cut =
        value(WorldFile::open(folder_ / "a.mcap", one.cdr.size() + sizeof(WorldFile::Kept) + 1));
    EXPECT_EQ(cut->kept().size(), 2u);
    EXPECT_THAT(cut->warnings(),
                ::testing::Contains(::testing::ContainsRegex("^too_much_kept .* from_s=2.0: ")));
}

// The chunks of other programs (`mcap filter`, `mcap merge`) mix all topics.
TEST_F(WorldWriterTest, ReadsWhatIsKeptFromMixedChunks) {
    auto writer = value(mcap::Writer::create(folder_ / "a.mcap", 1));
    ASSERT_TRUE(writer.add(mcap::Channel{0, "SiteDescription", "cdr", {}}));
    ASSERT_TRUE(writer.add(mcap::Channel{0, "SiteMesh", "cdr", {}}));
    const Recorded kept_one = recorded(description("alice"), kBegin);
    const Recorded other = recorded(mesh("alice", 1), kBegin);
    writer.write(0, {1, 0, kBegin, kBegin, other.cdr});
    writer.write(0, {0, 0, kBegin, kBegin, kept_one.cdr});
    ASSERT_TRUE(writer.finish());
    const auto world = value(WorldFile::open(folder_ / "a.mcap"));
    ASSERT_EQ(world->kept().size(), 1u);
    EXPECT_TRUE(std::ranges::equal(world->kept()[0].sample.raw.cdr, kept_one.cdr));
    EXPECT_EQ(world->kept()[0].sample.chunk->records.size(), kept_one.cdr.size());
    EXPECT_EQ(world->kept()[0].key, "alice");
}

TEST_F(WorldWriterTest, ShowsTextsOfTheFileAsOneLine) {
    auto writer = value(mcap::Writer::create(folder_ / "a.mcap", 1));
    mcap::Metadata metadata;
    metadata.name = "atrium";
    metadata.entries = {{"world", "a\x1b[2J\xFF"}, {"version", std::string(1000, 'x')}};
    ASSERT_TRUE(writer.add(metadata));
    ASSERT_TRUE(writer.add(mcap::Channel{0, "SiteMesh", "cdr", {}}));
    writer.write(0, {0, 0, kBegin, kBegin, recorded(mesh("alice", 1), kBegin).cdr});
    ASSERT_TRUE(writer.finish());
    const auto world = value(WorldFile::open(folder_ / "a.mcap"));
    EXPECT_EQ(world->world(), "a?[2J?");
    EXPECT_LT(world->version().size(), 300u);
}

}  // namespace
}  // namespace atrium::recording
