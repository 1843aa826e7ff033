#include "site_node/refine/smooth_depths.hpp"

#include "site_node/refine/lanes.hpp"

#include <algorithm>
#include <cstring>
#include <span>

namespace atrium::refine {
namespace {

struct BaselineGather {
    void operator()(const float* depths, const std::uint32_t* places, Floats& out) const {
        for (int lane = 0; lane < kLanes; ++lane) out[lane] = depths[places[lane]];
    }
};

#ifdef ATRIUM_AVX2
struct Avx2Gather {
    ATRIUM_AVX2 void operator()(const float* depths,
                                const std::uint32_t* places,
                                Floats& out) const {
        __m256i indices;
        std::memcpy(&indices, places, sizeof(indices));
        out = _mm256_i32gather_ps(depths, indices, 4);
    }
};
#endif

struct Problem {
    std::span<const float> found_m;
    std::span<const float> weights;
    std::span<const std::uint8_t> is_held;
    std::span<const float> earlier_m;
    std::span<const float> earlier_weights;
    std::span<const float> most_m;
    std::span<const std::uint32_t> begins;
    const std::uint32_t* neighbours;
    const float* shares;
};

// Falls to a quarter for what is as far off as an outlier.
ATRIUM_INLINE float weight_of(float weight, float off_m, float per_outlier) {
    const float off = off_m * per_outlier;
    const float doubt = 1.0F + off * off;
    return weight / (doubt * doubt);
}

template <typename Gather>
ATRIUM_INLINE void go_through(const Problem& of,
                              const SmoothDepthsOptions& options,
                              float outlier_m,
                              const Gather& gather,
                              float* depths_m) {
    const float per_outlier = 1.0F / outlier_m;
    const float per_earlier_outlier = 1.0F / options.outlier_m;
    for (std::size_t i = 0; i < of.found_m.size(); ++i) {
        float sum = 0.0F;
        float weight = options.hull_weight;
        if (of.is_held[i] != 0) {
            weight += options.held_weight;
        } else if (of.weights[i] > 0.0F) {
            const float own = weight_of(of.weights[i], depths_m[i] - of.found_m[i], per_outlier);
            sum += own * of.found_m[i];
            weight += own;
        }
        if (of.earlier_weights[i] > 0.0F) {
            const float own = weight_of(
                of.earlier_weights[i], depths_m[i] - of.earlier_m[i], per_earlier_outlier);
            sum += own * of.earlier_m[i];
            weight += own;
        }
        if (of.begins[i] != of.begins[i + 1]) {
            Floats sums{};
            for (std::uint32_t k = of.begins[i]; k < of.begins[i + 1]; k += kLanes) {
                Floats there, shares;
                gather(depths_m, of.neighbours + k, there);
                std::memcpy(&shares, of.shares + k, sizeof(shares));
                sums += shares * there;
            }
            sum += options.smoothness * sum_of(sums);
            weight += options.smoothness;
        }
        depths_m[i] = std::clamp(sum / weight, 0.0F, of.most_m[i]);
    }
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void go_through_avx2(const Problem& of,
                                 const SmoothDepthsOptions& options,
                                 float outlier_m,
                                 float* depths_m) {
    go_through(of, options, outlier_m, Avx2Gather{}, depths_m);
}
#endif

}  // namespace

void SmoothDepths::assign(const Surfels& surfels) {
    constexpr float kMostOfThickness = 0.45F;  // both sides may move
    const std::size_t size = surfels.size();
    found_m.assign(size, 0.0F);
    weights.assign(size, 0.0F);
    is_held.assign(size, 0);
    earlier_m.assign(size, 0.0F);
    earlier_weights.assign(size, 0.0F);
    depths_m.assign(size, 0.0F);
    most_m_.clear();
    begins_.assign(1, 0);
    neighbours_.clear();
    shares_.clear();
    for (std::size_t i = 0; i < size; ++i) {
        most_m_.push_back(kMostOfThickness * surfels[i].thickness_m);
        float sum = 0.0F;
        for (const Surfels::Neighbour& other : surfels.neighbours(i)) {
            neighbours_.push_back(other.surfel);
            shares_.push_back(other.weight);
            sum += other.weight;
        }
        const float share = sum > 0.0F ? 1.0F / sum : 0.0F;
        if (!(sum > 0.0F)) {
            neighbours_.resize(begins_.back());
            shares_.resize(begins_.back());
        }
        const std::size_t filled = (neighbours_.size() + kLanes - 1) / kLanes;
        neighbours_.resize(filled * kLanes, static_cast<std::uint32_t>(i));
        shares_.resize(neighbours_.size(), 0.0F);
        for (std::size_t k = begins_.back(); k < shares_.size(); ++k) shares_[k] *= share;
        begins_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
    }
}

void SmoothDepths::solve(const SmoothDepthsOptions& options,
                         int num_rounds,
                         float first_outlier_m,
                         [[maybe_unused]] image::RowCode code) {
    const Problem problem{found_m,
                          weights,
                          is_held,
                          earlier_m,
                          earlier_weights,
                          most_m_,
                          begins_,
                          neighbours_.data(),
                          shares_.data()};
    float outlier_m = first_outlier_m;
    for (int round = 0; round < num_rounds; ++round) {
        outlier_m = std::max(options.outlier_m, kNarrowing * outlier_m);
#ifdef ATRIUM_AVX2
        if (code == image::RowCode::kAvx2) {
            go_through_avx2(problem, options, outlier_m, depths_m.data());
            continue;
        }
#endif
        go_through(problem, options, outlier_m, BaselineGather{}, depths_m.data());
    }
}

}  // namespace atrium::refine
