#pragma once

#include "core/image/axes.hpp"
#include "core/image/colour_rows.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

/// Places and normals of surfels for vectorised searches. Has kMargin more entries than surfels.
struct SurfelRows {
    image::Axes positions_site;
    image::Axes normals;

    static constexpr std::size_t kMargin = 8;
};

/// Surfels from `begin` to before `end`.
struct SurfelRun {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
};

struct NearSurfel {
    std::uint32_t surfel = 0;
    float distance_sq = 0.0F;  // [m^2]
};

/// Working memory of a search; one per thread.
struct NearScratch {
    std::vector<SurfelRun> runs;
    std::vector<NearSurfel> found;
};

/// Sets `found` to the surfels of the runs within `radius_m` of `centre_site`, in their order. All
/// instruction sets give the same bits.
void find_near(const SurfelRows& rows,
               std::span<const SurfelRun> runs,
               const Eigen::Vector3f& centre_site,
               float radius_m,
               std::vector<NearSurfel>& found,
               image::RowCode code = image::best_row_code());

/// A line into a body, from a point of its surface.
struct InwardLine {
    Eigen::Vector3f from_site = Eigen::Vector3f::Zero();
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  // unit, outwards
    float radius_m = 0.0F;                              // surfels this far from the line lie on it
};

/// How far along the line the first surfel of the runs lies that looks the other way, if nearer
/// than `most_m`, else `most_m`. All instruction sets give the same bits.
float distance_to_opposite(const SurfelRows& rows,
                           std::span<const SurfelRun> runs,
                           const InwardLine& line,
                           float most_m,
                           image::RowCode code = image::best_row_code());

}  // namespace atrium::refine
