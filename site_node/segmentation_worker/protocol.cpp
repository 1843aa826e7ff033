#include "site_node/segmentation_worker/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

namespace atrium::segmentation_worker {
namespace {

constexpr std::uint64_t kPage = 4096;
constexpr std::string_view kMagic = "ATRMSEGM";
constexpr std::size_t kNameOffset = 72;
constexpr std::size_t kNameBytes = kHeaderBytes - kNameOffset;

std::uint64_t whole_pages(std::uint64_t num_bytes) {
    return (num_bytes + kPage - 1) / kPage * kPage;
}

template <typename Number>
void put(std::uint8_t* at, Number value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
        at[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
}

template <typename Number>
Number get(const std::uint8_t* at) {
    Number value = 0;
    for (std::size_t i = 0; i < sizeof value; ++i) value |= static_cast<Number>(at[i]) << (8 * i);
    return value;
}

tl::unexpected<Error> wrong(std::string text) {
    return make_error(ErrorKind::kInvalidData, std::move(text));
}

}  // namespace

Layout layout_of(int width, int height) {
    assert(width > 0 && height > 0);
    Layout layout{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    std::uint64_t end = kPage;
    const auto place = [&](std::uint64_t bytes_per_pixel) {
        const std::uint64_t begin = end;
        end += whole_pages(bytes_per_pixel * layout.num_pixels());
        return begin;
    };
    layout.background_offset = place(3);
    layout.picture_offset = place(3);
    layout.last_mask_offset = place(1);
    layout.alpha_offset = place(1);
    layout.num_bytes = end;
    return layout;
}

std::array<std::uint8_t, kHeaderBytes> encode_header(const Layout& layout,
                                                     std::uint32_t deadline_us,
                                                     std::string_view camera) {
    std::array<std::uint8_t, kHeaderBytes> bytes{};
    std::copy(kMagic.begin(), kMagic.end(), bytes.begin());
    put(&bytes[8], kVersion);
    put(&bytes[12], static_cast<std::uint32_t>(kPage));
    put(&bytes[16], layout.num_bytes);
    put(&bytes[24], layout.width);
    put(&bytes[28], layout.height);
    put(&bytes[32], layout.background_offset);
    put(&bytes[40], layout.picture_offset);
    put(&bytes[48], layout.last_mask_offset);
    put(&bytes[56], layout.alpha_offset);
    put(&bytes[64], deadline_us);
    const std::string_view name = camera.substr(0, kNameBytes - 1);
    std::copy(name.begin(), name.end(), bytes.begin() + kNameOffset);
    return bytes;
}

std::array<std::uint8_t, kSiteMessageBytes> encode(const SiteMessage& message) {
    std::array<std::uint8_t, kSiteMessageBytes> bytes{};
    put(&bytes[0], static_cast<std::uint32_t>(message.kind));
    put(&bytes[4], kVersion);
    put(&bytes[8], message.number);
    put(&bytes[16], message.capture_time_ns);
    put(&bytes[24], message.background_number);
    return bytes;
}

Expected<WorkerMessage> decode(std::span<const std::uint8_t> bytes) {
    if (bytes.size() != kWorkerMessageBytes)
        return wrong(fmt::format(
            "it sent a message of {} bytes instead of {}", bytes.size(), kWorkerMessageBytes));
    const auto kind = get<std::uint32_t>(&bytes[0]);
    const auto version = get<std::uint32_t>(&bytes[4]);
    if (version != kVersion)
        return wrong(fmt::format(
            "it speaks version {} of the protocol, this program version {}", version, kVersion));
    if (kind < 1 || kind > 3) return wrong(fmt::format("it sent a message of kind {}", kind));
    return WorkerMessage{static_cast<WorkerMessage::Kind>(kind),
                         get<std::uint64_t>(&bytes[8]),
                         get<std::uint32_t>(&bytes[16]),
                         get<std::uint32_t>(&bytes[20])};
}

Expected<void> check(const WorkerMessage& message,
                     const Layout& layout,
                     bool is_ready,
                     std::optional<std::uint64_t> asked) {
    if (message.kind == WorkerMessage::Kind::kReady) {
        if (is_ready) return wrong("it said twice that it is ready");
        return {};
    }
    if (!is_ready) return wrong("it answered before it was ready");
    if (!asked)
        return wrong(fmt::format("it answered picture {}, but was not asked", message.number));
    if (message.number != *asked)
        return wrong(fmt::format("it answered picture {} instead of {}", message.number, *asked));
    if (message.kind == WorkerMessage::Kind::kAlpha &&
        (message.width != layout.width || message.height != layout.height))
        return wrong(fmt::format("its alpha has {}x{} px, the picture {}x{}",
                                 message.width,
                                 message.height,
                                 layout.width,
                                 layout.height));
    return {};
}

}  // namespace atrium::segmentation_worker
