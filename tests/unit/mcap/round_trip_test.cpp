#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/mcap_samples.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/resource.h>

#include <csignal>

namespace atrium::mcap {
namespace {

using namespace mcap::testing;

class McapRoundTrip : public ::testing::Test {
protected:
    test::TemporaryFolder folder_;
};

TEST_F(McapRoundTrip, KeepsRandomMessagesOfRandomLanesAndChunks) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        test::Random random(seed);
        const auto path = folder_ / ("a" + std::to_string(seed) + ".mcap");
        const auto num_lanes = static_cast<std::size_t>(test::between(random, 1, 3));
        auto writer = Writer::create(path, num_lanes);
        ASSERT_TRUE(writer);
        const auto schema = writer->add(Schema{"s", "omgidl", "text"});
        ASSERT_EQ(*schema, 1);
        const auto num_channels = static_cast<std::uint16_t>(test::between(random, 1, 5));
        for (std::uint16_t i = 0; i < num_channels; ++i)
            ASSERT_EQ(*writer->add(Channel{1, "topic" + std::to_string(i), "cdr", {}}), i);
        std::vector<OwnMessage> written;
        std::map<std::uint16_t, std::uint64_t> nums;
        std::int64_t now = 1'700'000'000'000'000'000;
        const int num = test::between(random, 1, 400);
        for (int i = 0; i < num; ++i) {
            now += test::between(random, -1000, 1'000'000);  // not always in order
            auto message = random_message(
                random,
                static_cast<std::uint16_t>(test::between(random, 0, num_channels - 1)),
                now);
            message.sequence = static_cast<std::uint32_t>(nums[message.channel]++);
            const auto lane =
                static_cast<std::size_t>(test::between(random, 0, static_cast<int>(num_lanes) - 1));
            writer->write(lane, message.view());
            written.push_back(std::move(message));
            if (test::between(random, 0, 20) == 0) {
                ASSERT_TRUE(writer->flush(lane));
            }
        }
        ASSERT_TRUE(writer->finish());

        const auto file = File::open(path);
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_EQ(file->fault(), "");
        EXPECT_EQ(file->num_damaged_chunks(), 0u);
        EXPECT_EQ(sorted(messages_in(*file)), sorted(written));
        EXPECT_EQ(file->contents().num_messages, nums);
        EXPECT_EQ(file->contents().channels.size(), num_channels);
        EXPECT_EQ(std::filesystem::file_size(path), writer->num_bytes());
    }
}

TEST_F(McapRoundTrip, TellsTheTimesAndPlacesOfEachChunk) {
    const SampleFile sample = write_sample_file(folder_ / "a.mcap", 5, 20);
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    ASSERT_EQ(file->contents().chunks.size(), 5u);
    const Bytes bytes = bytes_of(folder_ / "a.mcap");
    for (std::size_t i = 0; i < 5; ++i) {
        const ChunkIndex& chunk = file->contents().chunks[i];
        EXPECT_EQ(chunk.first.ns, sample.chunks[i].front().log_ns);
        EXPECT_EQ(chunk.last.ns, sample.chunks[i].back().log_ns);
        EXPECT_EQ(bytes[chunk.offset], std::byte(Opcode::kChunk));
        ASSERT_EQ(chunk.message_indexes.size(), 2u);
        for (const auto& [channel, at] : chunk.message_indexes)
            EXPECT_EQ(bytes[at], std::byte(Opcode::kMessageIndex));
        EXPECT_EQ(chunk.message_indexes.begin()->second, chunk.offset + chunk.length);
    }
}

TEST_F(McapRoundTrip, KeepsSchemasChannelsAndMetadata) {
    write_sample_file(folder_ / "a.mcap", 1, 2);
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    const Contents& contents = file->contents();
    ASSERT_EQ(contents.schemas.size(), 1u);
    EXPECT_EQ(contents.schemas.at(1).name, "t");
    EXPECT_EQ(contents.schemas.at(1).encoding, "omgidl");
    EXPECT_EQ(contents.schemas.at(1).data, "struct t {};");
    ASSERT_EQ(contents.channels.size(), 2u);
    EXPECT_EQ(contents.channels.at(1).topic, "b");
    EXPECT_EQ(contents.channels.at(1).schema, 1);
    EXPECT_EQ(contents.channels.at(1).metadata, (StringMap{{"key", "value"}}));
    ASSERT_EQ(contents.metadata.size(), 1u);
    EXPECT_EQ(contents.metadata[0].name, "atrium");
    EXPECT_EQ(contents.metadata[0].entries, (StringMap{{"world", "w"}}));
}

TEST_F(McapRoundTrip, KeepsTheOrderOfEqualTimes) {
    auto writer = Writer::create(folder_ / "a.mcap", 1);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add(Channel{0, "a", "cdr", {}}));
    for (std::uint32_t i = 0; i < 100; ++i) writer->write(0, {0, i, {5}, {5}, {}});
    ASSERT_TRUE(writer->finish());
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    const auto chunk = file->read(0);
    ASSERT_TRUE(chunk);
    for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(chunk->messages[i].sequence, i);
}

TEST_F(McapRoundTrip, RefusesAFileThatExists) {
    write_sample_file(folder_ / "a.mcap", 1, 2);
    const auto writer = Writer::create(folder_ / "a.mcap", 1);
    ASSERT_FALSE(writer);
    EXPECT_EQ(writer.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(writer.error().message, ::testing::HasSubstr("a.mcap: the file exists"));
}

TEST_F(McapRoundTrip, FinishesOnce) {
    auto writer = Writer::create(folder_ / "a.mcap", 1);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add(Channel{0, "a", "cdr", {}}));
    writer->write(0, {0, 0, {5}, {5}, {}});
    ASSERT_TRUE(writer->finish());
    const auto size = std::filesystem::file_size(folder_ / "a.mcap");
    ASSERT_TRUE(writer->finish());
    EXPECT_EQ(std::filesystem::file_size(folder_ / "a.mcap"), size);
}

TEST_F(McapRoundTrip, ReadsAFileThatIsStillWrittenAndDoesNotRepairIt) {
    auto writer = Writer::create(folder_ / "a.mcap", 1);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add(Channel{0, "a", "cdr", {}}));
    writer->write(0, {0, 0, {5}, {5}, {}});
    ASSERT_TRUE(writer->flush(0));
    writer->write(0, {0, 1, {6}, {6}, {}});

    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_TRUE(file->is_being_written());
    EXPECT_EQ(messages_in(*file).size(), 1u);
    const auto size = std::filesystem::file_size(folder_ / "a.mcap");
    const auto repaired = repair(folder_ / "a.mcap");
    ASSERT_FALSE(repaired);
    EXPECT_EQ(repaired.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(repaired.error().message, ::testing::HasSubstr("still being written"));
    EXPECT_EQ(std::filesystem::file_size(folder_ / "a.mcap"), size);

    ASSERT_TRUE(writer->finish());
    const auto finished = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(finished);
    EXPECT_EQ(finished->fault(), "");
    EXPECT_EQ(messages_in(*finished).size(), 2u);
}

// Two readers at once must not take each other for a writer.
TEST_F(McapRoundTrip, IsNotBeingWrittenOnlyBecauseAnotherReads) {
    write_sample_file(folder_ / "a.mcap", 1, 2, /*is_finished=*/false);
    const Descriptor other(::open((folder_ / "a.mcap").c_str(), O_RDONLY));
    ASSERT_EQ(::flock(other.get(), LOCK_SH), 0);
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_FALSE(file->is_being_written());
}

TEST_F(McapRoundTrip, LosesNothingButTheChunkOnAFullDisk) {
    // A descriptor that cannot grow: the limit of the file's size is that of a full disk.
    const auto path = folder_ / "a.mcap";
    const OwnMessage small{0, 0, 5, 5, Bytes(100)};
    OwnMessage large{0, 1, 6, 6, Bytes(300'000)};
    test::Random random(1);
    for (std::byte& byte : large.data) byte = std::byte(test::between(random, 0, 255));
    std::map<std::uint16_t, std::uint64_t> lost;
    const auto write_all = [&] {
        struct sigaction ignore {};
        ignore.sa_handler = SIG_IGN;
        ::sigaction(SIGXFSZ, &ignore, nullptr);
        rlimit limit{};
        ::getrlimit(RLIMIT_FSIZE, &limit);
        const rlimit old = limit;
        auto writer = Writer::create(path, 1);
        ASSERT_TRUE(writer);
        ASSERT_TRUE(writer->add(Channel{0, "a", "cdr", {}}));
        writer->write(0, small.view());
        ASSERT_TRUE(writer->flush(0));
        limit.rlim_cur = 100'000;
        ::setrlimit(RLIMIT_FSIZE, &limit);
        writer->write(0, large.view());
        const auto flushed = writer->flush(0);
        writer->write(0, large.view());
        const auto finished = writer->finish();
        lost = writer->lost();
        ::setrlimit(RLIMIT_FSIZE, &old);
        EXPECT_FALSE(flushed);
        EXPECT_FALSE(finished);
        EXPECT_THAT(flushed.error().message, ::testing::HasSubstr("a.mcap"));
    };
    write_all();
    EXPECT_EQ(lost, (std::map<std::uint16_t, std::uint64_t>{{0, 2}}));
    const auto file = File::open(path);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->fault(), "");  // the summary found room
    EXPECT_EQ(messages_in(*file), std::vector{small});
}

}  // namespace
}  // namespace atrium::mcap
