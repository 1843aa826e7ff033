// Smooths the normals of a surface's samples.
#include "world_server/physics/people/float8.hpp"
#include "world_server/physics/people/surface_columns.hpp"
#include "world_server/physics/people/surface_index.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace atrium::physics {
namespace {

// For each mask of eight lanes: source lanes that move the set lanes to the front.
struct ClosedUp {
    ClosedUp() {
        for (unsigned mask = 0; mask < 256; ++mask) {
            std::size_t num = 0;
            for (std::int32_t lane = 0; lane < 8; ++lane)
                if ((mask >> lane & 1U) != 0) lanes[mask][num++] = lane;
        }
    }
    alignas(32) std::int32_t lanes[256][kFloat8Size]{};
};
const ClosedUp kClosedUp;

}  // namespace

struct SurfaceIndex::Smoothing {
    // Collects in around_ the samples that may be near those of [begin, end), which are all in one
    // cell.
    ATRIUM_INLINE static std::size_t gather_around(SurfaceIndex& self,
                                                   float radius_m,
                                                   std::uint32_t begin,
                                                   std::uint32_t end) {
        Eigen::Array3f low = self.samples_[begin].position.array();
        Eigen::Array3f high = low;
        for (std::uint32_t i = begin + 1; i < end; ++i) {
            low = low.min(self.samples_[i].position.array());
            high = high.max(self.samples_[i].position.array());
        }
        low -= radius_m;
        high += radius_m;
        const auto from = pointers(std::as_const(self.columns_));
        const auto to = pointers(self.around_);
        const Int4 first = self.cell_at(low.matrix());
        const Int4 last = self.cell_at(high.matrix());
        std::size_t num = 0;
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                const std::uint32_t* row = self.cell_begin_.data() + self.cell_index(0, y, z);
                const std::uint32_t row_end = row[last[0] + 1];
                for (std::uint32_t i = row[first[0]]; i < row_end; i += kFloat8Size) {
                    Float8 x, y_values, z_values;
                    load8(from[0] + i, x);
                    load8(from[1] + i, y_values);
                    load8(from[2] + i, z_values);
                    const Int8 is_around = (x >= low[0]) & (x <= high[0]) & (y_values >= low[1]) &
                                           (y_values <= high[1]) & (z_values >= low[2]) &
                                           (z_values <= high[2]);
                    unsigned bits = bits_of8(is_around);
                    // beyond the end of the row are samples of other rows
                    if (row_end - i < kFloat8Size) bits &= (1U << (row_end - i)) - 1U;
                    if (bits == 0) continue;
                    Int8 lanes;
                    std::memcpy(&lanes, kClosedUp.lanes[bits], sizeof lanes);
                    for (std::size_t c = 0; c < to.size(); ++c) {
                        Float8 values;
                        load8(from[c] + i, values);
                        store8(to[c] + num, __builtin_shuffle(values, lanes));
                    }
                    num += static_cast<std::size_t>(std::popcount(bits));
                }
            }
        }
        for (std::size_t c = 0; c < to.size(); ++c)
            std::fill_n(to[c] + num, kFloat8Size, c < 3 ? kFarM : 0.0F);
        return num;
    }

    ATRIUM_INLINE static void smooth_normals(SurfaceIndex& self, float radius_m) {
        const float per_sq = 1.0F / (radius_m * radius_m);
        const auto num_samples = static_cast<std::uint32_t>(self.samples_.size());
        for (std::vector<float>& column : self.around_)
            column.resize(num_samples + 2 * kFloat8Size);
        const auto around = pointers(std::as_const(self.around_));
        // cell by cell: the samples of a cell share their surroundings
        for (std::uint32_t begin = 0; begin < num_samples;) {
            const Int4 cell = self.cell_at(self.samples_[begin].position);
            const std::uint32_t end =
                self.cell_begin_[self.cell_index(cell[0], cell[1], cell[2]) + 1];
            const std::size_t num = gather_around(self, radius_m, begin, end);
            for (std::uint32_t i = begin; i < end; ++i) {
                const Eigen::Vector3f& at = self.samples_[i].position;
                // columns_ keeps the original normals
                Eigen::Vector3f& normal = self.samples_[i].normal;
                Float8 x{}, y{}, z{};
                for (std::size_t n = 0; n < num; n += kFloat8Size) {
                    Float8 dx, dy, dz, nx, ny, nz;
                    load_samples(around, n, dx, dy, dz, nx, ny, nz);
                    dx -= at.x();
                    dy -= at.y();
                    dz -= at.z();
                    const Float8 weight = 1.0F - (dx * dx + dy * dy + dz * dz) * per_sq;
                    const Float8 cosine = nx * normal.x() + ny * normal.y() + nz * normal.z();
                    const Float8 counted = reinterpret_cast<Float8>(
                        (weight > 0.0F) & (cosine > 0.0F) & reinterpret_cast<Int8>(weight));
                    x += counted * nx;
                    y += counted * ny;
                    z += counted * nz;
                }
                // includes its own normal
                normal = Eigen::Vector3f(sum_of(x), sum_of(y), sum_of(z)).normalized();
            }
            begin = end;
        }
    }

#ifdef ATRIUM_AVX2
    ATRIUM_AVX2 static void smooth_normals_avx2(SurfaceIndex& self, float radius_m) {
        smooth_normals(self, radius_m);
    }
#endif
};

// A facet of a hull is a few pixels of one outline and tilts with their noise. Where a surface
// slides along itself, these tilts would look like motion.
void SurfaceIndex::smooth_normals(float radius_m) {
#ifdef ATRIUM_AVX2
    if (uses_avx2()) {
        Smoothing::smooth_normals_avx2(*this, radius_m);
        return fill_columns();
    }
#endif
    Smoothing::smooth_normals(*this, radius_m);
    fill_columns();
}

}  // namespace atrium::physics
