#pragma once

#include "core/codec/texture_codec.hpp"

#include <cstddef>

namespace atrium::test {

/// Peak signal-to-noise ratio of 8-bit samples, in dB: 10 log10(255^2 / mean squared error).
/// Infinite without differences or without samples.
class SampleError {
public:
    void add(double original, double decoded) {
        sum_sq_ += (original - decoded) * (original - decoded);
        ++num_samples_;
    }
    void add(const SampleError& other) {
        sum_sq_ += other.sum_sq_;
        num_samples_ += other.num_samples_;
    }
    double psnr_db() const;
    std::size_t num_samples() const { return num_samples_; }

private:
    double sum_sq_ = 0.0;
    std::size_t num_samples_ = 0;
};

/// Over the foreground only. The rest is invented before coding and never shown.
struct TextureError {
    SampleError rgb;     // over R, G and B
    SampleError luma;    // Y
    SampleError chroma;  // over Cb and Cr

    SampleError ycbcr() const {  // over Y, Cb and Cr
        SampleError all = luma;
        all.add(chroma);
        return all;
    }
    void add(const TextureError& other) {
        rgb.add(other.rgb);
        luma.add(other.luma);
        chroma.add(other.chroma);
    }
};

/// Difference between the picture that a viewer shows and the cropped half-resolution picture (its
/// colours as real numbers, clamped to 0 and 255). Both have the same size.
TextureError texture_error(const codec::TextureCrop& original, const codec::DecodedTexture& shown);

}  // namespace atrium::test
