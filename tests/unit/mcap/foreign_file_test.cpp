#include "core/mcap/compression.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/mcap_samples.hpp"

#include <gmock/gmock.h>
#include <lz4frame.h>

// Files as other programs write them.
namespace atrium::mcap {
namespace {

using namespace mcap::testing;

Bytes compressed(const std::string& method, const Bytes& records) {
    if (method.empty()) return records;
    Bytes out;
    if (method == "zstd") {
        EXPECT_TRUE(ZstdCompressor().compress(records, out));
        return out;
    }
    out.resize(LZ4F_compressFrameBound(records.size(), nullptr));
    out.resize(LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), nullptr));
    return out;
}

// Schemas and channels are in the chunk, as the libraries of mcap.dev write them.
ChunkBuilder foreign_chunk(std::vector<OwnMessage>& messages) {
    ChunkBuilder builder;
    put_schema(builder.records, 3, {"pkg/Type", "ros2msg", "int32 a"});
    put_channel(builder.records, 9, {3, "/topic", "cdr", {}});
    test::Random random(3);
    for (int i = 0; i < 50; ++i) {
        messages.push_back(random_message(random, 9, 1'000'000'000 - i * 1000));  // backwards
        builder.add(messages.back().view());
    }
    return builder;
}

void put_chunk(Bytes& out, const std::string& method, const ChunkBuilder& builder, bool has_crc) {
    const Bytes packed = compressed(method, builder.records);
    ChunkIndex chunk;
    chunk.first = builder.first;
    chunk.last = builder.last;
    chunk.compression = method;
    chunk.compressed_size = packed.size();
    chunk.size = builder.records.size();
    put_chunk_head(out, chunk, has_crc ? crc32(builder.records) : 0);
    put_bytes(out, packed);
}

// The index of the first chunk names where its messages are among its records.
void check_places(const File& file, const Bytes& bytes) {
    const auto chunk = file.read(0);
    ASSERT_TRUE(chunk);
    auto rest = std::span(bytes).subspan(file.contents().chunks[0].message_indexes.at(9));
    const auto index = next_record(rest);
    ASSERT_TRUE(index);
    ByteReader in(index->content);
    EXPECT_EQ(in.get<std::uint16_t>(), 9);
    EXPECT_EQ(in.get<std::uint32_t>(), 16 * chunk->messages.size());
    while (!in.rest().empty()) {
        const auto time = in.get<std::int64_t>();
        auto records = std::span(chunk->records).subspan(in.get<std::uint64_t>());
        const auto record = next_record(records);
        ASSERT_TRUE(record);
        ASSERT_EQ(record->opcode, Opcode::kMessage);
        EXPECT_EQ(read_message(record->content)->log_time.ns, time);
    }
}

class ForeignMcap : public ::testing::TestWithParam<const char*> {
protected:
    test::TemporaryFolder folder_;
};

TEST_P(ForeignMcap, ReadsChunksWithSchemasAndWithoutIndexes) {
    for (const bool has_crc : {true, false}) {
        std::vector<OwnMessage> messages;
        Bytes file;
        put_bytes(file, std::as_bytes(std::span(kMagic)));
        put_header(file);
        put_chunk(file, GetParam(), foreign_chunk(messages), has_crc);
        put_bytes(file, end_of_file({}, file.size()));  // a summary without anything
        write_bytes(folder_ / "a.mcap", file);
        auto opened = File::open(folder_ / "a.mcap");
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_EQ(opened->contents().schemas.at(3).name, "pkg/Type");
        EXPECT_EQ(opened->contents().channels.at(9).topic, "/topic");
        EXPECT_EQ(opened->contents().num_messages.at(9), 50u);
        EXPECT_EQ(sorted(messages_in(*opened)), sorted(messages));

        ASSERT_TRUE(repair(folder_ / "a.mcap"));
        opened = File::open(folder_ / "a.mcap");
        ASSERT_TRUE(opened);
        EXPECT_EQ(opened->fault(), "");
        EXPECT_EQ(opened->contents().channels.at(9).topic, "/topic");
        EXPECT_EQ(sorted(messages_in(*opened)), sorted(messages));
        check_places(*opened, bytes_of(folder_ / "a.mcap"));
    }
}

TEST_P(ForeignMcap, RefusesAChunkOfAnotherLength) {
    std::vector<OwnMessage> messages;
    const ChunkBuilder builder = foreign_chunk(messages);
    const Bytes packed = compressed(GetParam(), builder.records);
    EXPECT_TRUE(decompress(GetParam(), packed, builder.records.size()));
    for (const std::int64_t other : {-1, 1, 1000}) {
        const auto size = builder.records.size() + static_cast<std::size_t>(other);
        const auto got = decompress(GetParam(), packed, size);
        ASSERT_FALSE(got);
        EXPECT_EQ(got.error().kind, ErrorKind::kInvalidData);
    }
    EXPECT_FALSE(decompress(GetParam(), packed, std::uint64_t{1} << 60U));
    EXPECT_FALSE(
        decompress(GetParam(), std::span(packed).first(packed.size() / 2), builder.records.size()));
}

INSTANTIATE_TEST_SUITE_P(Compressions, ForeignMcap, ::testing::Values("", "lz4", "zstd"));

TEST(ForeignMcapFile, WithMessagesOutsideOfChunksIsRefused) {
    const test::TemporaryFolder folder;
    Bytes file;
    put_bytes(file, std::as_bytes(std::span(kMagic)));
    put_header(file);
    put_channel(file, 0, {0, "a", "cdr", {}});
    put_message(file, {0, 0, {5}, {5}, {}});
    put_bytes(file, end_of_file({}, file.size()));
    write_bytes(folder / "a.mcap", file);
    const auto opened = File::open(folder / "a.mcap");
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, ::testing::HasSubstr("messages outside of chunks"));
    const Bytes before = bytes_of(folder / "a.mcap");
    EXPECT_FALSE(repair(folder / "a.mcap"));
    EXPECT_EQ(bytes_of(folder / "a.mcap"), before);
}

TEST(ForeignMcapFile, WithRecordsOfTheFutureIsRead) {
    const test::TemporaryFolder folder;
    std::vector<OwnMessage> messages;
    Bytes file;
    put_bytes(file, std::as_bytes(std::span(kMagic)));
    put_header(file);
    for (const int opcode : {0x09, 0x0A, 0x7F, 0x80, 0xFF}) {  // attachments, and unknown ones
        put(file, static_cast<std::uint8_t>(opcode));
        put(file, std::uint64_t{100});
        file.resize(file.size() + 100);
    }
    put_chunk(file, "zstd", foreign_chunk(messages), true);
    write_bytes(folder / "a.mcap", file);
    const auto opened = File::open(folder / "a.mcap");
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(messages_in(*opened).size(), messages.size());
}

}  // namespace
}  // namespace atrium::mcap
