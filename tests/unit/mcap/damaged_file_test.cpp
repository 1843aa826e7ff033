#include "tests/support/temporary_folder.hpp"
#include "tests/unit/mcap/mcap_samples.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

namespace atrium::mcap {
namespace {

using namespace mcap::testing;

// Messages of all chunks that end within the first `size` bytes.
std::vector<OwnMessage> whole_within(const SampleFile& sample,
                                     const std::vector<ChunkIndex>& chunks,
                                     std::uint64_t size) {
    std::vector<OwnMessage> messages;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        if (chunks[i].offset + chunks[i].length > size) break;
        messages.insert(messages.end(), sample.chunks[i].begin(), sample.chunks[i].end());
    }
    return messages;
}

class DamagedMcap : public ::testing::Test {
protected:
    void make(std::size_t num_chunks, int messages_per_chunk) {
        sample_ = write_sample_file(folder_ / "whole.mcap", num_chunks, messages_per_chunk);
        bytes_ = bytes_of(folder_ / "whole.mcap");
        const auto file = File::open(folder_ / "whole.mcap");
        ASSERT_TRUE(file);
        chunks_ = file->contents().chunks;
    }

    // All complete chunks or a clear error; and what `repair` makes of it.
    void check_cut(std::size_t size) {
        SCOPED_TRACE(size);
        const auto path = folder_ / "cut.mcap";
        write_bytes(path, std::span(bytes_).first(size));
        const auto expected = whole_within(sample_, chunks_, size);
        const auto file = File::open(path);
        const auto repaired = repair(path);
        if (expected.empty()) {
            ASSERT_FALSE(file);
            EXPECT_EQ(file.error().kind, ErrorKind::kInvalidData);
            EXPECT_THAT(file.error().message, ::testing::HasSubstr("cut.mcap: it "));
            ASSERT_FALSE(repaired);
            return;
        }
        ASSERT_TRUE(file) << file.error().message;
        EXPECT_NE(file->fault(), "");
        EXPECT_EQ(messages_in(*file), expected);
        ASSERT_TRUE(repaired) << repaired.error().message;
        const auto whole = File::open(path);
        ASSERT_TRUE(whole) << whole.error().message;
        EXPECT_EQ(whole->fault(), "");
        EXPECT_EQ(messages_in(*whole), expected);
        EXPECT_EQ(whole->contents().channels.size(), 2u);
        EXPECT_EQ(whole->contents().metadata.size(), 1u);
        std::uint64_t num = 0;
        for (const auto& [channel, count] : whole->contents().num_messages) num += count;
        EXPECT_EQ(num, expected.size());
        check_indexes(*whole, bytes_of(path));
    }

    // Each chunk's index names places where there are index records of its channels.
    static void check_indexes(const File& file, const Bytes& bytes) {
        for (const ChunkIndex& chunk : file.contents().chunks) {
            EXPECT_EQ(bytes.at(chunk.offset), std::byte(Opcode::kChunk));
            EXPECT_FALSE(chunk.message_indexes.empty());
            std::uint64_t length = 0;
            for (const auto& [channel, at] : chunk.message_indexes) {
                auto rest = std::span(bytes).subspan(at);
                const auto record = next_record(rest);
                ASSERT_TRUE(record);
                EXPECT_EQ(record->opcode, Opcode::kMessageIndex);
                ByteReader in(record->content);
                EXPECT_EQ(in.get<std::uint16_t>(), channel);
                length += kRecordHeadBytes + record->content.size();
            }
            EXPECT_EQ(chunk.message_index_length, length);
        }
    }

    test::TemporaryFolder folder_;
    SampleFile sample_;
    Bytes bytes_;
    std::vector<ChunkIndex> chunks_;
};

TEST_F(DamagedMcap, OpensCutAtEveryByteOfASmallFile) {
    make(3, 4);
    for (std::size_t size = 0; size < bytes_.size(); ++size) check_cut(size);
}

TEST_F(DamagedMcap, OpensCutAtEveryThousandthByteOfALargerFile) {
    make(12, 200);
    ASSERT_GT(bytes_.size(), 200'000u);
    for (std::size_t size = 0; size < bytes_.size(); size += 1000) check_cut(size);
}

TEST_F(DamagedMcap, LosesOnlyTheDamagedChunk) {
    make(5, 20);
    // In its records, where its CRC or zstd finds it.
    const std::size_t at = chunks_[2].offset + chunks_[2].length / 2;
    bytes_[at] ^= std::byte{0x55};
    std::vector<OwnMessage> rest;
    for (const std::size_t i : {0u, 1u, 3u, 4u})
        rest.insert(rest.end(), sample_.chunks[i].begin(), sample_.chunks[i].end());
    write_bytes(folder_ / "a.mcap", bytes_);

    // With its summary: reading the chunk fails.
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->fault(), "");
    const auto damaged = file->read(2);
    ASSERT_FALSE(damaged);
    EXPECT_EQ(damaged.error().kind, ErrorKind::kInvalidData);
    EXPECT_THAT(damaged.error().message, ::testing::HasSubstr("a.mcap: chunk 3 of 5: "));
    EXPECT_TRUE(file->read(3));

    // Without: the search leaves it out, and so does the repaired file.
    bytes_.resize(chunks_[4].offset + chunks_[4].length);
    write_bytes(folder_ / "b.mcap", bytes_);
    const auto searched = File::open(folder_ / "b.mcap");
    ASSERT_TRUE(searched);
    EXPECT_EQ(searched->num_damaged_chunks(), 1u);
    EXPECT_EQ(messages_in(*searched), rest);
    ASSERT_TRUE(repair(folder_ / "b.mcap"));
    const auto repaired = File::open(folder_ / "b.mcap");
    ASSERT_TRUE(repaired);
    EXPECT_EQ(repaired->fault(), "");
    EXPECT_EQ(messages_in(*repaired), rest);
    check_indexes(*repaired, bytes_of(folder_ / "b.mcap"));
}

// The indexes of the chunk in front of a damaged last one were lost, and the summary named them.
TEST_F(DamagedMcap, RepairsAFileWhoseLastChunkIsDamaged) {
    make(3, 20);
    bytes_[chunks_[2].offset + chunks_[2].length / 2] ^= std::byte{0x55};
    bytes_.resize(chunks_[2].offset + chunks_[2].length);
    write_bytes(folder_ / "a.mcap", bytes_);
    ASSERT_TRUE(repair(folder_ / "a.mcap"));
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->contents().chunks.size(), 2u);
    check_indexes(*file, bytes_of(folder_ / "a.mcap"));
}

TEST_F(DamagedMcap, ReadsWhatIsInFrontOfZeros) {
    make(4, 20);
    bytes_.resize(chunks_[2].offset);
    bytes_.resize(bytes_.size() + 5000);  // as after a loss of power
    write_bytes(folder_ / "a.mcap", bytes_);
    const auto file = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(file);
    EXPECT_THAT(file->fault(), ::testing::HasSubstr("damaged at byte"));
    EXPECT_EQ(file->contents().chunks.size(), 2u);
    ASSERT_TRUE(repair(folder_ / "a.mcap"));
    const auto repaired = File::open(folder_ / "a.mcap");
    ASSERT_TRUE(repaired);
    EXPECT_EQ(repaired->fault(), "");
    EXPECT_EQ(messages_in(*repaired), messages_in(*file));
}

TEST_F(DamagedMcap, SearchesAFileWithADamagedSummary) {
    make(3, 20);
    for (std::size_t from_end = 1; from_end < 300; ++from_end) {
        SCOPED_TRACE(from_end);
        Bytes damaged = bytes_;
        damaged[damaged.size() - from_end] ^= std::byte{0xFF};
        write_bytes(folder_ / "a.mcap", damaged);
        const auto file = File::open(folder_ / "a.mcap");
        ASSERT_TRUE(file);
        EXPECT_EQ(messages_in(*file), sample_.messages);
    }
}

TEST_F(DamagedMcap, RepairsACompleteFileWithoutChange) {
    make(3, 20);
    ASSERT_TRUE(repair(folder_ / "whole.mcap"));
    const auto file = File::open(folder_ / "whole.mcap");
    ASSERT_TRUE(file);
    EXPECT_EQ(file->fault(), "");
    EXPECT_EQ(messages_in(*file), sample_.messages);
    EXPECT_EQ(bytes_of(folder_ / "whole.mcap"), bytes_);
}

TEST_F(DamagedMcap, TellsWhatIsNoRecording) {
    write_bytes(folder_ / "a.mcap",
                std::as_bytes(std::span(std::string_view("hello, this is text"))));
    auto file = File::open(folder_ / "a.mcap");
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().message, ::testing::HasSubstr("a.mcap: it is no MCAP file"));
    file = File::open(folder_ / "missing.mcap");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().kind, ErrorKind::kNotFound);
    file = File::open(folder_ / ".");
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().message, ::testing::HasSubstr("no regular file"));
    ASSERT_EQ(::mkfifo((folder_ / "fifo.mcap").c_str(), 0600), 0);
    file = File::open(folder_ / "fifo.mcap");  // does not wait for a writer
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().message, ::testing::HasSubstr("no regular file"));
}

}  // namespace
}  // namespace atrium::mcap
