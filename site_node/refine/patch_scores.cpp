#include "site_node/refine/patch_scores.hpp"

#include "site_node/refine/lanes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace atrium::refine {
namespace {

// Samples of a patch: all of 5 x 5 but the middle one.
constexpr int kNumVectors = 3;
constexpr std::array<Floats, kNumVectors> kColumns = {Floats{-2, -1, 0, 1, 2, -2, -1, 0},
                                                      Floats{1, 2, -2, -1, 1, 2, -2, -1},
                                                      Floats{0, 1, 2, -2, -1, 0, 1, 2}};
constexpr std::array<Floats, kNumVectors> kRows = {Floats{-2, -2, -2, -2, -2, -1, -1, -1},
                                                   Floats{-1, -1, 0, 0, 0, 0, 1, 1},
                                                   Floats{1, 1, 1, 2, 2, 2, 2, 2}};
constexpr float kNumSamples = kNumVectors * kLanes;
constexpr float kExtent = 2.0F;
constexpr float kLeastDeviation = 2.0F;  // [grey levels] less is noise

struct Patch {
    std::array<Floats, kNumVectors> values;
};

// Where the samples of a path's patches lie, from their centres.
struct Offsets {
    std::array<Floats, kNumVectors> x;
    std::array<Floats, kNumVectors> y;
    float reach_x;
    float reach_y;
};

struct BaselineFetch {
    void operator()(const std::uint32_t* taps, const Ints& places, Words& out) const {
        for (int lane = 0; lane < kLanes; ++lane) out[lane] = taps[places[lane]];
    }
};

#ifdef ATRIUM_AVX2
struct Avx2Fetch {
    ATRIUM_AVX2 void operator()(const std::uint32_t* taps, const Ints& places, Words& out) const {
        out = (Words)_mm256_i32gather_epi32(reinterpret_cast<const int*>(taps), (__m256i)places, 4);
    }
};
#endif

ATRIUM_INLINE void byte_of(const Words& taps, unsigned shift, Floats& out) {
    out = __builtin_convertvector((Ints)((taps >> shift) & 0xFFU), Floats);
}

ATRIUM_INLINE void find_offsets(const PatchPath& path, Offsets& out) {
    for (std::size_t k = 0; k < kNumVectors; ++k) {
        out.x[k] = path.column_px.x() * kColumns[k] + path.row_px.x() * kRows[k];
        out.y[k] = path.column_px.y() * kColumns[k] + path.row_px.y() * kRows[k];
    }
    out.reach_x = kExtent * (std::abs(path.column_px.x()) + std::abs(path.row_px.x()));
    out.reach_y = kExtent * (std::abs(path.column_px.y()) + std::abs(path.row_px.y()));
}

// Samples the patch around `centre`, with mean 0 and length 1. False if it is not wholly inside the
// silhouette, or has no contrast.
template <typename Fetch>
ATRIUM_INLINE bool sample(const LumaPicture& picture,
                          const Offsets& offsets,
                          float centre_x,
                          float centre_y,
                          const Fetch& fetch,
                          Patch& out) {
    if (!(centre_x - offsets.reach_x >= 0.0F && centre_y - offsets.reach_y >= 0.0F &&
          centre_x + offsets.reach_x < static_cast<float>(picture.width - 1) &&
          centre_y + offsets.reach_y < static_cast<float>(picture.height - 1)))
        return false;
    const auto middle = static_cast<std::size_t>(static_cast<int>(centre_y + 0.5F) * picture.width +
                                                 static_cast<int>(centre_x + 0.5F));
    if (picture.inside[middle] == 0) return false;
    Floats total{};
    for (int i = 0; i < kNumVectors; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Floats x = centre_x + offsets.x[k];
        const Floats y = centre_y + offsets.y[k];
        const Ints column = __builtin_convertvector(x, Ints);
        const Ints row = __builtin_convertvector(y, Ints);
        const Floats right = x - __builtin_convertvector(column, Floats);
        const Floats down = y - __builtin_convertvector(row, Floats);
        Words taps;
        fetch(picture.taps.data(), row * picture.width + column, taps);
        Floats a, b, c, d;
        byte_of(taps, 0, a);
        byte_of(taps, 8, b);
        byte_of(taps, 16, c);
        byte_of(taps, 24, d);
        const Floats upper = a + right * (b - a);
        const Floats lower = c + right * (d - c);
        out.values[k] = upper + down * (lower - upper);
        total += out.values[k];
    }
    const float mean = sum_of(total) / kNumSamples;
    Floats squares{};
    for (Floats& value : out.values) {
        value -= mean;
        squares += value * value;
    }
    const float square = sum_of(squares);
    if (!(square >= kLeastDeviation * kLeastDeviation * kNumSamples)) return false;
    const float scale = 1.0F / std::sqrt(square);
    for (Floats& value : out.values) value *= scale;
    return true;
}

ATRIUM_INLINE float correlation(const Patch& a, const Patch& b) {
    const Floats products =
        a.values[0] * b.values[0] + a.values[1] * b.values[1] + a.values[2] * b.values[2];
    return sum_of(products);
}

ATRIUM_INLINE float agreement(const std::array<Patch, kMostPaths>& patches, std::size_t num) {
    if (num < 2) return kUnknownScore;
    const float first = correlation(patches[0], patches[1]);
    if (num == 2) return first;
    const float second = correlation(patches[0], patches[2]);
    const float third = correlation(patches[1], patches[2]);
    return 0.5F * (first + second + third - std::min(first, std::min(second, third)));
}

template <typename Fetch>
ATRIUM_INLINE void score(std::span<const PatchPath> paths,
                         const ScoredSteps& steps,
                         const Fetch& fetch,
                         std::span<float> scores) {
    std::array<Offsets, kMostPaths> offsets;
    for (std::size_t k = 0; k < paths.size(); ++k) find_offsets(paths[k], offsets[k]);
    for (std::size_t step = steps.first; step < scores.size(); step += steps.stride) {
        const float share =
            steps.num < 2 ? 0.0F : static_cast<float>(step) / static_cast<float>(steps.num - 1);
        std::array<Patch, kMostPaths> patches;
        std::size_t num = 0;
        for (std::size_t k = 0; k < paths.size(); ++k) {
            const PatchPath& path = paths[k];
            // the projection of even steps on a line
            const float last = share * path.last_depth_m;
            const float depth = (1.0F - share) * path.first_depth_m + last;
            const float weight = last / depth;
            const float x = path.first_px.x() + weight * (path.last_px.x() - path.first_px.x());
            const float y = path.first_px.y() + weight * (path.last_px.y() - path.first_px.y());
            if (sample(*path.picture, offsets[k], x, y, fetch, patches[num])) ++num;
        }
        scores[step] = agreement(patches, num);
    }
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void score_avx2(std::span<const PatchPath> paths,
                            const ScoredSteps& steps,
                            std::span<float> scores) {
    score(paths, steps, Avx2Fetch{}, scores);
}
#endif

}  // namespace

void score_depths(std::span<const PatchPath> paths,
                  const ScoredSteps& steps,
                  std::span<float> scores,
                  [[maybe_unused]] image::RowCode code) {
    assert(paths.size() >= 2 && paths.size() <= kMostPaths && scores.size() <= steps.num &&
           steps.stride > 0);
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return score_avx2(paths, steps, scores);
#endif
    score(paths, steps, BaselineFetch{}, scores);
}

}  // namespace atrium::refine
