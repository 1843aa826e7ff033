#include "core/bus/cdr.hpp"

#include "core/bus/raw_samples.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"
#include "tests/support/cdr_type.hpp"
#include "tests/unit/bus/all_messages.hpp"
#include "tests/unit/bus/random_messages.hpp"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <gmock/gmock.h>

#include <cstring>
#include <set>

namespace atrium::bus {
namespace {

using testing::Random;
using testing::random_message;
using testing::same;

// A message and its wire struct, whose sequences are those of the message.
template <typename Message>
struct WireOfMessage {
    explicit WireOfMessage(Message sample) : message(std::move(sample)) {
        to_wire(message, scratch, wire);
    }
    Message message;
    WireScratch scratch;
    WireOf<Message> wire{};
};

// What wire_of makes of bytes; freed at the end of the scope.
template <typename Message>
struct Decoded {
    explicit Decoded(std::span<const std::byte> cdr)
        : result(wire_of(Topic<Message>::kDescriptor, cdr, &wire)) {}
    Decoded(const Decoded&) = delete;
    Decoded& operator=(const Decoded&) = delete;
    ~Decoded() { free_wire(Topic<Message>::kDescriptor, &wire); }
    WireOf<Message> wire{};
    Expected<void> result;
};

std::vector<std::byte> as_bytes(const std::vector<std::uint8_t>& payload) {
    const auto bytes = std::as_bytes(std::span(payload));
    return {bytes.begin(), bytes.end()};
}

template <typename Message>
test::CdrType cyclones_type() {
    Random random(1);
    const WireOfMessage<Message> good(random_message<Message>(random));
    return test::CdrType(Topic<Message>::kDescriptor, Topic<Message>::kName, &good.wire);
}

template <typename Message>
class EveryRawMessage : public ::testing::Test {};
TYPED_TEST_SUITE(EveryRawMessage, testing::RawMessages);

// Cyclone pads its payload to four bytes and says in the header by how many.
TYPED_TEST(EveryRawMessage, HasTheBytesThatCycloneSends) {
    const test::CdrType type = cyclones_type<TypeParam>();
    Random random(2);
    for (int round = 0; round < 20; ++round) {
        const auto message = random_message<TypeParam>(random);
        const WireOfMessage<TypeParam> wire(message);
        auto sent = as_bytes(type.payload_of(&wire.wire, SDK_DATA));
        const auto padding = std::to_integer<std::size_t>(sent.at(3));
        ASSERT_LT(padding, 4u);
        sent[3] = std::byte{0};
        sent.resize(sent.size() - padding);
        EXPECT_EQ(to_cdr(message), sent);
    }
}

TYPED_TEST(EveryRawMessage, SurvivesItsBytes) {
    Random random(3);
    for (int round = 0; round < 50; ++round) {
        const auto message = random_message<TypeParam>(random);
        const auto cdr = to_cdr(message);
        const auto back = from_raw<TypeParam>({RawKind::kSample, {}, cdr});
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_TRUE(same(message, *back));
        EXPECT_EQ(to_cdr(*back), cdr);
        const Decoded<TypeParam> decoded(cdr);
        ASSERT_TRUE(decoded.result);
        EXPECT_EQ(cdr_of(Topic<TypeParam>::kDescriptor, &decoded.wire), cdr);
    }
}

TYPED_TEST(EveryRawMessage, ReadsBigEndianBytes) {
    Random random(4);
    for (int round = 0; round < 20; ++round) {
        const auto message = random_message<TypeParam>(random);
        const WireOfMessage<TypeParam> wire(message);
        dds_ostreamBE_t stream;
        dds_ostreamBE_init(&stream, 256, CDR_ENC_VERSION_1);
        dds_stream_writeBE(&stream,
                           reinterpret_cast<const char*>(&wire.wire),
                           Topic<TypeParam>::kDescriptor.m_ops);
        std::vector<std::byte> cdr(4 + stream.x.m_index);
        std::memcpy(cdr.data() + 4, stream.x.m_buffer, stream.x.m_index);
        dds_ostreamBE_fini(&stream);
        const auto back = from_raw<TypeParam>({RawKind::kSample, {}, cdr});
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_TRUE(same(message, *back));
    }
}

// Whatever Cyclone would not read from the network is refused, and nothing else.
TYPED_TEST(EveryRawMessage, RefusesDamagedBytesAsCycloneDoes) {
    const test::CdrType type = cyclones_type<TypeParam>();
    Random random(5);
    int num_refused = 0;
    const auto check = [&](const std::vector<std::byte>& cdr) {
        std::vector<std::uint8_t> payload(cdr.size());
        std::transform(cdr.begin(), cdr.end(), payload.begin(), [](std::byte byte) {
            return std::to_integer<std::uint8_t>(byte);
        });
        const bool is_accepted = type.accept(payload, SDK_DATA) != nullptr;
        const Decoded<TypeParam> decoded(cdr);
        EXPECT_EQ(decoded.result.has_value(), is_accepted);
        num_refused += decoded.result ? 0 : 1;
        if (!decoded.result) {
            EXPECT_EQ(decoded.result.error().kind, ErrorKind::kInvalidData);
        }
    };
    for (int round = 0; round < 10; ++round) {
        const auto cdr = to_cdr(random_message<TypeParam>(random));
        const std::size_t step = 1 + cdr.size() / 100;
        for (std::size_t size = 4; size < cdr.size(); size += step) {
            auto cut = cdr;
            cut.resize(size);
            check(cut);
        }
        for (int change = 0; change < 100; ++change) {
            auto damaged = cdr;
            const auto at = 4 + random() % (damaged.size() - 4);
            damaged[at] = std::byte(random() % 256);
            check(damaged);
        }
        std::vector<std::byte> noise(4 + random() % 200);
        for (std::byte& byte : noise) byte = std::byte(random() % 256);
        noise[0] = noise[2] = noise[3] = std::byte{0};
        noise[1] = std::byte(random() % 2);
        check(noise);
    }
    EXPECT_GT(num_refused, 0);
}

TYPED_TEST(EveryRawMessage, RefusesWhatIsNoCdrOfVersion1) {
    Random random(6);
    const auto cdr = to_cdr(random_message<TypeParam>(random));
    for (const int second : {2, 3, 6, 7, 8, 9, 10, 11, 255}) {
        auto other = cdr;
        other[1] = std::byte(second);
        EXPECT_FALSE(from_raw<TypeParam>({RawKind::kSample, {}, other}));
    }
    for (std::size_t size = 0; size < 4; ++size)
        EXPECT_FALSE(from_raw<TypeParam>({RawKind::kSample, {}, std::span(cdr).first(size)}));
}

TYPED_TEST(EveryRawMessage, HasAKeyOfItsOwn) {
    const RawTopic* const topic = find_raw_topic(topic_name<TypeParam>());
    ASSERT_NE(topic, nullptr);
    EXPECT_EQ(topic->name(), Topic<TypeParam>::kName);
    Random random(7);
    for (int round = 0; round < 20; ++round) {
        const auto message = random_message<TypeParam>(random);
        const auto cdr = to_cdr(message);
        const auto key = topic->key_of({RawKind::kSample, {}, cdr});
        ASSERT_TRUE(key);
        EXPECT_NE(*key, "");
        const auto short_cdr = topic->key_cdr({RawKind::kSample, {}, cdr});
        ASSERT_TRUE(short_cdr);
        // The end of the instance has the same key.
        EXPECT_EQ(topic->key_of({RawKind::kDisposed, {}, *short_cdr}).value(), *key);
        const auto holder = from_raw<TypeParam>({RawKind::kLost, {}, *short_cdr});
        ASSERT_TRUE(holder) << holder.error().message;
    }
}

TEST(RawTopics, AreAllOfAWorldAndOfOneNameEach) {
    std::set<std::string_view> names;
    for (const RawTopic* topic : raw_topics()) {
        EXPECT_TRUE(names.insert(topic->name()).second);
        EXPECT_EQ(find_raw_topic(topic->name()), topic);
        EXPECT_THAT(std::string(kIdl),
                    ::testing::HasSubstr("@topic struct " + std::string(topic->name()) + " "));
    }
    EXPECT_EQ(find_raw_topic("CameraSilhouette"), nullptr);
    EXPECT_EQ(find_raw_topic(""), nullptr);
}

}  // namespace
}  // namespace atrium::bus
