#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace atrium::test {

/// Makes values from a fuzzer's bytes. Past their end it reads zeros.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::uint8_t byte() {
        if (next_ >= bytes_.size()) return 0;
        return bytes_[next_++];
    }
    std::uint16_t word() {
        const std::uint16_t high = byte();
        return static_cast<std::uint16_t>(high << 8 | byte());
    }
    int below(int limit) { return byte() % limit; }
    /// In [low, high], on a grid of 65536 steps.
    double between(double low, double high) { return low + (high - low) * word() / 65535.0; }
    /// Any number, finite or not.
    double raw() {
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
        return std::bit_cast<double>(bits);
    }
    /// Numbers that often break programs.
    double hostile() {
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        constexpr std::array<double, 12> kValues{0.0,
                                                 -0.0,
                                                 1.0,
                                                 -1.0,
                                                 1e-300,
                                                 1e300,
                                                 -1e300,
                                                 1e6,
                                                 -1e6,
                                                 kInfinity,
                                                 -kInfinity,
                                                 std::numeric_limits<double>::quiet_NaN()};
        const auto choice = static_cast<std::size_t>(below(14));
        return choice < kValues.size() ? kValues[choice] : raw();
    }

private:
    std::span<const std::uint8_t> bytes_;
    std::size_t next_ = 0;
};

}  // namespace atrium::test
