#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct AVCodecContext;

namespace atrium::viewer {

struct EncoderOptions {
    int width = 0;  // even
    int height = 0;
    double fps = 30.0;
    int kbps = 0;                    // 0: by size and rate
    bool has_global_header = false;  // as the container flv wants it
};

struct EncodedPicture {
    std::vector<std::uint8_t> bytes;
    std::int64_t index = 0;  // of the picture, in steps of 1 / fps
    bool is_key = false;
};

/// Encodes pictures without delay: H.264 by x264 where libavcodec has it, else MPEG-4 part 2, then
/// MPEG-2. BT.601 video range. One thread.
class StreamEncoder {
public:
    /// Error kUnavailable if no encoder opens.
    static Expected<std::unique_ptr<StreamEncoder>> create(const EncoderOptions& options);
    ~StreamEncoder();
    StreamEncoder(const StreamEncoder&) = delete;
    StreamEncoder& operator=(const StreamEncoder&) = delete;

    /// Sets the picture for `encode`: width * height pixels of R, G, B, A, top row first.
    void set(std::span<const std::uint8_t> rgba);
    /// Encodes the picture last set as number `index`, which grows. Error kUnavailable.
    Expected<EncodedPicture> encode(std::int64_t index, bool is_key);

    std::string name() const;  // of the encoder
    bool is_h264() const;
    const AVCodecContext& context() const;

private:
    struct Impl;
    explicit StreamEncoder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::viewer
