#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace atrium {

/// The FNV-1a hash of 64 bits: finds damage and tells states apart, but keeps nobody from making
/// what has a given hash.
class Fnv1a {
public:
    /// Takes a byte, or a whole number as if it were one.
    void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 1099511628211ULL; }
    std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 14695981039346656037ULL;
};

/// Of bytes: std::uint8_t, or char.
template <typename Byte>
std::uint64_t fnv1a(std::span<const Byte> bytes) {
    static_assert(sizeof(Byte) == 1);
    Fnv1a hash;
    for (const Byte byte : bytes) hash.add(static_cast<std::uint8_t>(byte));
    return hash.value();
}

}  // namespace atrium
