#pragma once

#include "core/mcap/file.hpp"
#include "core/mcap/writer.hpp"
#include "tests/support/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

/// Messages and files for the tests of core/mcap.
namespace atrium::mcap::testing {

/// A message that owns its data.
struct OwnMessage {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::int64_t log_ns = 0;
    std::int64_t publish_ns = 0;
    Bytes data;

    auto operator<=>(const OwnMessage&) const = default;
    friend void PrintTo(const OwnMessage& message, std::ostream* out) {
        *out << message.channel << '/' << message.sequence << '@' << message.log_ns;
    }
    Message view() const { return {channel, sequence, {log_ns}, {publish_ns}, data}; }
};

inline OwnMessage owned(const Message& message) {
    return {message.channel,
            message.sequence,
            message.log_time.ns,
            message.publish_time.ns,
            Bytes(message.data.begin(), message.data.end())};
}

inline OwnMessage random_message(test::Random& random, std::uint16_t channel, std::int64_t ns) {
    OwnMessage message{channel, 0, ns, ns - test::between(random, 0, 1'000'000), {}};
    message.data.resize(static_cast<std::size_t>(test::between(random, 0, 300)));
    for (std::byte& byte : message.data) byte = std::byte(test::between(random, 0, 255));
    return message;
}

/// All messages of a file, chunk by chunk; fails the test if one cannot be read.
inline std::vector<OwnMessage> messages_in(const File& file) {
    std::vector<OwnMessage> all;
    for (std::size_t i = 0; i < file.contents().chunks.size(); ++i) {
        const auto chunk = file.read(i);
        EXPECT_TRUE(chunk) << chunk.error().message;
        if (!chunk) continue;
        EXPECT_TRUE(std::ranges::is_sorted(chunk->messages, {}, &Message::log_time));
        for (const Message& message : chunk->messages) all.push_back(owned(message));
    }
    return all;
}

inline std::vector<OwnMessage> sorted(std::vector<OwnMessage> messages) {
    std::ranges::sort(messages);
    return messages;
}

inline Bytes bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

inline void write_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
    std::filesystem::remove(file);  // ext4 syncs a file that is replaced by truncation
    std::ofstream stream(file, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(stream.flush());
}

/// A file of `num_chunks` chunks in two lanes, with a schema, two channels and metadata.
struct SampleFile {
    std::vector<std::vector<OwnMessage>> chunks;
    std::vector<OwnMessage> messages;  // of all chunks
};
inline SampleFile write_sample_file(const std::filesystem::path& path,
                                    std::size_t num_chunks,
                                    int messages_per_chunk,
                                    bool is_finished = true) {
    test::Random random(7);
    auto writer = Writer::create(path, 2);
    EXPECT_TRUE(writer);
    const auto schema = writer->add(Schema{"t", "omgidl", "struct t {};"});
    EXPECT_TRUE(writer->add(Channel{*schema, "a", "cdr", {}}));
    EXPECT_TRUE(writer->add(Channel{*schema, "b", "cdr", {{"key", "value"}}}));
    Metadata metadata;
    metadata.name = "atrium";
    metadata.entries = {{"world", "w"}};
    EXPECT_TRUE(writer->add(metadata));
    SampleFile file;
    std::int64_t now = 1'000'000'000;
    for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) {
        file.chunks.emplace_back();
        for (int i = 0; i < messages_per_chunk; ++i) {
            now += test::between(random, 0, 1'000'000);
            auto message = random_message(random, static_cast<std::uint16_t>(i % 2), now);
            message.sequence = static_cast<std::uint32_t>(file.messages.size());
            writer->write(chunk % 2, message.view());
            file.chunks.back().push_back(message);
            file.messages.push_back(std::move(message));
        }
        EXPECT_TRUE(writer->flush(chunk % 2));
    }
    if (is_finished) {
        EXPECT_TRUE(writer->finish());
    }
    return file;
}

}  // namespace atrium::mcap::testing
