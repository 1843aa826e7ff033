#include "core/codec/texture_codec.hpp"

#include "core/codec/jpeg_writer.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <string>

namespace atrium::codec {

struct TextureEncoder::State {
    JpegWriter jpeg;
};

struct TextureDecoder::State {
    tjhandle jpeg = tjInitDecompress();
    image::Mask mask;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { close(); }

    // damaged bytes may leave the library in the middle of a marker, where the next picture would
    // continue
    void restart() {
        close();
        jpeg = tjInitDecompress();
    }

private:
    void close() {
        if (jpeg) tjDestroy(jpeg);
    }
};

TextureEncoder::TextureEncoder() : state_(std::make_unique<State>()) {}
TextureEncoder::~TextureEncoder() = default;
TextureEncoder::TextureEncoder(TextureEncoder&&) noexcept = default;
TextureEncoder& TextureEncoder::operator=(TextureEncoder&&) noexcept = default;

TextureDecoder::TextureDecoder() : state_(std::make_unique<State>()) {}
TextureDecoder::~TextureDecoder() = default;
TextureDecoder::TextureDecoder(TextureDecoder&&) noexcept = default;
TextureDecoder& TextureDecoder::operator=(TextureDecoder&&) noexcept = default;

namespace {

std::string size_text(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

tl::unexpected<Error> jpeg_error(tjhandle handle, const std::string& what) {
    return make_error(ErrorKind::kInvalidData, what + ": " + tjGetErrorStr2(handle));
}

Expected<void> encode_colour(const TextureCrop& crop,
                             int quality,
                             JpegWriter& jpeg,
                             std::vector<std::uint8_t>& out) {
    const auto coded = jpeg.write(crop.y, crop.u, crop.v, quality);
    if (!coded) return tl::unexpected(coded.error());
    const std::size_t size = coded->size();
    if (out.capacity() < size) out.reserve(std::bit_ceil(size));  // sizes differ a little each time
    out.assign(coded->begin(), coded->end());
    if (size > kMaxColourBytes) {
        return make_error(ErrorKind::kInvalidData,
                          "texture of " + size_text(crop.width(), crop.height()) + " takes " +
                              std::to_string(size) + " bytes; lower the quality to stay below " +
                              std::to_string(kMaxColourBytes));
    }
    return {};
}

Expected<void> decode_colour(std::span<const std::uint8_t> bytes,
                             const image::Mask& mask,
                             tjhandle decoder,
                             DecodedTexture& out) {
    if (!decoder) return make_error(ErrorKind::kInternal, "the JPEG decoder could not be started");
    if (bytes.empty() || bytes.size() > kMaxColourBytes) {
        return make_error(ErrorKind::kInvalidData,
                          "coded colours of " + std::to_string(bytes.size()) + " bytes");
    }
    int width = 0;
    int height = 0;
    int sampling = 0;
    int colour_space = 0;
    if (tjDecompressHeader3(
            decoder, bytes.data(), bytes.size(), &width, &height, &sampling, &colour_space) != 0) {
        return jpeg_error(decoder, "coded colours are damaged");
    }
    if (width != mask.width || height != mask.height) {
        return make_error(ErrorKind::kInvalidData,
                          "colours of " + size_text(width, height) + " with a mask of " +
                              size_text(mask.width, mask.height));
    }
    if (sampling != TJSAMP_444 || colour_space != TJCS_YCbCr) {
        return make_error(ErrorKind::kInvalidData, "coded colours are not YCbCr 4:4:4");
    }
    out.width = width;
    out.height = height;
    out.rgba.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    // a picture of thousands of scans would take minutes
    constexpr int kFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
    if (tjDecompress2(decoder,
                      bytes.data(),
                      bytes.size(),
                      out.rgba.data(),
                      width,
                      0,
                      height,
                      TJPF_RGBA,
                      kFlags) != 0) {
        return jpeg_error(decoder, "coded colours are damaged");
    }
    return {};
}

}  // namespace

Expected<void> TextureEncoder::encode(const TextureCrop& crop, int quality, CodedTexture& out) {
    assert(quality >= 1 && quality <= 100);
    for (const image::Plane* plane : {&crop.u, &crop.v, &crop.mask}) {
        if (plane->width != crop.width() || plane->height != crop.height()) {
            return make_error(ErrorKind::kInvalidData, "the planes of a texture differ in size");
        }
    }
    if (!is_texture_size(crop.width(), crop.height())) {
        return make_error(ErrorKind::kInvalidData,
                          "texture of " + size_text(crop.width(), crop.height()) +
                              " pixels; 1 to " + std::to_string(kMaxTextureSide) +
                              " per side and " + std::to_string(kMaxTexturePixels) +
                              " in all are allowed");
    }
    if (auto coded = encode_colour(crop, quality, state_->jpeg, out.colour); !coded) return coded;
    encode_mask(crop.mask, out.mask);
    return {};
}

Expected<void> TextureDecoder::decode(std::span<const std::uint8_t> colour,
                                      std::span<const std::uint8_t> mask,
                                      DecodedTexture& out) {
    if (auto decoded = decode_mask(mask, state_->mask); !decoded) return decoded;
    if (auto decoded = decode_colour(colour, state_->mask, state_->jpeg, out); !decoded) {
        state_->restart();
        return decoded;
    }
    for (std::size_t i = 0; i < state_->mask.data.size(); ++i)
        out.rgba[4 * i + 3] = state_->mask.data[i];
    return {};
}

}  // namespace atrium::codec
