#include "core/mcap/compression.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/mcap_samples.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <limits>

// Files that want to make the reader crash, hang or take all memory.
namespace atrium::mcap {
namespace {

using namespace mcap::testing;

constexpr std::array<std::uint64_t, 8> kSizes{0,
                                              1,
                                              0x7F,
                                              0xFFFF,
                                              0x7FFFFFFF,
                                              0xFFFFFFFF,
                                              std::uint64_t{1} << 60U,
                                              std::numeric_limits<std::uint64_t>::max()};

class HostileMcap : public ::testing::Test {
protected:
    // Whatever the bytes are, opening and reading ends; what is read is one of the file's messages
    // where `is_checked` (a CRC protects them).
    void read_all(const Bytes& bytes) {
        write_bytes(folder_ / "a.mcap", bytes);
        const auto file = File::open(folder_ / "a.mcap");
        if (!file) {
            EXPECT_THAT(file.error().message, ::testing::HasSubstr("a.mcap"));
            return;
        }
        for (std::size_t i = 0; i < file->contents().chunks.size(); ++i) {
            const auto chunk = file->read(i);
            if (!chunk) {
                EXPECT_THAT(chunk.error().message, ::testing::HasSubstr("a.mcap: chunk "));
                continue;
            }
            for (const Message& message : chunk->messages)
                EXPECT_TRUE(std::ranges::binary_search(messages_, owned(message)));
        }
    }

    void make(std::size_t num_chunks, int messages_per_chunk) {
        messages_ = sorted(
            write_sample_file(folder_ / "good.mcap", num_chunks, messages_per_chunk).messages);
        bytes_ = bytes_of(folder_ / "good.mcap");
    }

    // The summary's CRC and the footer's are right again.
    static void sign(Bytes& bytes) {
        const std::size_t footer = bytes.size() - kMagic.size() - kRecordHeadBytes - 20;
        std::uint64_t summary = 0;
        std::memcpy(&summary, bytes.data() + footer + kRecordHeadBytes, sizeof(summary));
        const auto crc =
            crc32(std::span(bytes).subspan(summary, footer + kRecordHeadBytes + 16 - summary));
        std::memcpy(bytes.data() + footer + kRecordHeadBytes + 16, &crc, sizeof(crc));
    }
    static std::size_t summary_of(const Bytes& bytes) {
        std::uint64_t summary = 0;
        std::memcpy(&summary, bytes.data() + bytes.size() - kMagic.size() - 20, sizeof(summary));
        return summary;
    }

    test::TemporaryFolder folder_;
    std::vector<OwnMessage> messages_;
    Bytes bytes_;
};

TEST_F(HostileMcap, SurvivesAnySizeAtAnyPlaceOfTheFile) {
    make(2, 3);
    for (std::size_t at = kMagic.size(); at < bytes_.size(); ++at) {
        for (const std::uint64_t size : kSizes) {
            SCOPED_TRACE(std::to_string(at) + " " + std::to_string(size));
            Bytes bytes = bytes_;
            std::memcpy(bytes.data() + at, &size, std::min(sizeof(size), bytes.size() - at));
            read_all(bytes);
        }
    }
}

TEST_F(HostileMcap, SurvivesAnySizeInASummaryWithTheRightCrc) {
    make(2, 3);
    const std::size_t footer = bytes_.size() - kMagic.size() - kRecordHeadBytes - 20;
    for (std::size_t at = summary_of(bytes_); at < footer; ++at) {
        for (const std::uint64_t size : kSizes) {
            SCOPED_TRACE(std::to_string(at) + " " + std::to_string(size));
            Bytes bytes = bytes_;
            std::memcpy(bytes.data() + at, &size, std::min(sizeof(size), footer - at));
            sign(bytes);
            read_all(bytes);
        }
    }
}

TEST_F(HostileMcap, SurvivesRandomBytes) {
    make(2, 3);
    test::Random random(11);
    for (int i = 0; i < 2000; ++i) {
        Bytes bytes = bytes_;
        const int num = test::between(random, 1, 20);
        for (int k = 0; k < num; ++k) {
            const int at = test::between(random, 0, static_cast<int>(bytes.size()) - 1);
            bytes[static_cast<std::size_t>(at)] = std::byte(test::between(random, 0, 255));
        }
        read_all(bytes);
    }
}

// A file that is too long for memory, as a length that is damaged makes one: sparse, 1 TB.
TEST_F(HostileMcap, TakesNoMemoryForAChunkThatIsTooLong) {
    make(1, 3);
    Bytes bytes = bytes_;
    bytes.resize(summary_of(bytes) - kRecordHeadBytes - 4);  // without its end
    const std::size_t at = bytes.size();
    constexpr std::uint64_t kLength = std::uint64_t{1} << 40U;
    put(bytes, static_cast<std::uint8_t>(Opcode::kChunk));
    put(bytes, kLength);
    write_bytes(folder_ / "a.mcap", bytes);
    if (::truncate((folder_ / "a.mcap").c_str(),
                   static_cast<off_t>(at + kRecordHeadBytes + kLength)) != 0)
        return;  // no such files here
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->num_damaged_chunks(), 1u);
    EXPECT_EQ(sorted(messages_in(*file)), messages_);
    rusage use{};
    ::getrusage(RUSAGE_SELF, &use);
    EXPECT_LT(use.ru_maxrss, 4 << 20);  // [KiB]
}

TEST_F(HostileMcap, CountsMetadataOnce) {
    // 2000 indexes of the same large metadata would take 2000 times its memory.
    Contents contents;
    Bytes file;
    put_bytes(file, std::as_bytes(std::span(kMagic)));
    put_header(file);
    Metadata metadata;
    metadata.name = std::string(100'000, 'x');
    metadata.offset = file.size();
    put_metadata(file, metadata);
    metadata.length = file.size() - metadata.offset;
    contents.metadata.assign(2000, metadata);
    put_channel(file, 0, {0, "a", "cdr", {}});
    contents.channels[0] = {0, "a", "cdr", {}};
    ChunkBuilder builder;
    builder.add({0, 0, {5}, {5}, {}});
    ChunkIndex chunk{
        {5}, {5}, file.size(), 0, {}, 0, "", builder.records.size(), builder.records.size()};
    put_chunk_head(file, chunk, 0);
    put_bytes(file, builder.records);
    chunk.length = file.size() - chunk.offset;
    contents.chunks = {chunk};
    contents.num_messages[0] = 1;
    for (Metadata& one : contents.metadata) one.name = "short";  // the index's own name
    put_bytes(file, end_of_file(contents, file.size()));
    write_bytes(folder_ / "a.mcap", file);
    const auto opened = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(opened);
    EXPECT_NE(opened->fault(), "");  // its summary is not believed
    EXPECT_EQ(opened->contents().metadata.size(), 1u);
}

TEST_F(HostileMcap, TakesTheLastOfDoubleIds) {
    make(1, 4);
    Bytes bytes = bytes_;
    bytes.resize(summary_of(bytes) - kRecordHeadBytes - 4);
    put_channel(bytes, 0, {1, "other", "cdr", {}});
    put_schema(bytes, 1, {"other", "omgidl", ""});
    write_bytes(folder_ / "a.mcap", bytes);
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->contents().channels.size(), 2u);
    EXPECT_EQ(file->contents().channels.at(0).topic, "other");
    EXPECT_EQ(file->contents().schemas.at(1).name, "other");
}

TEST_F(HostileMcap, LeavesOutChunksInsideOfChunks) {
    ChunkBuilder inner;
    inner.add({0, 1, {5}, {5}, {}});
    ChunkBuilder outer;
    ChunkIndex head;
    head.size = head.compressed_size = inner.records.size();
    put_chunk_head(outer.records, head, 0);
    put_bytes(outer.records, inner.records);
    outer.add({0, 2, {6}, {6}, {}});
    Bytes file;
    put_bytes(file, std::as_bytes(std::span(kMagic)));
    put_header(file);
    head.size = head.compressed_size = outer.records.size();
    put_chunk_head(file, head, 0);
    put_bytes(file, outer.records);
    write_bytes(folder_ / "a.mcap", file);
    const auto opened = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(opened);
    const auto messages = messages_in(*opened);
    ASSERT_EQ(messages.size(), 1u);
    EXPECT_EQ(messages[0].sequence, 2u);
}

TEST_F(HostileMcap, RefusesTooManyChannels) {
    ChunkBuilder builder;
    for (std::uint32_t i = 0; i < 20'000; ++i)
        put_channel(builder.records, static_cast<std::uint16_t>(i), {0, "a", "cdr", {}});
    Bytes file;
    put_bytes(file, std::as_bytes(std::span(kMagic)));
    put_header(file);
    ChunkIndex head;
    head.size = head.compressed_size = builder.records.size();
    put_chunk_head(file, head, 0);
    put_bytes(file, builder.records);
    write_bytes(folder_ / "a.mcap", file);
    const auto opened = File::open(folder_ / "a.mcap");
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, ::testing::HasSubstr("no whole chunk"));
}

TEST(McapMap, OfAnyLengthEnds) {
    Bytes bytes;
    put_map(bytes, {{"a", "b"}, {"c", "d"}});
    ByteReader good(bytes);
    EXPECT_EQ(good.map(), (StringMap{{"a", "b"}, {"c", "d"}}));
    EXPECT_TRUE(good.ok());
    for (std::size_t at = 0; at + 4 <= bytes.size(); ++at) {
        for (const std::uint64_t size : kSizes) {
            Bytes damaged = bytes;
            std::memcpy(damaged.data() + at, &size, 4);
            ByteReader in(damaged);
            EXPECT_LE(in.map().size(), bytes.size() / 8);
        }
    }
}

}  // namespace
}  // namespace atrium::mcap
