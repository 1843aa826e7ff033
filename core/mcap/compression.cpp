#include "core/mcap/compression.hpp"

#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

namespace atrium::mcap {
namespace {

// Meshes and pictures are compressed already: a higher level finds no more in them.
constexpr int kLevel = 1;

Expected<void> unlz4(std::span<const std::byte> bytes, Bytes& out) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
        return make_error(ErrorKind::kInternal, "lz4: no memory");
    const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(
        context, &LZ4F_freeDecompressionContext);
    std::size_t num_read = 0;
    std::size_t num_written = 0;
    std::size_t hint = 1;
    while (hint != 0) {
        std::size_t from = bytes.size() - num_read;
        std::size_t to = out.size() - num_written;
        hint = LZ4F_decompress(
            context, out.data() + num_written, &to, bytes.data() + num_read, &from, nullptr);
        if (LZ4F_isError(hint))
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("lz4: {}", LZ4F_getErrorName(hint)));
        num_read += from;
        num_written += to;
        if (hint != 0 && from == 0 && to == 0) break;  // cut off, or longer than it says
    }
    if (hint != 0 || num_written != out.size())
        return make_error(ErrorKind::kInvalidData, "lz4: not as long as it says");
    return {};
}

}  // namespace

struct ZstdCompressor::Impl {
    std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context{ZSTD_createCCtx(),
                                                                    &ZSTD_freeCCtx};
};

ZstdCompressor::ZstdCompressor() : impl_(std::make_unique<Impl>()) {}
ZstdCompressor::ZstdCompressor(ZstdCompressor&&) noexcept = default;
ZstdCompressor& ZstdCompressor::operator=(ZstdCompressor&&) noexcept = default;
ZstdCompressor::~ZstdCompressor() = default;

Expected<void> ZstdCompressor::compress(std::span<const std::byte> bytes, Bytes& out) {
    const std::size_t at = out.size();
    out.resize(at + ZSTD_compressBound(bytes.size()));
    const std::size_t size = ZSTD_compressCCtx(
        impl_->context.get(), out.data() + at, out.size() - at, bytes.data(), bytes.size(), kLevel);
    if (ZSTD_isError(size))
        return make_error(ErrorKind::kInternal, fmt::format("zstd: {}", ZSTD_getErrorName(size)));
    out.resize(at + size);
    return {};
}

Expected<Bytes> decompress(std::string_view method,
                           std::span<const std::byte> bytes,
                           std::uint64_t size) {
    if (size > kMaxChunkBytes) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("a chunk of {} bytes; at most {} are read", size, kMaxChunkBytes));
    }
    if (method.empty()) {
        if (bytes.size() != size)
            return make_error(ErrorKind::kInvalidData, "not as long as it says");
        return Bytes(bytes.begin(), bytes.end());
    }
    if (method != "zstd" && method != "lz4") {
        return make_error(ErrorKind::kInvalidData,
                          "a chunk's compression is unknown; zstd and lz4 are read");
    }
    Bytes out(static_cast<std::size_t>(size));
    if (method == "lz4") {
        if (auto done = unlz4(bytes, out); !done) return tl::unexpected(done.error());
        return out;
    }
    const std::size_t got = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(got)) {
        return make_error(ErrorKind::kInvalidData, fmt::format("zstd: {}", ZSTD_getErrorName(got)));
    }
    if (got != size) return make_error(ErrorKind::kInvalidData, "zstd: not as long as it says");
    return out;
}

}  // namespace atrium::mcap
