#include "world_server/physics/people/surface_index.hpp"

#include "world_server/physics/people/surface_columns.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace atrium::physics {
namespace {

constexpr int kMaxCells = 1 << 18;  // very large meshes get larger cells, not more

// Spreads the samples over one large triangle: the R2 low-discrepancy sequence, folded into it.
Eigen::Vector3d barycentric(std::size_t i) {
    constexpr double kStepU = 0.7548776662466927;
    constexpr double kStepV = 0.5698402909980532;
    if (i == 0) return {0.0, 0.5, 0.5};
    const auto fraction = [](double x) {
        return x - static_cast<double>(static_cast<std::int64_t>(x));
    };
    double u = fraction(0.5 + kStepU * static_cast<double>(i));
    double v = fraction(0.5 + kStepV * static_cast<double>(i));
    if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    return {1.0 - u - v, u, v};
}

}  // namespace

void SurfaceIndex::assign(const geometry::TriangleMesh& mesh, const SamplingOptions& options) {
    assert(options.spacing_m > 0.0 && options.max_samples > 0);
    bounds_ = {};
    samples_.clear();
    take_samples(mesh, options);
    if (samples_.empty()) return;
    sort_into_cells(options.min_cell_m);
    fill_columns();
    smooth_normals(options.smooth_m);
    bundle();
}

void SurfaceIndex::take_samples(const geometry::TriangleMesh& mesh,
                                const SamplingOptions& options) {
    const std::size_t num_triangles = mesh.triangles.size();
    if (num_triangles == 0) return;
    doubled_areas_.resize(num_triangles + num_triangles % 2);
    doubled_areas_.back() = 0.0;
    for (std::size_t n = 0; n < num_triangles; ++n) {
        const auto& t = mesh.triangles[n];
        const Eigen::Vector3d& a = mesh.vertices[t[0]];
        doubled_areas_[n] = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).squaredNorm();
    }
    // two at a time: square roots are slow
    for (std::size_t n = 0; n < doubled_areas_.size(); n += 2) {
        Eigen::Map<Eigen::Array2d> two(doubled_areas_.data() + n);
        two = two.sqrt();
    }
    double total_doubled_m2 = 0.0;
    for (const double doubled : doubled_areas_) total_doubled_m2 += doubled;
    const double total_m2 = 0.5 * total_doubled_m2;
    const double share_m2 = std::max(options.spacing_m * options.spacing_m,
                                     total_m2 / static_cast<double>(options.max_samples));
    samples_.reserve(static_cast<std::size_t>(total_m2 / share_m2) + 1);
    double waiting_m2 = 0.5 * share_m2;
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const double area = 0.5 * doubled_areas_[n];
        waiting_m2 += area;
        if (waiting_m2 < share_m2) continue;
        const auto& t = mesh.triangles[n];
        const Eigen::Vector3d& a = mesh.vertices[t[0]];
        const Eigen::Vector3d& b = mesh.vertices[t[1]];
        const Eigen::Vector3d& c = mesh.vertices[t[2]];
        const Eigen::Vector3f normal = ((b - a).cross(c - a) / doubled_areas_[n]).cast<float>();
        for (std::size_t i = 0; waiting_m2 >= share_m2 && samples_.size() < options.max_samples;
             ++i) {
            const Eigen::Vector3d weights = barycentric(i);
            const Eigen::Vector3d p = weights[0] * a + weights[1] * b + weights[2] * c;
            samples_.push_back({p.cast<float>(), normal});
            bounds_.add(p);
            waiting_m2 -= share_m2;
        }
    }
}

Int4 SurfaceIndex::cell_at(const Eigen::Vector3f& p) const {
    const Float4 at = (Float4{p.x(), p.y(), p.z(), p.x()} - origin_) * cells_per_m_;
    return __builtin_convertvector(min4(max4(at, all4(0.0F)), last_cell_), Int4);
}

void SurfaceIndex::sort_into_cells(double min_cell_m) {
    const Eigen::Vector3d size = bounds_.size();
    double cell_m = min_cell_m;
    const auto dims_for = [&](double m) -> Eigen::Array3d {
        return (size.array() / m).floor() + 1.0;
    };
    while (dims_for(cell_m).prod() > kMaxCells) cell_m *= 1.5;
    cell_m_ = static_cast<float>(cell_m);
    cells_per_m_ = static_cast<float>(1.0 / cell_m);
    dims_ = dims_for(cell_m).cast<int>() + 1;  // one more for rounding to float
    const Eigen::Vector3f low = bounds_.min.cast<float>();
    const Eigen::Array3f last = (dims_ - 1).cast<float>();
    origin_ = Float4{low.x(), low.y(), low.z(), low.x()};
    last_cell_ = Float4{last.x(), last.y(), last.z(), last.x()};

    // counting sort
    cell_begin_.assign(static_cast<std::size_t>(dims_.prod()) + 1, 0);
    cell_of_sample_.resize(samples_.size());
    for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Int4 cell = cell_at(samples_[i].position);
        const std::size_t index = cell_index(cell[0], cell[1], cell[2]);
        cell_of_sample_[i] = static_cast<std::uint32_t>(index);
        ++cell_begin_[index];
    }
    std::uint32_t end = 0;
    for (std::uint32_t& begin : cell_begin_) begin = end += begin;
    std::swap(samples_, unsorted_);
    samples_.resize(unsorted_.size());
    // backwards: each cell's end counts down to its begin
    for (std::size_t i = unsorted_.size(); i-- > 0;)
        samples_[--cell_begin_[cell_of_sample_[i]]] = unsorted_[i];
}

void SurfaceIndex::fill_columns() {
    for (std::size_t column = 0; column < columns_.size(); ++column) {
        std::vector<float>& values = columns_[column];
        values.resize(samples_.size() + kFloat8Size);
        const auto axis = static_cast<Eigen::Index>(column % 3);
        for (std::size_t i = 0; i < samples_.size(); ++i)
            values[i] = column < 3 ? samples_[i].position[axis] : samples_[i].normal[axis];
        std::fill(values.end() - kFloat8Size, values.end(), column < 3 ? kFarM : 0.0F);
    }
}

bool SurfaceIndex::uses_avx2() const {
#ifdef ATRIUM_AVX2
    return may_use_avx2_ && __builtin_cpu_supports("avx2");
#else
    return false;
#endif
}

void SurfaceIndex::bundle() {
    const int bundles_y = dims_.y() + 1;
    const auto num_x = static_cast<std::size_t>(dims_.x());
    const std::size_t num_cells = num_x * static_cast<std::size_t>(bundles_y * (dims_.z() + 1));
    bundle_begin_.resize(num_cells + 1);
    const std::size_t num_bundled = 4 * samples_.size();
    for (std::vector<float>& column : bundled_) column.resize(num_bundled + kSearchedAtLeast);
    bundled_sample_.resize(num_bundled + kFloat4Size);
    const auto from = pointers(std::as_const(columns_));
    const auto to = pointers(bundled_);
    std::uint32_t at = 0;
    std::uint32_t* begin = bundle_begin_.data();
    for (int z = 0; z <= dims_.z(); ++z) {
        for (int y = 0; y <= dims_.y(); ++y) {
            std::array<const std::uint32_t*, 4> rows{};
            std::size_t num_rows = 0;
            for (int row_z = std::max(0, z - 1); row_z <= std::min(z, dims_.z() - 1); ++row_z) {
                for (int row_y = std::max(0, y - 1); row_y <= std::min(y, dims_.y() - 1); ++row_y) {
                    const std::uint32_t* row = cell_begin_.data() + cell_index(0, row_y, row_z);
                    if (row[0] != row[num_x]) rows[num_rows++] = row;
                }
            }
            if (num_rows == 0) {
                begin = std::fill_n(begin, num_x, at);
                continue;
            }
            for (std::size_t x = 0; x < num_x; ++x) {
                *begin++ = at;
                for (std::size_t r = 0; r < num_rows; ++r) {
                    // four at a time: the next ones overwrite the excess
                    const std::uint32_t end = rows[r][x + 1];
                    for (std::uint32_t i = rows[r][x]; i < end; i += kFloat4Size) {
                        for (std::size_t c = 0; c < to.size(); ++c)
                            store4(to[c] + at, load4(from[c] + i));
                        for (std::uint32_t n = 0; n < kFloat4Size; ++n)
                            bundled_sample_[at + n] = i + n;
                        at += std::min<std::uint32_t>(kFloat4Size, end - i);
                    }
                }
            }
        }
    }
    *begin = at;
    for (std::size_t c = 0; c < to.size(); ++c)
        std::fill_n(to[c] + at, kSearchedAtLeast, c < 3 ? kFarM : 0.0F);
}

}  // namespace atrium::physics
