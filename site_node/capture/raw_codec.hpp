#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/raw_sheet.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace atrium::capture {

/// How a picture is stored in frames.raw. All are lossless. The numbers are those in the files.
enum class RawCodec : std::uint8_t {
    kRaw = 0,      // packed bytes (raw_sheet.hpp)
    kFfv1 = 1,     // the sheet as one picture of FFV1, version 3
    kHuffYuv = 2,  // the sheet as one picture of HuffYUV, in its variant FFVHUFF
};

/// "raw", "ffv1", "huffyuv".
const char* name_of(RawCodec codec);

/// Compresses sheets of one size. Each picture is complete in itself. Not thread-safe.
class SheetEncoder {
public:
    /// `codec` is not kRaw. Error kUnavailable if the system's libavcodec cannot encode it.
    static Expected<SheetEncoder> open(RawCodec codec, const SheetSize& size);
    SheetEncoder(SheetEncoder&&) noexcept;
    SheetEncoder& operator=(SheetEncoder&&) noexcept;
    ~SheetEncoder();

    /// What a decoder needs besides the pictures.
    std::vector<std::uint8_t> codec_data() const;

    /// Replaces `out`. Error kInternal.
    Expected<void> encode(std::span<const std::uint8_t> sheet, std::vector<std::uint8_t>& out);

private:
    struct Impl;
    explicit SheetEncoder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The inverse. The bytes may be hostile. Not thread-safe.
class SheetDecoder {
public:
    static Expected<SheetDecoder> open(RawCodec codec,
                                       const SheetSize& size,
                                       std::span<const std::uint8_t> codec_data);
    SheetDecoder(SheetDecoder&&) noexcept;
    SheetDecoder& operator=(SheetDecoder&&) noexcept;
    ~SheetDecoder();

    /// Fills `sheet`. Error kInvalidData if the bytes are no picture of this size.
    Expected<void> decode(std::span<const std::uint8_t> coded, std::span<std::uint8_t> sheet);

private:
    struct Impl;
    explicit SheetDecoder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::capture
