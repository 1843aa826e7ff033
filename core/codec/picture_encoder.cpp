#include "core/codec/picture_encoder.hpp"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace atrium::codec {

struct PictureEncoder::State {
    tjhandle encoder = tjInitCompress();
    // Own buffer: the library would leak its buffer for a picture that it refuses.
    std::vector<std::uint8_t> jpeg;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (encoder != nullptr) tjDestroy(encoder);
    }
};

PictureEncoder::PictureEncoder() : state_(std::make_unique<State>()) {}
PictureEncoder::~PictureEncoder() = default;

Expected<std::span<const std::uint8_t>> PictureEncoder::encode(
    std::span<const std::uint8_t> rgba, int width, int height, int quality, Chroma chroma) {
    const int sampling = chroma == Chroma::kFull ? TJSAMP_444 : TJSAMP_420;
    constexpr std::size_t kBytesPerPixel = 4;
    if (width <= 0 || height <= 0 ||
        rgba.size() !=
            kBytesPerPixel * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{} bytes are not an RGBA picture of {} x {}", rgba.size(), width, height));
    }
    if (state_->encoder == nullptr)
        return make_error(ErrorKind::kInternal, "JPEG encoder: out of memory");
    unsigned long bytes = tjBufSize(width, height, sampling);
    state_->jpeg.resize(std::max<std::size_t>(state_->jpeg.size(), bytes));
    unsigned char* to = state_->jpeg.data();
    if (tjCompress2(state_->encoder,
                    rgba.data(),
                    width,
                    0,
                    height,
                    TJPF_RGBA,
                    &to,
                    &bytes,
                    sampling,
                    quality,
                    TJFLAG_NOREALLOC) != 0) {
        return make_error(ErrorKind::kInternal,
                          std::string("JPEG: ") + tjGetErrorStr2(state_->encoder));
    }
    return std::span<const std::uint8_t>(to, bytes);
}

}  // namespace atrium::codec
