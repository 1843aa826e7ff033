#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium {

/// Computes the 64-bit FNV-1a hash, to detect damage and to compare states. Not collision-resistant
/// against an attacker.
class Fnv1a {
public:
    /// Adds a byte. Larger numbers are mixed in as one value, not byte by byte.
    void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 1099511628211ULL; }
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
