#include "core/bus/cdr.hpp"

#include <dds/ddsi/ddsi_cdrstream.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace atrium::bus {
namespace {

constexpr std::size_t kHeaderBytes = 4;
// The second byte of the header: the byte order.
constexpr std::byte kBigEndian{0};
constexpr std::byte kLittleEndian{1};
constexpr std::uint32_t kXcdrVersion = CDR_ENC_VERSION_1;

}  // namespace

std::vector<std::byte> cdr_of(const dds_topic_descriptor_t& topic, const void* wire) {
    constexpr std::array header{std::byte{0}, kLittleEndian, std::byte{0}, std::byte{0}};
    dds_ostreamLE_t stream;
    dds_ostreamLE_init(&stream, 256, kXcdrVersion);
    dds_stream_writeLE(&stream, static_cast<const char*>(wire), topic.m_ops);
    std::vector<std::byte> cdr(kHeaderBytes + stream.x.m_index);
    std::copy(header.begin(), header.end(), cdr.begin());
    const auto* content = reinterpret_cast<const std::byte*>(stream.x.m_buffer);
    std::copy_n(content, stream.x.m_index, cdr.begin() + kHeaderBytes);
    dds_ostreamLE_fini(&stream);
    return cdr;
}

Expected<void> wire_of(const dds_topic_descriptor_t& topic,
                       std::span<const std::byte> cdr,
                       void* wire) {
    if (cdr.size() < kHeaderBytes || cdr.size() > std::numeric_limits<std::uint32_t>::max() ||
        cdr[0] != std::byte{0} || (cdr[1] != kBigEndian && cdr[1] != kLittleEndian))
        return make_error(ErrorKind::kInvalidData, "no CDR of version 1");
    const bool swaps = cdr[1] == kBigEndian;
    // Cyclone checks and swaps in place. One byte more: it wants a pointer also for no bytes.
    const auto size = static_cast<std::uint32_t>(cdr.size() - kHeaderBytes);
    std::vector<char> content(std::size_t{size} + 1);
    std::memcpy(content.data(), cdr.data() + kHeaderBytes, size);
    std::uint32_t end = 0;
    if (dds_stream_normalize_data(content.data(), &end, size, swaps, kXcdrVersion, topic.m_ops) ==
        nullptr)
        return make_error(ErrorKind::kInvalidData, "the bytes are no sample of its type");
    dds_istream_t stream;
    dds_istream_init(&stream, size, content.data(), kXcdrVersion);
    dds_stream_read(&stream, static_cast<char*>(wire), topic.m_ops);
    return {};
}

void free_wire(const dds_topic_descriptor_t& topic, void* wire) {
    dds_stream_free_sample(wire, topic.m_ops);
}

}  // namespace atrium::bus
