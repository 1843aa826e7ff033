#include "tools/calibrate/refine/refine.hpp"

#include "core/base/median.hpp"
#include "core/geometry/alignment.hpp"
#include "site_node/coherence/camera_fit.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

namespace atrium::calibrate {
namespace {

using coherence::Tangency;

constexpr std::size_t kHeldOut = 5;  // every fifth
constexpr int kRounds = 12;
constexpr int kIterations = 20;
constexpr double kFirstMost_px = 150.0;  // errors that count at the beginning
constexpr double kFirstConfirmed_px = 80.0;
constexpr double kMost_px = 20.0;
constexpr double kLeastScale_px = 0.2;
constexpr double kGross = 6.0;  // standard deviations
constexpr std::size_t kLeastTangencies = 20;
// What holds the frame, and whatever silhouettes do not show: cameras are expected to be off by so
// much at most, and by no more than a few times what the errors in the pictures need. Else few
// instants would turn and move them far, to fit the errors of their silhouettes.
constexpr double kMostTurn = 0.02;
constexpr double kMostMove_m = 0.05;
constexpr double kExpected = 3.0;  // times what a standard deviation of the errors needs
constexpr double kExpectedDilation_px = 1.0;
constexpr double kExpectedFocal = 0.02;
// Neighbouring tangencies have errors in common: so many count as one.
constexpr double kTogether = 10.0;
constexpr int kFrame = 7;  // numbers of a similarity

// Turn, move, dilation, logarithm of the focal length's factor.
struct Block {
    std::array<double, 3> turn{}, move{};
    double dilation = 0.0, focal = 0.0;
};

struct TangentError {
    std::array<Eigen::Vector3d, 2> rays;  // (x, y, 1) in the cameras' frames
    std::array<Eigen::Quaterniond, 2> site_from_camera;
    Eigen::Vector3d baseline;
    double rad_per_px;
    std::array<double, 2> by_dilation;

    template <typename T>
    bool operator()(const T* turn_a,
                    const T* move_a,
                    const T* turn_b,
                    const T* move_b,
                    const T* dilation_a,
                    const T* dilation_b,
                    const T* focal_a,
                    const T* focal_b,
                    T* residual) const {
        using Vector = Eigen::Matrix<T, 3, 1>;
        const Vector a = ray(0, turn_a, focal_a);
        const Vector b = ray(1, turn_b, focal_b);
        Vector axis = baseline.cast<T>();
        for (int i = 0; i < 3; ++i) axis[i] += move_b[i] - move_a[i];
        axis /= sqrt(axis.squaredNorm());
        const Vector plane_a = axis.cross(a);
        const Vector plane_b = axis.cross(b);
        const T angle = atan2(axis.dot(plane_b.cross(plane_a)), plane_a.dot(plane_b));
        residual[0] = angle / T(rad_per_px) - T(by_dilation[0]) * dilation_a[0] -
                      T(by_dilation[1]) * dilation_b[0];
        return true;
    }

private:
    template <typename T>
    Eigen::Matrix<T, 3, 1> ray(std::size_t end, const T* turn, const T* focal) const {
        const T scale = exp(-focal[0]);
        Eigen::Matrix<T, 3, 1> in_camera = rays[end].cast<T>();
        in_camera[0] *= scale;
        in_camera[1] *= scale;
        const Eigen::Matrix<T, 3, 1> in_site = site_from_camera[end].cast<T>() * in_camera;
        Eigen::Matrix<T, 3, 1> turned;
        ceres::AngleAxisRotatePoint(turn, in_site.data(), turned.data());
        return turned;
    }
};

template <int kSize>
struct Expectation {
    double deviation;
    template <typename T>
    bool operator()(const T* values, T* residual) const {
        for (int i = 0; i < kSize; ++i) residual[i] = values[i] / T(deviation);
        return true;
    }
};

class Refinement {
public:
    Refinement(std::span<const geometry::CalibratedCamera> cameras,
               std::span<const coherence::Sight> sights,
               const RefineOptions& options)
        : start_(cameras.begin(), cameras.end()),
          sights_(sights),
          options_(options),
          blocks_(cameras.size()),
          is_free_(cameras.size(), options.cameras.empty() ? 1 : 0) {
        for (const std::size_t camera : options.cameras) is_free_[camera] = 1;
    }

    Expected<Refined> run() {
        Refined result;
        for (std::size_t s = kHeldOut - 1; s < sights_.size(); s += kHeldOut)
            result.held_out.push_back(s);
        coherence::TangencyOptions wide{kFirstConfirmed_px, kFirstMost_px};
        std::vector<Tangency> used = find(start_, false, wide);
        if (auto enough = check_enough(used); !enough) return tl::unexpected(enough.error());
        result.before = measure(start_, false);
        result.before.held_out = measure(start_, true).used;
        expect_errors(used, result.before.used);
        for (int round = 0; round < kRounds; ++round) {
            const auto now = current();
            // the limits shrink as the rig becomes true
            const double errors_px = deviation(used);
            wide.most_px = std::clamp(8.0 * errors_px, kMost_px, kFirstMost_px);
            wide.confirmed_px = std::clamp(6.0 * errors_px, kMost_px, kFirstConfirmed_px);
            used = find(now, false, wide);
            if (auto enough = check_enough(used); !enough) return tl::unexpected(enough.error());
            if (auto done = adjust(used, errors_px); !done) return tl::unexpected(done.error());
        }
        result.cameras = current();
        if (options_.cameras.empty()) result.cameras = laid_on(std::move(result.cameras), start_);
        used = find(result.cameras, false, {kMost_px, kMost_px});
        result.num_tangencies = used.size();
        result.after = measure(result.cameras, false);
        result.after.held_out = measure(result.cameras, true).used;
        find_weakest(used, std::max(0.2, result.after.used), result);
        return result;
    }

private:
    std::vector<Tangency> find(std::span<const geometry::CalibratedCamera> cameras,
                               bool held_out,
                               const coherence::TangencyOptions& options) const {
        std::vector<Tangency> found;
        for (std::size_t s = 0; s < sights_.size(); ++s) {
            if ((s % kHeldOut == kHeldOut - 1) != held_out) continue;
            coherence::find_tangencies(
                cameras, sights_[s], static_cast<std::uint32_t>(s), options, found);
        }
        return found;
    }

    Expected<void> check_enough(const std::vector<Tangency>& used) const {
        std::vector<std::size_t> counts(start_.size(), 0);
        for (const Tangency& t : used)
            for (const auto& end : t.ends) ++counts[end.camera];
        for (std::size_t c = 0; c < start_.size(); ++c) {
            if (counts[c] >= kLeastTangencies) continue;
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("camera '{}' sees too little of what the others see: {} tangents of "
                            "silhouettes, {} are needed; record a person who walks through the "
                            "whole room, or leave the camera out of the rig",
                            start_[c].name,
                            counts[c],
                            kLeastTangencies));
        }
        return {};
    }

    // Robust deviation without dilations.
    static double deviation(const std::vector<Tangency>& found, std::size_t num_cameras) {
        const auto dilations = coherence::find_dilations(found, num_cameras);
        std::vector<double> errors;
        for (const Tangency& t : found) errors.push_back(coherence::error_without(t, dilations));
        return coherence::robust_deviation(std::move(errors));
    }
    double deviation(const std::vector<Tangency>& found) const {
        return deviation(found, start_.size());
    }

    Tangent_px measure(std::span<const geometry::CalibratedCamera> cameras, bool held_out) const {
        Tangent_px px;
        px.used = deviation(find(cameras, held_out, {kFirstConfirmed_px, kFirstMost_px}));
        return px;
    }

    std::vector<geometry::CalibratedCamera> current() const {
        std::vector<geometry::CalibratedCamera> cameras = start_;
        for (std::size_t c = 0; c < cameras.size(); ++c) {
            const Block& block = blocks_[c];
            const Eigen::Vector3d turn(block.turn[0], block.turn[1], block.turn[2]);
            geometry::RigidTransform pose = cameras[c].camera_from_site.inverse();
            if (turn.norm() > 0.0)
                pose.rotation =
                    (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) *
                     pose.rotation)
                        .normalized();
            pose.translation += Eigen::Vector3d(block.move[0], block.move[1], block.move[2]);
            cameras[c].camera_from_site = pose.inverse();
            cameras[c].intrinsics.fx *= std::exp(block.focal);
            cameras[c].intrinsics.fy *= std::exp(block.focal);
        }
        return cameras;
    }

    // How far cameras may be off whose tangencies differ by `errors_px`.
    void expect_errors(const std::vector<Tangency>& used, double errors_px) {
        std::vector<double> by_turn, by_move;
        for (const Tangency& t : used) {
            for (const auto& end : t.ends) {
                by_turn.push_back(end.by_turn.norm());
                by_move.push_back(end.by_move.norm());
            }
        }
        const double expected_px = kExpected * std::max(kLeastScale_px, errors_px);
        expected_turn_ = std::min(kMostTurn, expected_px / std::max(1.0, median_of(by_turn)));
        expected_move_m_ = std::min(kMostMove_m, expected_px / std::max(1.0, median_of(by_move)));
    }

    // `errors_px`: the standard deviation of the tangencies.
    Expected<void> adjust(const std::vector<Tangency>& used, double errors_px) {
        const auto now = current();
        const double unit_px = std::max(kLeastScale_px, errors_px);
        ceres::Problem::Options ownership;
        ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        // in standard deviations, so that the expectations hold what the silhouettes do not show
        ceres::ScaledLoss gross(new ceres::TukeyLoss(kGross * unit_px),
                                1.0 / (kTogether * unit_px * unit_px),
                                ceres::TAKE_OWNERSHIP);
        ceres::CauchyLoss stays(1.0);
        ceres::Problem problem(ownership);
        for (const Tangency& t : used) add(problem, t, now, &gross);
        for (std::size_t c = 0; c < blocks_.size(); ++c) {
            Block& block = blocks_[c];
            const auto expect = [&]<int kSize>(std::integral_constant<int, kSize>,
                                               double* values,
                                               double deviation,
                                               bool is_free,
                                               ceres::LossFunction* loss) {
                problem.AddResidualBlock(
                    new ceres::AutoDiffCostFunction<Expectation<kSize>, kSize, kSize>(
                        new Expectation<kSize>{deviation}),
                    loss,
                    values);
                if (!is_free) problem.SetParameterBlockConstant(values);
            };
            const bool is_free = is_free_[c] != 0;
            constexpr std::integral_constant<int, 3> kThree;
            constexpr std::integral_constant<int, 1> kOne;
            expect(kThree, block.turn.data(), expected_turn_, is_free, &stays);
            expect(kThree, block.move.data(), expected_move_m_, is_free, &stays);
            expect(kOne, &block.dilation, kExpectedDilation_px, true, nullptr);
            expect(kOne, &block.focal, kExpectedFocal, is_free && options_.has_free_focal, nullptr);
        }
        ceres::Solver::Options solver;
        solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
        solver.max_num_iterations = kIterations;
        solver.num_threads = options_.num_threads;
        solver.logging_type = ceres::SILENT;
        solver.initial_trust_region_radius = 1e8;  // the frame is held weakly
        FLAGS_minloglevel = google::GLOG_FATAL;    // its steps that fail are tried again, shorter
        ceres::Solver::Summary summary;
        ceres::Solve(solver, &problem, &summary);
        if (summary.IsSolutionUsable()) return {};
        return make_error(ErrorKind::kInternal,
                          fmt::format("the adjustment failed: {}", summary.message));
    }

    void add(ceres::Problem& problem,
             const Tangency& t,
             const std::vector<geometry::CalibratedCamera>& now,
             ceres::LossFunction* loss) {
        auto error = std::make_unique<TangentError>();
        for (std::size_t e = 0; e < 2; ++e) {
            const std::uint32_t c = t.ends[e].camera;
            error->rays[e] = t.ends[e].ray_camera / t.ends[e].ray_camera.z();
            // the block scales the focal length of the start
            const double focal = now[c].intrinsics.fx / start_[c].intrinsics.fx;
            error->rays[e].head<2>() *= focal;
            error->site_from_camera[e] = start_[c].camera_from_site.rotation.conjugate();
            error->by_dilation[e] = t.ends[e].by_dilation;
        }
        const std::uint32_t a = t.ends[0].camera;
        const std::uint32_t b = t.ends[1].camera;
        error->baseline = start_[b].centre_site() - start_[a].centre_site();
        error->rad_per_px = t.rad_per_px;
        problem.AddResidualBlock(
            new ceres::AutoDiffCostFunction<TangentError, 1, 3, 3, 3, 3, 1, 1, 1, 1>(
                error.release()),
            loss,
            blocks_[a].turn.data(),
            blocks_[a].move.data(),
            blocks_[b].turn.data(),
            blocks_[b].move.data(),
            &blocks_[a].dilation,
            &blocks_[b].dilation,
            &blocks_[a].focal,
            &blocks_[b].focal);
    }

    // The direction in the space of all poses that the tangencies hold least, beside the frame.
    void find_weakest(const std::vector<Tangency>& used, double error_px, Refined& result) const {
        constexpr double kTurn = 0.1 * std::numbers::pi / 180.0;  // units of the directions
        constexpr double kMove_m = 0.005;
        std::vector<Eigen::Index> first(start_.size(), -1);
        Eigen::Index n = 0;
        for (std::size_t c = 0; c < start_.size(); ++c) {
            if (is_free_[c] == 0) continue;
            first[c] = n;
            n += 6;
        }
        const Eigen::Index dilations = n;
        const Eigen::Index all = n + static_cast<Eigen::Index>(start_.size());
        Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(all, all);
        Eigen::VectorXd row(all);
        for (const Tangency& t : used) {
            row.setZero();
            for (const auto& end : t.ends) {
                const Eigen::Index at = first[end.camera];
                if (at >= 0) {
                    row.segment<3>(at) = kTurn * end.by_turn;
                    row.segment<3>(at + 3) = kMove_m * end.by_move;
                }
                row[dilations + static_cast<Eigen::Index>(end.camera)] = end.by_dilation;
            }
            normal.selfadjointView<Eigen::Lower>().rankUpdate(row);
        }
        normal = normal.selfadjointView<Eigen::Lower>();
        normal /= kTogether * error_px * error_px;
        normal.bottomRightCorner(all - n, all - n).diagonal().array() +=
            1.0 / (kExpectedDilation_px * kExpectedDilation_px);
        const Eigen::MatrixXd poses =
            normal.topLeftCorner(n, n) -
            normal.topRightCorner(n, all - n) *
                geometry::solve_symmetric(normal.bottomRightCorner(all - n, all - n),
                                          normal.bottomLeftCorner(all - n, n));
        const geometry::DynamicAxes solver = geometry::principal_axes(poses);
        const Eigen::Index frame = options_.cameras.empty() ? kFrame : 0;
        if (n <= frame) return;
        const double least = std::max(1e-12, solver.values[frame]);
        const Eigen::VectorXd direction = solver.axes.col(frame) / std::sqrt(least);
        constexpr double kMost_deg = 10.0, kMost_mm = 1000.0;
        for (Eigen::Index at = 0; at < n; at += 6) {
            result.weakest_deg =
                std::max(result.weakest_deg, 0.1 * direction.segment<3>(at).norm());
            result.weakest_mm =
                std::max(result.weakest_mm, 1000.0 * kMove_m * direction.segment<3>(at + 3).norm());
        }
        result.weakest_deg = std::min(result.weakest_deg, kMost_deg);
        result.weakest_mm = std::min(result.weakest_mm, kMost_mm);
    }

    std::vector<geometry::CalibratedCamera> start_;
    std::span<const coherence::Sight> sights_;
    const RefineOptions& options_;
    std::vector<Block> blocks_;
    std::vector<std::uint8_t> is_free_;
    double expected_turn_ = kMostTurn, expected_move_m_ = kMostMove_m;
};

}  // namespace

Expected<Refined> refine(std::span<const geometry::CalibratedCamera> cameras,
                         std::span<const coherence::Sight> sights,
                         const RefineOptions& options) {
    return Refinement(cameras, sights, options).run();
}

}  // namespace atrium::calibrate
