#include "site_node/segmentation_worker/protocol.hpp"

#include "tests/support/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

namespace atrium::segmentation_worker {
namespace {

using testing::HasSubstr;

std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t offset, int size) {
    std::uint64_t value = 0;
    for (int i = size - 1; i >= 0; --i)
        value = value << 8 | bytes[offset + static_cast<std::size_t>(i)];
    return value;
}

std::vector<std::uint8_t> alpha_message(std::uint64_t number,
                                        std::uint32_t width,
                                        std::uint32_t height,
                                        std::uint32_t kind = 2,
                                        std::uint32_t version = 1) {
    std::vector<std::uint8_t> bytes(24);
    std::memcpy(bytes.data(), &kind, 4);
    std::memcpy(bytes.data() + 4, &version, 4);
    std::memcpy(bytes.data() + 8, &number, 8);
    std::memcpy(bytes.data() + 16, &width, 4);
    std::memcpy(bytes.data() + 20, &height, 4);
    return bytes;
}

TEST(WorkerProtocol, PlacesDoNotOverlapAndFitTheMemory) {
    for (const auto& [width, height] : {std::pair{2, 2}, {1000, 1000}, {4096, 3072}, {66, 1234}}) {
        const Layout layout = layout_of(width, height);
        const std::uint64_t pixels = std::uint64_t(width) * std::uint64_t(height);
        EXPECT_GE(layout.background_offset, kHeaderBytes);
        EXPECT_GE(layout.picture_offset, layout.background_offset + 3 * pixels);
        EXPECT_GE(layout.last_mask_offset, layout.picture_offset + 3 * pixels);
        EXPECT_GE(layout.alpha_offset, layout.last_mask_offset + pixels);
        EXPECT_GE(layout.num_bytes, layout.alpha_offset + pixels);
        for (const std::uint64_t offset :
             {layout.background_offset, layout.picture_offset, layout.last_mask_offset})
            EXPECT_EQ(offset % 4096, 0u);
    }
}

TEST(WorkerProtocol, WritesTheHeaderAsDocumented) {
    const Layout layout = layout_of(640, 480);
    const auto bytes = encode_header(layout, 20'000, "north");
    EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 8), "ATRMSEGM");
    EXPECT_EQ(number_at(bytes, 8, 4), 1u);
    EXPECT_EQ(number_at(bytes, 12, 4), 4096u);
    EXPECT_EQ(number_at(bytes, 16, 8), layout.num_bytes);
    EXPECT_EQ(number_at(bytes, 24, 4), 640u);
    EXPECT_EQ(number_at(bytes, 28, 4), 480u);
    EXPECT_EQ(number_at(bytes, 32, 8), layout.background_offset);
    EXPECT_EQ(number_at(bytes, 40, 8), layout.picture_offset);
    EXPECT_EQ(number_at(bytes, 48, 8), layout.last_mask_offset);
    EXPECT_EQ(number_at(bytes, 56, 8), layout.alpha_offset);
    EXPECT_EQ(number_at(bytes, 64, 4), 20'000u);
    EXPECT_STREQ(reinterpret_cast<const char*>(&bytes[72]), "north");
}

TEST(WorkerProtocol, EndsLongNamesOfCamerasWithAZero) {
    const auto bytes = encode_header(layout_of(4, 4), 1, std::string(200, 'x'));
    EXPECT_EQ(bytes[134], 'x');
    EXPECT_EQ(bytes[135], 0);
}

TEST(WorkerProtocol, WritesPicturesAsDocumented) {
    const auto bytes = encode({SiteMessage::Kind::kPicture, 0x1122334455667788, -5, 77});
    EXPECT_EQ(number_at(bytes, 0, 4), 2u);
    EXPECT_EQ(number_at(bytes, 4, 4), 1u);
    EXPECT_EQ(number_at(bytes, 8, 8), 0x1122334455667788u);
    EXPECT_EQ(static_cast<std::int64_t>(number_at(bytes, 16, 8)), -5);
    EXPECT_EQ(number_at(bytes, 24, 4), 77u);
}

TEST(WorkerProtocol, ReadsAnswers) {
    const auto message = decode(alpha_message(0x8877665544332211, 640, 480));
    ASSERT_TRUE(message) << message.error().message;
    EXPECT_EQ(message->kind, WorkerMessage::Kind::kAlpha);
    EXPECT_EQ(message->number, 0x8877665544332211u);
    EXPECT_EQ(message->width, 640u);
    EXPECT_EQ(message->height, 480u);
}

TEST(WorkerProtocol, RefusesEveryOtherSizeKindAndVersion) {
    auto bytes = alpha_message(1, 640, 480);
    bytes.resize(48);
    for (std::size_t size = 0; size <= bytes.size(); ++size)
        EXPECT_EQ(decode(std::span(bytes).first(size)).has_value(), size == 24) << size;
    for (const std::uint32_t kind : {0U, 4U, 1000U, 0xffffffffU})
        EXPECT_FALSE(decode(alpha_message(1, 640, 480, kind))) << kind;
    const auto other = decode(alpha_message(1, 640, 480, 2, 2));
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("it speaks version 2"));
}

// Of any bytes only the answer to the picture that was asked for passes.
TEST(WorkerProtocol, AcceptsNoRandomBytes) {
    test::Random random(4);
    const Layout layout = layout_of(640, 480);
    int num_accepted = 0;
    for (int i = 0; i < 20'000; ++i) {
        auto bytes = alpha_message(7, 640, 480);
        const int num_changes = test::between(random, 0, 3);
        for (int change = 0; change < num_changes; ++change)
            bytes[static_cast<std::size_t>(test::between(random, 0, 23))] =
                static_cast<std::uint8_t>(test::between(random, 0, 255));
        const auto message = decode(bytes);
        if (!message || !check(*message, layout, true, 7)) continue;
        ++num_accepted;
        EXPECT_EQ(message->number, 7u);
        const bool is_alpha = message->kind == WorkerMessage::Kind::kAlpha;
        EXPECT_TRUE(is_alpha || message->kind == WorkerMessage::Kind::kNone);
        if (is_alpha) {
            EXPECT_EQ(bytes, alpha_message(7, 640, 480));
        }
    }
    EXPECT_GT(num_accepted, 4000);  // those without a change
}

TEST(WorkerProtocol, RefusesAnswersOutOfTurn) {
    const Layout layout = layout_of(640, 480);
    const WorkerMessage ready{WorkerMessage::Kind::kReady};
    const WorkerMessage alpha{WorkerMessage::Kind::kAlpha, 5, 640, 480};
    EXPECT_TRUE(check(ready, layout, false, {}));
    EXPECT_FALSE(check(ready, layout, true, {}));
    EXPECT_TRUE(check(alpha, layout, true, 5));
    EXPECT_FALSE(check(alpha, layout, false, {}));
    EXPECT_FALSE(check(alpha, layout, true, {}));
    for (const std::uint64_t asked : {4, 6}) EXPECT_FALSE(check(alpha, layout, true, asked));
    for (const auto& [width, height] : {std::pair{480U, 640U}, {640U, 481U}, {0U, 0U}})
        EXPECT_FALSE(check({WorkerMessage::Kind::kAlpha, 5, width, height}, layout, true, 5));
    EXPECT_TRUE(check({WorkerMessage::Kind::kNone, 5, 0, 0}, layout, true, 5));
}

}  // namespace
}  // namespace atrium::segmentation_worker
