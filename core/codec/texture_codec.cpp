#include "core/codec/texture_codec.hpp"

#include "core/codec/jpeg_writer.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

namespace atrium::codec {

struct TextureEncoder::State {
    JpegWriter jpeg;
    TextureCrop half;  // colours only
};

struct TextureDecoder::State {
    tjhandle jpeg = tjInitDecompress();
    image::Mask mask;
    std::vector<std::uint8_t> doubled;  // half-size colours enlarged to full size

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { close(); }

    // damaged bytes can leave the library in the middle of a marker; the next picture would
    // continue there
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
    if (out.capacity() < size) out.reserve(std::bit_ceil(size));  // sizes vary a little
    out.assign(coded->begin(), coded->end());
    if (size > kMaxColourBytes) {
        return make_error(ErrorKind::kInvalidData,
                          "texture of " + size_text(crop.width(), crop.height()) + " takes " +
                              std::to_string(size) + " bytes; lower the quality to stay below " +
                              std::to_string(kMaxColourBytes));
    }
    return {};
}

int half_of(int size) { return (size + 1) / 2; }

void halve(const image::Plane& from, image::Plane& to) {
    to.width = half_of(from.width);
    to.height = half_of(from.height);
    to.data.resize(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height));
    for (int y = 0; y < to.height; ++y) {
        const std::uint8_t* top = from.row(2 * y);
        const std::uint8_t* bottom = from.row(std::min(2 * y + 1, from.height - 1));
        std::uint8_t* out = to.row(y);
        const int num_whole = from.width / 2;
        for (int x = 0; x < num_whole; ++x) {
            out[x] = static_cast<std::uint8_t>(
                (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1] + 2) >> 2);
        }
        if (num_whole < to.width) {
            const int last = from.width - 1;
            out[num_whole] = static_cast<std::uint8_t>((top[last] + bottom[last] + 1) >> 1);
        }
    }
}

bool can_double() {
    int num_factors = 0;
    const tjscalingfactor* factors = tjGetScalingFactors(&num_factors);
    return std::any_of(factors, factors + num_factors, [](const tjscalingfactor& factor) {
        return factor.num == 2 && factor.denom == 1;
    });
}

// Decodes colours at half of the mask's size, rounded up: the last row or column may be cut off.
Expected<void> decode_doubled(std::span<const std::uint8_t> bytes,
                              int width,
                              int height,
                              tjhandle decoder,
                              int flags,
                              std::vector<std::uint8_t>& doubled,
                              DecodedTexture& out) {
    static const bool is_possible = can_double();
    if (!is_possible)
        return make_error(ErrorKind::kInternal, "JPEG decoder: does not support 2x scaling");
    const std::size_t stride = static_cast<std::size_t>(2 * width) * 4;
    doubled.resize(stride * static_cast<std::size_t>(2 * height));
    if (tjDecompress2(decoder,
                      bytes.data(),
                      bytes.size(),
                      doubled.data(),
                      2 * width,
                      0,
                      2 * height,
                      TJPF_RGBA,
                      flags) != 0) {
        return jpeg_error(decoder, "coded colours are damaged");
    }
    const std::size_t row_bytes = static_cast<std::size_t>(out.width) * 4;
    for (std::size_t y = 0; y < static_cast<std::size_t>(out.height); ++y)
        std::copy_n(&doubled[y * stride], row_bytes, &out.rgba[y * row_bytes]);
    return {};
}

Expected<void> decode_colour(std::span<const std::uint8_t> bytes,
                             const image::Mask& mask,
                             tjhandle decoder,
                             std::vector<std::uint8_t>& doubled,
                             DecodedTexture& out) {
    if (!decoder) return make_error(ErrorKind::kInternal, "JPEG decoder: cannot be created");
    if (bytes.empty() || bytes.size() > kMaxColourBytes) {
        return make_error(ErrorKind::kInvalidData,
                          "coded colours: " + std::to_string(bytes.size()) +
                              " bytes, must be 1 to " + std::to_string(kMaxColourBytes));
    }
    int width = 0;
    int height = 0;
    int sampling = 0;
    int colour_space = 0;
    if (tjDecompressHeader3(
            decoder, bytes.data(), bytes.size(), &width, &height, &sampling, &colour_space) != 0) {
        return jpeg_error(decoder, "coded colours are damaged");
    }
    const bool is_whole = width == mask.width && height == mask.height;
    const bool is_half = width == half_of(mask.width) && height == half_of(mask.height);
    if (!is_whole && !is_half) {
        return make_error(ErrorKind::kInvalidData,
                          "colours of " + size_text(width, height) + " with a mask of " +
                              size_text(mask.width, mask.height));
    }
    if (sampling != TJSAMP_444 || colour_space != TJCS_YCbCr) {
        return make_error(ErrorKind::kInvalidData, "coded colours are not YCbCr 4:4:4");
    }
    out.width = mask.width;
    out.height = mask.height;
    out.rgba.resize(mask.data.size() * 4);
    // limit the scans: thousands of them would take minutes
    constexpr int kFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
    if (!is_whole) return decode_doubled(bytes, width, height, decoder, kFlags, doubled, out);
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

// Writes whole pixels, which the compiler can vectorise.
void set_alpha(const image::Mask& mask, std::vector<std::uint8_t>& rgba) {
    static_assert(std::endian::native == std::endian::little);
    const std::uint8_t* __restrict alpha = mask.data.data();
    std::uint8_t* __restrict pixels = rgba.data();
    for (std::size_t i = 0; i < mask.data.size(); ++i) {
        std::uint32_t pixel = 0;
        std::memcpy(&pixel, pixels + 4 * i, sizeof pixel);
        pixel = (pixel & 0x00ffffffU) | (std::uint32_t{alpha[i]} << 24U);
        std::memcpy(pixels + 4 * i, &pixel, sizeof pixel);
    }
}

}  // namespace

Expected<void> TextureEncoder::encode(const TextureCrop& crop, int quality, CodedTexture& out) {
    return encode(crop, quality, 1, out);
}

Expected<void> TextureEncoder::encode(const TextureCrop& crop,
                                      int quality,
                                      int divisor,
                                      CodedTexture& out) {
    assert(quality >= 1 && quality <= 100);
    assert(divisor == 1 || divisor == 2);
    for (const image::Plane* plane : {&crop.u, &crop.v, &crop.mask}) {
        if (plane->width != crop.width() || plane->height != crop.height()) {
            return make_error(ErrorKind::kInvalidData, "the planes of a texture differ in size");
        }
    }
    if (!is_texture_size(crop.width(), crop.height())) {
        return make_error(ErrorKind::kInvalidData,
                          "texture of " + size_text(crop.width(), crop.height()) +
                              " pixels; must have 1 to " + std::to_string(kMaxTextureSide) +
                              " per side and at most " + std::to_string(kMaxTexturePixels) +
                              " in total");
    }
    if (divisor == 2) {
        halve(crop.y, state_->half.y);
        halve(crop.u, state_->half.u);
        halve(crop.v, state_->half.v);
    }
    const TextureCrop& colours = divisor == 2 ? state_->half : crop;
    if (auto coded = encode_colour(colours, quality, state_->jpeg, out.colour); !coded)
        return coded;
    encode_mask(crop.mask, out.mask);
    return {};
}

Expected<void> TextureDecoder::decode(std::span<const std::uint8_t> colour,
                                      std::span<const std::uint8_t> mask,
                                      DecodedTexture& out) {
    if (auto decoded = decode_mask(mask, state_->mask); !decoded) return decoded;
    if (auto decoded = decode_colour(colour, state_->mask, state_->jpeg, state_->doubled, out);
        !decoded) {
        state_->restart();
        return decoded;
    }
    set_alpha(state_->mask, out.rgba);
    return {};
}

}  // namespace atrium::codec
