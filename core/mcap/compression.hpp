#pragma once

#include "core/base/expected.hpp"
#include "core/mcap/bytes.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

/// Compresses and decompresses the records of a chunk. Private to core/mcap and its tests.
namespace atrium::mcap {

/// Far more than a chunk of ours; ends the wish of a hostile file for memory.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20U;

/// Compresses with zstd at its fastest useful level; keeps its memory.
class ZstdCompressor {
public:
    ZstdCompressor();
    ZstdCompressor(ZstdCompressor&&) noexcept;
    ZstdCompressor& operator=(ZstdCompressor&&) noexcept;
    ~ZstdCompressor();
    /// Appends to `out`.
    Expected<void> compress(std::span<const std::byte> bytes, Bytes& out);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// `method` is "", "zstd" or "lz4", `size` what comes out. kInvalidData with a reason otherwise.
Expected<Bytes> decompress(std::string_view method,
                           std::span<const std::byte> bytes,
                           std::uint64_t size);

}  // namespace atrium::mcap
