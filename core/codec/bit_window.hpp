#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

namespace atrium::codec {

/// Reads bits from bytes, the lowest bit of each byte first.
class BitWindow {
public:
    /// Minimum number of valid bits that `at` returns.
    static constexpr std::size_t kNumBits = 57;

    explicit BitWindow(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::size_t num_bits() const { return 8 * bytes_.size(); }

    /// Returns the bits from number `bit` on, the first one lowest; zeros after the end.
    std::uint64_t at(std::size_t bit) const {
        static_assert(std::endian::native == std::endian::little);
        const std::size_t byte = bit / 8;
        std::uint64_t window = 0;
        if (byte + sizeof window <= bytes_.size()) {
            std::memcpy(&window, &bytes_[byte], sizeof window);
        } else if (byte < bytes_.size()) {
            std::memcpy(&window, &bytes_[byte], bytes_.size() - byte);
        }
        return window >> (bit % 8);
    }

private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace atrium::codec
