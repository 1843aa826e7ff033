#include "core/mcap/bytes.hpp"

#include <zlib.h>

namespace atrium::mcap {

void put_bytes(Bytes& out, std::span<const std::byte> bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
}

void put_string(Bytes& out, std::string_view text) {
    put(out, static_cast<std::uint32_t>(text.size()));
    put_bytes(out, std::as_bytes(std::span(text)));
}

void put_map(Bytes& out, const StringMap& map) {
    Bytes content;
    for (const auto& [key, value] : map) {
        put_string(content, key);
        put_string(content, value);
    }
    put(out, static_cast<std::uint32_t>(content.size()));
    put_bytes(out, content);
}

std::span<const std::byte> ByteReader::take(std::uint64_t count) {
    if (!is_ok_ || count > rest_.size()) {
        is_ok_ = false;
        rest_ = {};
        return {};
    }
    const auto taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(static_cast<std::size_t>(count));
    return taken;
}

std::string ByteReader::string() {
    const auto bytes = take(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

StringMap ByteReader::map() {
    StringMap map;
    ByteReader content(take(get<std::uint32_t>()));
    while (content.ok() && !content.rest().empty()) {
        std::string key = content.string();
        map[std::move(key)] = content.string();
    }
    if (!content.ok()) is_ok_ = false;
    return map;
}

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
    return static_cast<std::uint32_t>(
        ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace atrium::mcap
