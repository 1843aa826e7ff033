#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

/// Little-endian values in memory. Private to core/mcap and its tests.
namespace atrium::mcap {

static_assert(std::endian::native == std::endian::little);

using Bytes = std::vector<std::byte>;
using StringMap = std::map<std::string, std::string>;

template <typename T>
void put(Bytes& out, T value) {
    static_assert(std::is_integral_v<T>);
    const std::size_t at = out.size();
    out.resize(at + sizeof(T));
    std::memcpy(out.data() + at, &value, sizeof(T));
}
void put_bytes(Bytes& out, std::span<const std::byte> bytes);
/// With its length in front, 32 bits.
void put_string(Bytes& out, std::string_view text);
void put_map(Bytes& out, const StringMap& map);

/// Reads from bytes of any content. After the first read beyond the end all values are 0 or empty,
/// and `ok` is false.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}

    template <typename T>
    T get() {
        static_assert(std::is_integral_v<T>);
        T value{};
        if (const auto bytes = take(sizeof(T)); bytes.size() == sizeof(T))
            std::memcpy(&value, bytes.data(), sizeof(T));
        return value;
    }
    std::string string();
    StringMap map();
    std::span<const std::byte> take(std::uint64_t count);
    std::span<const std::byte> rest() const { return rest_; }
    bool ok() const { return is_ok_; }

private:
    std::span<const std::byte> rest_;
    bool is_ok_ = true;
};

/// CRC-32 as in zlib; `before`: of the bytes in front of these.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0);

}  // namespace atrium::mcap
