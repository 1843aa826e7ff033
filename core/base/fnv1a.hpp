#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace atrium {

/// Computes the 64-bit FNV-1a hash, to detect damage and to compare states. Not collision-resistant
/// against an attacker.
class Fnv1a {
public:
    /// Adds a byte. Larger numbers are mixed in as one value, not byte by byte.
    void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 1099511628211ULL; }
    /// Adds a number rounded to single precision: its last digits may differ between processors.
    void add_rounded(double value) {
        add(std::bit_cast<std::uint32_t>(static_cast<float>(value) + 0.0F));
    }
    void add(std::string_view text) {
        for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
        add(std::uint64_t{0x100});  // the end: no character
    }
    std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 14695981039346656037ULL;
};

/// Hashes bytes (std::uint8_t or char).
template <typename Byte>
std::uint64_t fnv1a(std::span<const Byte> bytes) {
    static_assert(sizeof(Byte) == 1);
    Fnv1a hash;
    for (const Byte byte : bytes) hash.add(static_cast<std::uint8_t>(byte));
    return hash.value();
}

}  // namespace atrium
