#include "world_server/physics/person_shape.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>

namespace atrium::physics {
namespace {

constexpr float kSameFacing = 0.5F;        // cosine: normals at most 60 degrees apart
constexpr double kNeighbourWeight = 0.15;  // of a cell that touches the piece's own with a face
constexpr std::size_t kMaxQueries = 2000;  // points per mesh whose motion is looked up
constexpr double kMaxSearchM = 0.4;        // bounds the work after a gap between meshes
// Pull towards zero, in samples' worth per sample: biases a velocity that is well determined by a
// few percent, and decides one that is not.
constexpr double kDamping = 0.01;

// Normal equations of `normal . displacement = distance`, summed over samples.
struct NormalEquations {
    Eigen::Matrix3d lhs = Eigen::Matrix3d::Zero();
    Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
    double num_samples = 0.0;

    void add(const NormalEquations& other, double weight) {
        lhs += weight * other.lhs;
        rhs += weight * other.rhs;
        num_samples += weight * other.num_samples;
    }
};

std::vector<NormalEquations> displacements_by_cell(const SolidCells& solid,
                                                   const SurfaceIndex& surface,
                                                   const SurfaceIndex& previous,
                                                   double radius_m) {
    std::vector<NormalEquations> by_piece(solid.pieces.size());
    // samples lie ordered by place, so that every n-th of them still covers every cell
    const std::size_t stride = 1 + surface.samples().size() / kMaxQueries;
    for (std::size_t i = 0; i < surface.samples().size(); i += stride) {
        const SurfaceSample& sample = surface.samples()[i];
        const std::int32_t piece = solid.piece_at(sample.position.cast<double>());
        if (piece < 0) continue;
        const auto before = previous.nearest(
            sample.position, static_cast<float>(radius_m), [&](const SurfaceSample& candidate) {
                return candidate.normal.dot(sample.normal) > kSameFacing;
            });
        if (!before) continue;
        const Eigen::Vector3d normal = before->normal.cast<double>();
        const double distance = normal.dot((sample.position - before->position).cast<double>());
        NormalEquations& equations = by_piece[static_cast<std::size_t>(piece)];
        equations.lhs += normal * normal.transpose();
        equations.rhs += distance * normal;
        equations.num_samples += 1.0;
    }
    return by_piece;
}

std::vector<Eigen::Vector3f> velocities_of(const SolidCells& solid,
                                           const std::vector<NormalEquations>& by_piece,
                                           double period_s,
                                           const PersonShapeOptions& options) {
    std::vector<Eigen::Vector3f> velocities(solid.pieces.size(), Eigen::Vector3f::Zero());
    for (std::size_t i = 0; i < by_piece.size(); ++i) {
        NormalEquations sum = by_piece[i];
        const Eigen::Vector3d centre = solid.pieces[i].centre.cast<double>();
        for (int axis = 0; axis < 3; ++axis) {
            for (const double side : {-1.0, 1.0}) {
                const std::int32_t beside =
                    solid.piece_at(centre + side * solid.cell_m * Eigen::Vector3d::Unit(axis));
                if (beside >= 0)
                    sum.add(by_piece[static_cast<std::size_t>(beside)], kNeighbourWeight);
            }
        }
        if (sum.num_samples < 1.0) continue;
        sum.lhs.diagonal().array() += kDamping * sum.num_samples;
        Eigen::Vector3d velocity = sum.lhs.llt().solve(sum.rhs) / period_s;
        const double speed = velocity.norm();
        // a smooth step at the rest speed: a hard one would make slow hands stutter
        const double rest = options.rest_speed_mps;
        velocity *= speed * speed / (speed * speed + rest * rest);
        if (speed > options.max_speed_mps) velocity *= options.max_speed_mps / speed;
        if (velocity.allFinite()) velocities[i] = velocity.cast<float>();
    }
    return velocities;
}

}  // namespace

PersonShaper::PersonShaper(const PersonShapeOptions& options) : options_(options) {
    assert(options.max_speed_mps > 0.0 && options.rest_speed_mps > 0.0);
}

PersonShape PersonShaper::shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time) {
    PersonShape shape;
    shape.capture_time = capture_time;
    shape.solid = cut_into_cells(mesh_world, options_.cells);
    shape.surface = std::make_shared<const SurfaceIndex>(mesh_world, options_.sampling);
    const double period_s = std::chrono::duration<double>(capture_time - previous_time_).count();
    if (previous_ && period_s > 0.0 && period_s <= options_.max_period_s) {
        shape.period_s = period_s;
        const double radius_m = std::min(kMaxSearchM, options_.max_speed_mps * period_s);
        const auto by_piece =
            displacements_by_cell(shape.solid, *shape.surface, *previous_, radius_m);
        shape.velocities = velocities_of(shape.solid, by_piece, period_s, options_);
    } else {
        shape.velocities.assign(shape.solid.pieces.size(), Eigen::Vector3f::Zero());
    }
    std::vector<MovingSurfel> surfels;
    surfels.reserve(shape.surface->samples().size());
    for (const SurfaceSample& sample : shape.surface->samples()) {
        const std::int32_t piece = shape.solid.piece_at(sample.position.cast<double>());
        const Eigen::Vector3f velocity = piece < 0
                                             ? Eigen::Vector3f::Zero().eval()
                                             : shape.velocities[static_cast<std::size_t>(piece)];
        surfels.push_back({sample.position,
                           sample.normal,
                           sample.position - velocity * static_cast<float>(shape.period_s),
                           velocity});
    }
    shape.surfels = std::make_shared<const std::vector<MovingSurfel>>(std::move(surfels));
    previous_ = shape.surface;
    previous_time_ = capture_time;
    return shape;
}

void PersonShaper::forget() { previous_.reset(); }

}  // namespace atrium::physics
