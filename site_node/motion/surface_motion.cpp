#include "site_node/motion/surface_motion.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

namespace atrium::motion {
namespace {

constexpr std::size_t kCellsPerTask = 16;
constexpr std::size_t kMaxPointsPerCell =
    512;  // of those that share a cell, further ones are left out

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
    Eigen::Matrix3d matrix;
    matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return matrix;
}

template <typename Work>
void for_each_cell(Executor& executor, std::size_t num_cells, const Work& work) {
    const auto some = [&](std::size_t task, std::size_t) {
        const std::size_t end = std::min(num_cells, (task + 1) * kCellsPerTask);
        for (std::size_t cell = task * kCellsPerTask; cell < end; ++cell) work(cell);
    };
    executor.parallel_for((num_cells + kCellsPerTask - 1) / kCellsPerTask, some);
}

}  // namespace

SurfaceMotion::SurfaceMotion(std::span<const geometry::CalibratedCamera> cameras,
                             const SurfaceMotionOptions& options)
    : options_(options) {
    for (const geometry::CalibratedCamera& camera : cameras) cameras_.emplace_back(camera, options);
}

std::size_t SurfaceMotion::num_sights() const {
    std::size_t num = 0;
    for (const CameraEvidence& camera : cameras_) num += camera.num_seen();
    return num;
}

void SurfaceMotion::estimate(const geometry::TriangleMesh& mesh_site,
                             std::vector<MotionPicture>& pictures,
                             Timestamp capture_time,
                             Executor& executor,
                             geometry::MotionField& out) {
    pictures.resize(cameras_.size());
    const double period_s = std::chrono::duration<double>(capture_time - before_time_).count();
    const bool goes_on =
        has_before_ && period_s > 0.0 && period_s <= options_.max_period_s && !mesh_site.empty();
    if (goes_on) {
        surface_.assign(mesh_site,
                        static_cast<double>(options_.sample_m),
                        static_cast<double>(options_.cell_m));
        const auto look = [&](std::size_t camera, std::size_t) {
            cameras_[camera].look(mesh_site, surface_, pictures[camera], before_[camera]);
        };
        executor.parallel_for(cameras_.size(), look);
        link_cells();
        const int num_rounds = options_.flow_rounds + options_.patch_rounds;
        for (int round = 0; round < num_rounds; ++round) {
            for_each_cell(executor, cells_.size(), [&](std::size_t i) { collect(i, round); });
            for_each_cell(
                executor, cells_.size(), [&](std::size_t i) { solve(i, round, solved_[i]); });
            for (std::size_t i = 0; i < cells_.size(); ++i) {
                cells_[i].displacement = solved_[i].displacement;
                cells_[i].turn = solved_[i].turn;
                cells_[i].confidence = solved_[i].confidence;
            }
        }
        write(period_s, out);
    } else {
        out.assign({}, options_.cell_m);
    }
    before_.swap(pictures);
    before_time_ = capture_time;
    has_before_ = true;
}

// Cells are ordered by height, so that neighbours are near in the list.
void SurfaceMotion::link_cells() {
    const std::size_t num = surface_.num_cells();
    cells_.assign(num, {});
    solved_.assign(num, {});
    neighbours_.resize(std::max(num, neighbours_.size()));
    origin_.setZero();
    for (const Eigen::Vector3d& centre : surface_.centres)
        origin_ += centre / static_cast<double>(num);
    const auto reach_m = static_cast<double>(options_.reach_m);
    const double per_sq = 0.5 / static_cast<double>(options_.spread_m * options_.spread_m);
    for (std::size_t i = 0; i < num; ++i) neighbours_[i].clear();
    // centres of one layer of the lattice differ by up to its spacing
    const double layers_m = reach_m + static_cast<double>(options_.cell_m);
    for (std::size_t i = 0; i < num; ++i) {
        for (std::size_t j = i + 1; j < num; ++j) {
            const Eigen::Vector3d off = surface_.centres[j] - surface_.centres[i];
            if (off.z() > layers_m) break;
            const double apart_sq = off.squaredNorm();
            if (apart_sq > reach_m * reach_m) continue;
            const double nearness = per_sq * apart_sq;
            neighbours_[i].push_back({static_cast<std::uint32_t>(j), nearness});
            neighbours_[j].push_back({static_cast<std::uint32_t>(i), nearness});
        }
    }
}

// Gathers the equations of a cell's points at its present motion.
void SurfaceMotion::collect(std::size_t cell, int round) {
    Cell& own = cells_[cell];
    const std::uint32_t first = surface_.first_of_cell[cell];
    const std::size_t num = surface_.first_of_cell[cell + 1] - first;
    std::array<Eigen::Vector3d, kMaxPointsPerCell> displacements;
    std::array<PointEquations, kMaxPointsPerCell> equations;
    const std::size_t num_used = std::min(num, kMaxPointsPerCell);
    for (std::size_t i = 0; i < num_used; ++i) {
        displacements[i] =
            own.displacement_at(surface_.points[first + i].position - surface_.centres[cell]);
        equations[i] = {};
    }
    const std::span<const Eigen::Vector3d> moved(displacements.data(), num_used);
    const std::span<PointEquations> gathered(equations.data(), num_used);
    for (const CameraEvidence& camera : cameras_) {
        if (round < options_.flow_rounds)
            camera.add_flow(
                cell, options_.start_px / static_cast<float>(1 << round), moved, gathered);
        else
            camera.add_patches(cell, surface_, moved, gathered);
    }
    own.lhs.setZero();
    own.rhs.setZero();
    own.seen = own.explained = 0.0;
    for (std::size_t i = 0; i < num_used; ++i) {
        const PointEquations& point = equations[i];
        own.seen += static_cast<double>(point.seen);
        own.explained += static_cast<double>(point.explained);
        const Eigen::Matrix3d lhs = point.lhs.cast<double>();
        const Eigen::Vector3d rhs = point.rhs.cast<double>();
        const Eigen::Matrix3d arm = cross_matrix(surface_.points[first + i].position - origin_);
        const Eigen::Matrix3d turned = arm * lhs;
        own.lhs.topLeftCorner<3, 3>() += lhs;
        own.lhs.bottomLeftCorner<3, 3>() += turned;
        own.lhs.topRightCorner<3, 3>() += turned.transpose();
        own.lhs.bottomRightCorner<3, 3>() += turned * arm.transpose();
        own.rhs.head<3>() += rhs;
        own.rhs.tail<3>() += arm * rhs;
    }
}

// Solves for the motion of a cell, with the equations of the cells around it.
void SurfaceMotion::solve(std::size_t cell, int round, Cell& solved) const {
    const Cell& own = cells_[cell];
    Matrix6 lhs = own.lhs;
    Vector6 rhs = own.rhs;
    double seen = own.seen;
    double explained = own.explained;
    // at first from further away: a part without texture starts like its surroundings
    const double widening = round == 0 ? 0.25 : 1.0;
    const auto let_go_m = static_cast<double>(options_.let_go_m);
    for (const Neighbour& n : neighbours_[cell]) {
        const Cell& other = cells_[n.cell];
        double weight = std::exp(-widening * n.nearness);
        if (round > 0) {
            const Eigen::Vector3d there =
                own.displacement_at(surface_.centres[n.cell] - surface_.centres[cell]);
            const double unlike =
                1.0 + (there - other.displacement).squaredNorm() / (let_go_m * let_go_m);
            weight /= unlike * unlike;
        }
        lhs += weight * other.lhs;
        rhs += weight * other.rhs;
        seen += weight * other.seen;
        explained += weight * other.explained;
    }
    // from rotations about the origin to those about the cell's centre
    const Eigen::Matrix3d arm = cross_matrix(surface_.centres[cell] - origin_);
    Matrix6 origin_from_centre = Matrix6::Identity();
    origin_from_centre.topRightCorner<3, 3>() = arm;
    Matrix6 about_centre = origin_from_centre.transpose() * lhs * origin_from_centre;
    const Vector6 wanted = origin_from_centre.transpose() * rhs;
    // one point that a camera sees with full texture has about this
    const double of_a_point = std::max(
        1.0, about_centre.topLeftCorner<3, 3>().trace() / (2.0 * std::max(explained, 1.0)));
    const double damping = static_cast<double>(options_.damping) * of_a_point;
    const auto turn_m = static_cast<double>(options_.turn_m);
    about_centre.diagonal().head<3>().array() += damping;
    about_centre.diagonal().tail<3>().array() += damping * turn_m * turn_m;
    const Vector6 motion = about_centre.ldlt().solve(wanted);
    if (!motion.allFinite()) {
        solved = own;
        solved.confidence = 0.0F;
        return;
    }
    solved.displacement = motion.head<3>();
    solved.turn = motion.tail<3>();
    solved.confidence = static_cast<float>(explained / std::max(seen, 3.0));
}

void SurfaceMotion::write(double period_s, geometry::MotionField& out) {
    found_.clear();
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        const Cell& cell = cells_[i];
        geometry::MotionCell& found = found_.emplace_back();
        found.centre = surface_.centres[i].cast<float>();
        found.velocity = (cell.displacement / period_s).cast<float>();
        found.turn = (cell.turn / period_s).cast<float>();
        found.confidence = cell.confidence;
        if (static_cast<double>(found.velocity.norm()) > options_.max_speed_mps)
            found.confidence = 0.0F;
    }
    out.assign(found_, options_.cell_m);
}

}  // namespace atrium::motion
