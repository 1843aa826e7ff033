#include "world_server/physics/surface_index.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr double kMinCellM = 0.04;  // about two sample spacings: a handful of samples per cell
constexpr float kSmoothM = 0.03F;   // around a sample, of what its normal is a mean of
constexpr int kMaxCells = 1 << 18;  // a mesh that claims to be huge gets larger cells, not more

// Spreads the samples of one large triangle: the R2 low-discrepancy sequence, folded into it.
Eigen::Vector3d barycentric(std::size_t i) {
    constexpr double kStepU = 0.7548776662466927;
    constexpr double kStepV = 0.5698402909980532;
    double u = std::fmod(0.5 + kStepU * static_cast<double>(i), 1.0);
    double v = std::fmod(0.5 + kStepV * static_cast<double>(i), 1.0);
    if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
    }
    return {1.0 - u - v, u, v};
}

double area_m2(const geometry::TriangleMesh& mesh) {
    double doubled = 0.0;
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d& a = mesh.vertices[t[0]];
        doubled += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
    }
    return 0.5 * doubled;
}

}  // namespace

SurfaceIndex::SurfaceIndex(const geometry::TriangleMesh& mesh, const SamplingOptions& options) {
    assert(options.spacing_m > 0.0 && options.max_samples > 0);
    take_samples(mesh, options);
    if (samples_.empty()) return;
    sort_into_cells();
    smooth_normals();
}

void SurfaceIndex::take_samples(const geometry::TriangleMesh& mesh,
                                const SamplingOptions& options) {
    const double total_m2 = area_m2(mesh);
    const double share_m2 = std::max(options.spacing_m * options.spacing_m,
                                     total_m2 / static_cast<double>(options.max_samples));
    samples_.reserve(static_cast<std::size_t>(total_m2 / share_m2) + 1);
    double waiting_m2 = 0.5 * share_m2;
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d& a = mesh.vertices[t[0]];
        const Eigen::Vector3d& b = mesh.vertices[t[1]];
        const Eigen::Vector3d& c = mesh.vertices[t[2]];
        const Eigen::Vector3d doubled = (b - a).cross(c - a);
        const double area = 0.5 * doubled.norm();
        waiting_m2 += area;
        if (waiting_m2 < share_m2) continue;
        const Eigen::Vector3f normal = (doubled / (2.0 * area)).cast<float>();
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

void SurfaceIndex::sort_into_cells() {
    const Eigen::Vector3d size = bounds_.size();
    double cell_m = kMinCellM;
    const auto dims_for = [&](double m) -> Eigen::Array3d {
        return (size.array() / m).floor() + 1.0;
    };
    while (dims_for(cell_m).prod() > kMaxCells) cell_m *= 1.5;
    cell_m_ = static_cast<float>(cell_m);
    origin_ = bounds_.min.cast<float>();
    dims_ = dims_for(cell_m).cast<int>() + 1;  // one more for the rounding to float

    // counting sort
    const auto key = [&](const SurfaceSample& sample) {
        const Eigen::Array3i cell = cell_of(sample.position).max(0).min(dims_ - 1);
        return cell_index(cell.x(), cell.y(), cell.z());
    };
    cell_begin_.assign(static_cast<std::size_t>(dims_.prod()) + 1, 0);
    for (const SurfaceSample& sample : samples_) ++cell_begin_[key(sample) + 1];
    for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
    std::vector<SurfaceSample> sorted(samples_.size());
    std::vector<std::uint32_t> next(cell_begin_.begin(), cell_begin_.end() - 1);
    for (const SurfaceSample& sample : samples_) sorted[next[key(sample)]++] = sample;
    samples_ = std::move(sorted);
}

// A facet of a hull is some pixels of one outline, and tilts with their noise. Where regions of a
// surface slide along themselves, such tilts would tell a motion that is not there.
void SurfaceIndex::smooth_normals() {
    std::vector<Eigen::Vector3f> smooth;
    smooth.reserve(samples_.size());
    for (const SurfaceSample& s : samples_) {
        const Eigen::Array3i low = cell_of((s.position.array() - kSmoothM).matrix()).max(0);
        const Eigen::Array3i high =
            cell_of((s.position.array() + kSmoothM).matrix()).min(dims_ - 1);
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (int z = low.z(); z <= high.z(); ++z) {
            for (int y = low.y(); y <= high.y(); ++y) {
                const std::uint32_t end = cell_begin_[cell_index(high.x(), y, z) + 1];
                for (std::uint32_t i = cell_begin_[cell_index(low.x(), y, z)]; i < end; ++i) {
                    const SurfaceSample& beside = samples_[i];
                    const float apart_sq = (beside.position - s.position).squaredNorm();
                    const float weight = 1.0F - apart_sq / (kSmoothM * kSmoothM);
                    if (weight > 0.0F && beside.normal.dot(s.normal) > 0.0F) {
                        sum += weight * beside.normal;
                    }
                }
            }
        }
        smooth.push_back(sum.normalized());  // its own normal is part of it
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) samples_[i].normal = smooth[i];
}

}  // namespace atrium::physics
