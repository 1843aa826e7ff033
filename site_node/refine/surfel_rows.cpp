#include "site_node/refine/surfel_rows.hpp"

#include "site_node/refine/lanes.hpp"

#include <bit>
#include <cstring>

namespace atrium::refine {
namespace {

static_assert(SurfelRows::kMargin >= kLanes);
constexpr Ints kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};

// Looks the other way if the cosine between the normals is at most this.
constexpr float kOppositeCosine = -0.2F;

ATRIUM_INLINE void load(const std::vector<float>& from, std::uint32_t at, Floats& out) {
    std::memcpy(&out, from.data() + at, sizeof(out));
}

// One bit per lane.
struct BaselineBits {
    unsigned operator()(const Ints& flags) const {
        unsigned bits = 0;
        for (int lane = 0; lane < kLanes; ++lane)
            bits |= (static_cast<unsigned>(flags[lane]) & 1U) << lane;
        return bits;
    }
};

#ifdef ATRIUM_AVX2
struct Avx2Bits {
    ATRIUM_AVX2 unsigned operator()(const Ints& flags) const {
        return static_cast<unsigned>(_mm256_movemask_ps((__m256)flags));
    }
};
#endif

template <typename Bits>
ATRIUM_INLINE void near_in(const SurfelRows& rows,
                           std::span<const SurfelRun> runs,
                           const Eigen::Vector3f& centre,
                           float radius_sq,
                           const Bits& bits,
                           std::vector<NearSurfel>& found) {
    found.clear();
    for (const SurfelRun& run : runs) {
        for (std::uint32_t i = run.begin; i < run.end; i += kLanes) {
            Floats x, y, z;
            load(rows.positions_site.x, i, x);
            load(rows.positions_site.y, i, y);
            load(rows.positions_site.z, i, z);
            x -= centre.x();
            y -= centre.y();
            z -= centre.z();
            const Floats distance_sq = x * x + y * y + z * z;
            const Ints is_near = (distance_sq <= radius_sq) &
                                 (kLaneNumbers < static_cast<std::int32_t>(run.end - i));
            for (unsigned left = bits(is_near); left != 0; left &= left - 1) {
                const auto lane = static_cast<unsigned>(std::countr_zero(left));
                found.push_back({i + lane, distance_sq[lane]});
            }
        }
    }
}

ATRIUM_INLINE float opposite_in(const SurfelRows& rows,
                                std::span<const SurfelRun> runs,
                                const InwardLine& line,
                                float most_m) {
    const Eigen::Vector3f& normal = line.normal;
    Floats least = Floats{} + most_m;
    for (const SurfelRun& run : runs) {
        for (std::uint32_t i = run.begin; i < run.end; i += kLanes) {
            Floats x, y, z, normal_x, normal_y, normal_z;
            load(rows.positions_site.x, i, x);
            load(rows.positions_site.y, i, y);
            load(rows.positions_site.z, i, z);
            load(rows.normals.x, i, normal_x);
            load(rows.normals.y, i, normal_y);
            load(rows.normals.z, i, normal_z);
            const Floats cosine =
                normal_x * normal.x() + normal_y * normal.y() + normal_z * normal.z();
            x = line.from_site.x() - x;
            y = line.from_site.y() - y;
            z = line.from_site.z() - z;
            const Floats inwards = x * normal.x() + y * normal.y() + z * normal.z();
            x -= inwards * normal.x();
            y -= inwards * normal.y();
            z -= inwards * normal.z();
            const Ints is_opposite = (cosine <= kOppositeCosine) & (inwards > 0.0F) &
                                     (x * x + y * y + z * z <= line.radius_m * line.radius_m) &
                                     (kLaneNumbers < static_cast<std::int32_t>(run.end - i));
            least = (is_opposite & (inwards < least)) ? inwards : least;
        }
    }
    float first = most_m;
    for (int lane = 0; lane < kLanes; ++lane) first = least[lane] < first ? least[lane] : first;
    return first;
}

#ifdef ATRIUM_AVX2
ATRIUM_AVX2 void near_avx2(const SurfelRows& rows,
                           std::span<const SurfelRun> runs,
                           const Eigen::Vector3f& centre,
                           float radius_sq,
                           std::vector<NearSurfel>& found) {
    near_in(rows, runs, centre, radius_sq, Avx2Bits{}, found);
}

ATRIUM_AVX2 float opposite_avx2(const SurfelRows& rows,
                                std::span<const SurfelRun> runs,
                                const InwardLine& line,
                                float most_m) {
    return opposite_in(rows, runs, line, most_m);
}
#endif

}  // namespace

void find_near(const SurfelRows& rows,
               std::span<const SurfelRun> runs,
               const Eigen::Vector3f& centre_site,
               float radius_m,
               std::vector<NearSurfel>& found,
               [[maybe_unused]] image::RowCode code) {
    const float radius_sq = radius_m * radius_m;
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return near_avx2(rows, runs, centre_site, radius_sq, found);
#endif
    near_in(rows, runs, centre_site, radius_sq, BaselineBits{}, found);
}

float distance_to_opposite(const SurfelRows& rows,
                           std::span<const SurfelRun> runs,
                           const InwardLine& line,
                           float most_m,
                           [[maybe_unused]] image::RowCode code) {
#ifdef ATRIUM_AVX2
    if (code == image::RowCode::kAvx2) return opposite_avx2(rows, runs, line, most_m);
#endif
    return opposite_in(rows, runs, line, most_m);
}

}  // namespace atrium::refine
