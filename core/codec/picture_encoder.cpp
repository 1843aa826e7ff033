#include "core/codec/picture_encoder.hpp"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cstddef>
#include <string>

namespace atrium::codec {

struct PictureEncoder::State {
    tjhandle encoder = tjInitCompress();
    unsigned char* jpeg = nullptr;
    unsigned long allocated_bytes = 0;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        tjFree(jpeg);
        if (encoder != nullptr) tjDestroy(encoder);
    }
};

PictureEncoder::PictureEncoder() : state_(std::make_unique<State>()) {}
PictureEncoder::~PictureEncoder() = default;

Expected<std::span<const std::uint8_t>> PictureEncoder::encode(std::span<const std::uint8_t> rgba,
                                                               int width,
                                                               int height,
                                                               int quality) {
    constexpr std::size_t kBytesPerPixel = 4;
    if (width <= 0 || height <= 0 ||
        rgba.size() !=
            kBytesPerPixel * static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{} bytes are no RGBA picture of {} x {}", rgba.size(), width, height));
    }
    if (state_->encoder == nullptr)
        return make_error(ErrorKind::kInternal, "no memory for a JPEG encoder");
    unsigned long bytes = state_->allocated_bytes;
    if (tjCompress2(state_->encoder,
                    rgba.data(),
                    width,
                    0,
                    height,
                    TJPF_RGBA,
                    &state_->jpeg,
                    &bytes,
                    TJSAMP_420,
                    quality,
                    0) != 0) {
        return make_error(ErrorKind::kInternal,
                          std::string("JPEG: ") + tjGetErrorStr2(state_->encoder));
    }
    // the library keeps the memory, and takes more where a picture needs it
    state_->allocated_bytes = std::max(state_->allocated_bytes, bytes);
    return std::span<const std::uint8_t>(state_->jpeg, bytes);
}

}  // namespace atrium::codec
