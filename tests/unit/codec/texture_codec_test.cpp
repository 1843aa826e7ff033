#include "core/codec/texture_codec.hpp"

#include "core/codec/jpeg_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::codec {
namespace {

using testing::ElementsAreArray;
using testing::HasSubstr;

image::Mask noise_mask(int width, int height, double density, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution on(density);
    image::Mask mask(width, height);
    for (std::uint8_t& value : mask.data) value = on(random) ? 255 : 0;
    return mask;
}

// About as large and as complex as a standing person at half of 1 MP.
image::Mask figure_mask() {
    image::Mask mask(200, 440);
    for (int y = 0; y < 440; ++y) {
        for (int x = 0; x < 200; ++x) {
            const double waist = 45 + 10 * std::cos(y * 0.04) + 1.5 * std::sin(y * 0.9);
            const bool body = y > 60 && y < 260 && std::abs(x - 100) < waist;
            const bool leg =
                y >= 250 && y < 430 && std::abs(std::abs(x - 100) - 30 - (y - 250) * 0.1) < 18;
            const bool head = std::hypot(x - 100, y - 40) < 34;
            const bool arm = y > 80 && y < 240 && std::abs(std::abs(x - 100) - 80) < 12;
            if (body || leg || head || arm) mask.row(y)[x] = 255;
        }
    }
    return mask;
}

TextureCrop smooth_crop(const image::Mask& mask) {
    TextureCrop crop;
    crop.mask = mask;
    for (image::Plane* plane : {&crop.y, &crop.u, &crop.v})
        *plane = image::Plane(mask.width, mask.height);
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            crop.y.row(y)[x] =
                static_cast<std::uint8_t>(128 + 60 * std::sin(x * 0.11) * std::cos(y * 0.07));
            crop.u.row(y)[x] = static_cast<std::uint8_t>(128 + 20 * std::sin(y * 0.05));
            crop.v.row(y)[x] = static_cast<std::uint8_t>(128 - 25 * std::sin(x * 0.06));
        }
    }
    return crop;
}

CodedTexture coded(const TextureCrop& crop, int quality = 85, int divisor = 1) {
    CodedTexture result;
    EXPECT_TRUE(TextureEncoder().encode(crop, quality, divisor, result).has_value());
    return result;
}

// Root mean square error of the three colours, in grey levels.
double rms_error(const TextureCrop& crop, const DecodedTexture& decoded) {
    double error_sq = 0.0;
    for (std::size_t i = 0; i < crop.y.data.size(); ++i) {
        const double y = crop.y.data[i];
        const double u = crop.u.data[i] - 128.0;
        const double v = crop.v.data[i] - 128.0;
        const double rgb[3] = {y + 1.402 * v, y - 0.344136 * u - 0.714136 * v, y + 1.772 * u};
        for (std::size_t c = 0; c < 3; ++c) {
            const double error = decoded.rgba[4 * i + c] - std::clamp(rgb[c], 0.0, 255.0);
            error_sq += error * error / 3.0;
        }
    }
    return std::sqrt(error_sq / static_cast<double>(crop.y.data.size()));
}

TEST(MaskCodec, RoundTripIsExact) {
    std::vector<std::uint8_t> bytes;
    image::Mask back;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const image::Mask mask = noise_mask(
            1 + static_cast<int>(seed) * 3, 1 + static_cast<int>(seed * 7 % 50), seed / 59.0, seed);
        encode_mask(mask, bytes);
        ASSERT_TRUE(decode_mask(bytes, back).has_value()) << seed;
        EXPECT_EQ(back.width, mask.width);
        EXPECT_EQ(back.data, mask.data);
    }
    image::Mask stripes(kMaxTextureSide, 3);
    for (int x = 0; x < stripes.width; x += 2) stripes.row(1)[x] = 255;
    encode_mask(stripes, bytes);
    ASSERT_TRUE(decode_mask(bytes, back).has_value());
    EXPECT_EQ(back.data, stripes.data);
}

TEST(MaskCodec, PersonTakesLessThanAKilobyte) {
    std::vector<std::uint8_t> bytes;
    encode_mask(figure_mask(), bytes);
    EXPECT_LT(bytes.size(), 1000u);
}

// These bytes are format version 1. A change here is a change of the wire format.
TEST(MaskCodec, FormatVersionOneIsUnchanged) {
    image::Mask mask(6, 4);
    std::fill_n(mask.row(1) + 2, 2, 255);
    std::fill_n(mask.row(2) + 1, 4, 255);
    std::fill_n(mask.row(3) + 1, 5, 255);
    std::vector<std::uint8_t> bytes;
    encode_mask(mask, bytes);
    // rows: 1 | 0 011 011 010 (two changes, at 2 and 2 + 1 + 1) | 1 011 010 (moved by -1 and 1) | 0
    // 010 010 (one, at 1)
    EXPECT_THAT(bytes, ElementsAreArray({1, 6, 0, 4, 0, 0b10011011, 0b01010110, 0b10001001, 0}));
}

TEST(MaskCodec, RejectsEveryTruncationAndTrailingBytes) {
    std::vector<std::uint8_t> bytes;
    encode_mask(figure_mask(), bytes);
    image::Mask out;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const std::vector<std::uint8_t> cut(bytes.begin(),
                                            bytes.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(decode_mask(cut, out).has_value()) << size;
    }
    bytes.push_back(0);
    EXPECT_FALSE(decode_mask(bytes, out).has_value());
}

TEST(MaskCodec, RejectsEmptyAndTooLargeSizes) {
    image::Mask out;
    std::vector<std::uint8_t> bytes(8192, 0xFF);
    const auto with_size = [&](int width, int height) {
        bytes[0] = 1;
        bytes[1] = static_cast<std::uint8_t>(width & 255);
        bytes[2] = static_cast<std::uint8_t>(width >> 8);
        bytes[3] = static_cast<std::uint8_t>(height & 255);
        bytes[4] = static_cast<std::uint8_t>(height >> 8);
        return decode_mask(bytes, out);
    };
    for (const auto& [width, height] :
         {std::pair{0, 9}, {9, 0}, {4097, 9}, {9, 4097}, {65535, 65535}, {4096, 1025}}) {
        EXPECT_THAT(with_size(width, height).error().message, HasSubstr("empty or too large"))
            << width;
    }
    // a few bytes cannot claim thousands of rows
    bytes.resize(20);
    EXPECT_THAT(with_size(1000, 4000).error().message, HasSubstr("truncated"));
}

TEST(MaskCodec, SurvivesRandomBytesAndBitFlips) {
    std::mt19937 random(9);
    std::uniform_int_distribution<int> byte(0, 255);
    image::Mask out;
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(5 + i % 200));
        for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(byte(random));
        bytes[0] = 1;
        bytes[2] = bytes[4] = 0;
        if (!decode_mask(bytes, out)) continue;
        EXPECT_EQ(out.data.size(),
                  static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    }
    std::vector<std::uint8_t> good;
    encode_mask(figure_mask(), good);
    for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
        std::vector<std::uint8_t> bad = good;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        if (!decode_mask(bad, out)) continue;
        for (const std::uint8_t value : out.data) ASSERT_TRUE(value == 0 || value == 255);
    }
}

TEST(TextureCodec, KeepsColoursWithinAFewLevelsAndAlphaExactly) {
    const TextureCrop crop = smooth_crop(figure_mask());
    const CodedTexture texture = coded(crop, 90);
    TextureDecoder decoder;
    DecodedTexture out;
    ASSERT_TRUE(decoder.decode(texture.colour, texture.mask, out).has_value());
    ASSERT_EQ(out.width, crop.width());
    ASSERT_EQ(out.height, crop.height());
    for (std::size_t i = 0; i < crop.mask.data.size(); ++i)
        ASSERT_EQ(out.rgba[4 * i + 3], crop.mask.data[i]);
    EXPECT_LT(rms_error(crop, out), 1.5);
}

// A shift by half a pixel, a common doubling mistake, would cost about 3 levels here.
TEST(TextureCodec, HalfSizeColoursKeepTheirPlaceAndTheMaskIsExact) {
    TextureDecoder decoder;
    DecodedTexture out;
    for (const auto& [width, height] : {std::pair{200, 440}, {199, 439}, {200, 33}, {37, 440}}) {
        TextureCrop crop = smooth_crop(noise_mask(width, height, 0.5, 4));
        const CodedTexture whole = coded(crop, 95);
        const CodedTexture half = coded(crop, 95, 2);
        EXPECT_LT(half.colour.size(), whole.colour.size()) << width << "x" << height;
        EXPECT_EQ(half.mask, whole.mask);
        const auto decoded = decoder.decode(half.colour, half.mask, out);
        ASSERT_TRUE(decoded.has_value()) << decoded.error().message;
        ASSERT_EQ(out.width, width);
        ASSERT_EQ(out.height, height);
        EXPECT_LT(rms_error(crop, out), 2.0) << width << "x" << height;
        for (std::size_t i = 0; i < crop.mask.data.size(); ++i)
            ASSERT_EQ(out.rgba[4 * i + 3], crop.mask.data[i]);
    }
}

TEST(TextureCodec, HalvesSmallAndOddSizes) {
    TextureDecoder decoder;
    DecodedTexture out;
    for (int width = 1; width <= 18; ++width) {
        for (int height = 1; height <= 18; ++height) {
            const CodedTexture bytes = coded(smooth_crop(image::Mask(width, height, 255)), 85, 2);
            ASSERT_TRUE(decoder.decode(bytes.colour, bytes.mask, out).has_value())
                << width << "x" << height;
            EXPECT_EQ(out.width, width);
            EXPECT_EQ(out.height, height);
            EXPECT_EQ(out.rgba.size(), static_cast<std::size_t>(4 * width * height));
        }
    }
}

TEST(TextureCodec, AcceptsOnlyTheRoundedUpHalfSize) {
    const CodedTexture mask_33 = coded(smooth_crop(image::Mask(33, 33, 255)));
    DecodedTexture out;
    for (int width = 1; width <= 66; ++width) {
        for (const int height : {16, 17, 18, 33}) {
            const CodedTexture colours = coded(smooth_crop(image::Mask(width, height, 255)));
            const bool fits = (width == 17 && height == 17) || (width == 33 && height == 33);
            EXPECT_EQ(TextureDecoder().decode(colours.colour, mask_33.mask, out).has_value(), fits)
                << width << "x" << height;
        }
    }
}

TEST(TextureCodec, SurvivesDamagedColoursAtHalfSize) {
    const CodedTexture good = coded(smooth_crop(noise_mask(41, 39, 0.5, 2)), 85, 2);
    TextureDecoder decoder;
    DecodedTexture out;
    for (std::size_t size = 0; size < good.colour.size(); ++size) {
        const std::vector<std::uint8_t> cut(
            good.colour.begin(), good.colour.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(decoder.decode(cut, good.mask, out).has_value()) << size;
    }
    for (std::size_t bit = 0; bit < good.colour.size() * 8; ++bit) {
        std::vector<std::uint8_t> bad = good.colour;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        if (!decoder.decode(bad, good.mask, out)) continue;
        EXPECT_EQ(out.rgba.size(), 41u * 39u * 4u);
    }
    EXPECT_TRUE(decoder.decode(good.colour, good.mask, out).has_value());
}

TEST(TextureCodec, EveryQualityCodesTheHardestPicture) {
    // noise of extreme colours uses every word of the Huffman code, including the longest
    const image::Mask mask(72, 56, 255);
    TextureCrop crop = smooth_crop(mask);
    std::mt19937 random(11);
    for (image::Plane* plane : {&crop.y, &crop.u, &crop.v}) {
        for (std::uint8_t& value : plane->data) value = random() % 2 == 0 ? 0 : 255;
    }
    TextureDecoder decoder;
    DecodedTexture out;
    std::size_t last_size = 0;
    for (int quality = 1; quality <= 100; ++quality) {
        const CodedTexture texture = coded(crop, quality);
        ASSERT_TRUE(decoder.decode(texture.colour, texture.mask, out).has_value()) << quality;
        EXPECT_GE(texture.colour.size() + 200, last_size) << quality;
        last_size = texture.colour.size();
    }
    EXPECT_EQ(quantisation_step(50), 48);
    EXPECT_EQ(quantisation_step(86), 13);
    EXPECT_EQ(quantisation_step(100), 1);
    EXPECT_EQ(quantisation_step(1), 255);
}

// A picture loses at most half a step per coefficient. A block of constant colour has one.
TEST(TextureCodec, ConstantColourErrorIsAtMostItsStep) {
    for (const int quality : {50, 86, 95}) {
        const int allowed = quantisation_step(quality) / 16 + 1;
        TextureCrop crop = smooth_crop(image::Mask(16, 16, 255));
        std::fill(crop.y.data.begin(), crop.y.data.end(), 77);
        std::fill(crop.u.data.begin(), crop.u.data.end(), 128);
        std::fill(crop.v.data.begin(), crop.v.data.end(), 128);
        const CodedTexture texture = coded(crop, quality);
        DecodedTexture out;
        ASSERT_TRUE(TextureDecoder().decode(texture.colour, texture.mask, out).has_value());
        EXPECT_NEAR(out.rgba[0], 77, allowed) << quality;
    }
}

TEST(TextureCodec, EncoderNamesTheReasonOfARefusal) {
    TextureEncoder encoder;
    CodedTexture out;
    TextureCrop crop;
    EXPECT_THAT(encoder.encode(crop, 85, out).error().message, HasSubstr("0x0"));
    crop = smooth_crop(image::Mask(16, 16, 255));
    crop.v = image::Plane(16, 15);
    EXPECT_THAT(encoder.encode(crop, 85, out).error().message, HasSubstr("differ in size"));
    crop = smooth_crop(image::Mask(kMaxTextureSide + 2, 2));
    EXPECT_THAT(encoder.encode(crop, 85, out).error().message, HasSubstr("4098x2"));
}

TEST(TextureCodec, CodesSmallAndOddSizes) {
    TextureEncoder encoder;
    TextureDecoder decoder;
    CodedTexture bytes;
    DecodedTexture out;
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 9}, {17, 8}}) {
        ASSERT_TRUE(
            encoder.encode(smooth_crop(image::Mask(width, height, 255)), 85, bytes).has_value());
        ASSERT_TRUE(decoder.decode(bytes.colour, bytes.mask, out).has_value()) << width;
        EXPECT_EQ(out.rgba.size(), static_cast<std::size_t>(4 * width * height));
    }
}

TEST(TextureCodec, RejectsEveryTruncation) {
    const CodedTexture texture = coded(smooth_crop(noise_mask(60, 50, 0.5, 1)));
    TextureDecoder decoder;
    DecodedTexture out;
    for (std::size_t size = 0; size < texture.colour.size(); ++size) {
        // an exact-size copy lets the address sanitizer see reads past its end
        const std::vector<std::uint8_t> cut(
            texture.colour.begin(), texture.colour.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(decoder.decode(cut, texture.mask, out).has_value()) << size;
    }
    const auto whole = decoder.decode(texture.colour, texture.mask, out);
    EXPECT_TRUE(whole.has_value()) << (whole ? "" : whole.error().message);
}

TEST(TextureCodec, RejectsColoursThatDifferInSizeFromTheMask) {
    const CodedTexture small = coded(smooth_crop(image::Mask(16, 16, 255)));
    const CodedTexture large = coded(smooth_crop(image::Mask(16, 24, 255)));
    DecodedTexture out;
    EXPECT_THAT(TextureDecoder().decode(large.colour, small.mask, out).error().message,
                HasSubstr("16x24"));
}

TEST(TextureCodec, RejectsAHugeHeaderSizeBeforeAllocation) {
    CodedTexture texture = coded(smooth_crop(image::Mask(16, 16, 255)));
    // height and width in the start-of-frame segment
    const std::vector<std::uint8_t> marker = {0xFF, 0xC0};
    const auto frame =
        std::search(texture.colour.begin(), texture.colour.end(), marker.begin(), marker.end());
    ASSERT_NE(frame, texture.colour.end());
    std::fill_n(frame + 5, 4, 0xFF);
    DecodedTexture out;
    EXPECT_FALSE(TextureDecoder().decode(texture.colour, texture.mask, out).has_value());
    EXPECT_TRUE(out.rgba.empty());
    const std::vector<std::uint8_t> too_long(kMaxColourBytes + 1, 0);
    EXPECT_FALSE(TextureDecoder().decode(too_long, texture.mask, out).has_value());
}

TEST(TextureCodec, SurvivesRandomBytesAndBitFlips) {
    const CodedTexture good = coded(smooth_crop(noise_mask(40, 40, 0.5, 2)));
    TextureDecoder decoder;
    DecodedTexture out;
    for (std::size_t bit = 0; bit < good.colour.size() * 8; ++bit) {
        std::vector<std::uint8_t> bad = good.colour;
        bad[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        if (!decoder.decode(bad, good.mask, out)) continue;
        EXPECT_EQ(out.rgba.size(), 40u * 40u * 4u);
    }
    std::mt19937 random(3);
    std::uniform_int_distribution<int> byte(0, 255);
    for (int i = 0; i < 500; ++i) {
        std::vector<std::uint8_t> bytes(static_cast<std::size_t>(i));
        for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(byte(random));
        EXPECT_FALSE(decoder.decode(bytes, good.mask, out).has_value());
    }
    // the decoder still works afterwards
    EXPECT_TRUE(decoder.decode(good.colour, good.mask, out).has_value());
}

}  // namespace
}  // namespace atrium::codec
