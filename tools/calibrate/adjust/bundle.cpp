#include "tools/calibrate/adjust/bundle.hpp"

#include "core/geometry/alignment.hpp"
#include "tools/calibrate/adjust/reprojection.hpp"

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/product_manifold.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <ceres/sphere_manifold.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace atrium::calibrate {
namespace {

// Weak priors: they matter only where the sightings say nothing.
constexpr double kCentrePrior = 0.1;       // of cx, cy, in pictures' widths
constexpr double kFocalPrior = 0.7;        // of log f
constexpr double kRadialPrior = 1.0;       // of k1, k2, k3
constexpr double kTangentialPrior = 0.01;  // of p1, p2

// Place of a light in the world, and its derivatives by the block of the wand's pose.
struct PlacedLight {
    Eigen::Vector3d world;
    Eigen::Matrix<double, 3, 7> by_block;  // its first columns
};

// How the blocks of a form give the place of one light. Point: its place. Line: place of light 0
// and direction, since turning about itself does not move a line. Body: quaternion x, y, z, w and
// place of the origin.
struct LightOfWand {
    WandForm form;
    Eigen::Vector3d light_m;  // kBody
    double along_m = 0.0;     // kLine

    int num_values() const {
        return form == WandForm::kPoint ? 3 : form == WandForm::kLine ? 6 : 7;
    }
    PlacedLight place(const double* block) const {
        PlacedLight placed;
        placed.by_block.setZero();
        using Vector = Eigen::Map<const Eigen::Vector3d>;
        if (form == WandForm::kBody) {
            const auto turned =
                turn_by(Eigen::Vector4d(Eigen::Map<const Eigen::Vector4d>(block)), light_m);
            placed.world = turned.point + Vector(block + 4);
            placed.by_block.leftCols<4>() = turned.by_xyzw;
            placed.by_block.rightCols<3>().setIdentity();
            return placed;
        }
        placed.world = Vector(block);
        placed.by_block.leftCols<3>().setIdentity();
        if (form == WandForm::kLine) {
            placed.world += along_m * Vector(block + 3);
            placed.by_block.middleCols<3>(3).diagonal().setConstant(along_m);
        }
        return placed;
    }
};

// Projected minus seen [px], by pose and lens of the camera and the block of the wand.
class LightError final : public ceres::CostFunction {
public:
    LightError(const LightOfWand& light, const Eigen::Vector2d& px) : light_(light), px_(px) {
        set_num_residuals(2);
        *mutable_parameter_block_sizes() = {6, 8, light.num_values()};
    }
    bool Evaluate(const double* const* values,
                  double* residuals,
                  double** jacobians) const override {
        const PlacedLight light = light_.place(values[2]);
        const TurnedPoint turned =
            turn_by(Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(values[0])), light.world);
        LensValues lens;
        std::copy_n(values[1], lens.size(), lens.begin());
        const auto seen =
            reproject(lens, turned.point + Eigen::Map<const Eigen::Vector3d>(values[0] + 3));
        if (!seen) return false;
        residuals[0] = seen->px.x() - px_.x();
        residuals[1] = seen->px.y() - px_.y();
        if (jacobians == nullptr) return true;
        if (jacobians[0] != nullptr) {
            Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> by_pose(jacobians[0]);
            by_pose.leftCols<3>() = seen->by_point * turned.by_vector;
            by_pose.rightCols<3>() = seen->by_point;
        }
        if (jacobians[1] != nullptr) {
            Eigen::Map<Eigen::Matrix<double, 2, 8, Eigen::RowMajor>> by_lens(jacobians[1]);
            by_lens = seen->by_lens;
        }
        if (jacobians[2] != nullptr) {
            const Eigen::Matrix<double, 2, 3> by_world = seen->by_point * turned.rotation;
            const int n = light_.num_values();
            for (int row = 0; row < 2; ++row)
                for (int k = 0; k < n; ++k)
                    jacobians[2][row * n + k] = by_world.row(row).dot(light.by_block.col(k));
        }
        return true;
    }

private:
    LightOfWand light_;
    Eigen::Vector2d px_;
};

class LensPrior final : public ceres::SizedCostFunction<8, 8> {
public:
    LensPrior(const LensValues& nominal, double width) : nominal_(nominal), width_(width) {}
    bool Evaluate(const double* const* values,
                  double* residuals,
                  double** jacobians) const override {
        const double* const lens = values[0];
        if (!(lens[0] > 0.0)) return false;
        std::array<double, 8> slope;
        slope[0] = 1.0 / (kFocalPrior * lens[0]);
        for (std::size_t i : {1, 2}) slope[i] = 1.0 / (kCentrePrior * width_);
        for (std::size_t i : {3, 4, 7}) slope[i] = 1.0 / kRadialPrior;
        for (std::size_t i : {5, 6}) slope[i] = 1.0 / kTangentialPrior;
        residuals[0] = std::log(lens[0] / nominal_[0]) / kFocalPrior;
        for (std::size_t i : {1, 2}) residuals[i] = slope[i] * (lens[i] - nominal_[i]);
        for (std::size_t i = 3; i < 8; ++i) residuals[i] = slope[i] * lens[i];
        if (jacobians == nullptr || jacobians[0] == nullptr) return true;
        Eigen::Map<Eigen::Matrix<double, 8, 8, Eigen::RowMajor>> by_lens(jacobians[0]);
        by_lens.setZero();
        for (std::size_t i = 0; i < 8; ++i)
            by_lens(static_cast<int>(i), static_cast<int>(i)) = slope[i];
        return true;
    }

private:
    LensValues nominal_;
    double width_;
};

std::vector<int> fixed_values(LensFreedom freedom) {
    switch (freedom) {
        case LensFreedom::kFixed:
            return {};  // the whole block is constant
        case LensFreedom::kFocal:
            return {1, 2, 3, 4, 5, 6, 7};
        case LensFreedom::kRadial:
            return {1, 2, 4, 5, 6, 7};
        case LensFreedom::kAll:
            return {7};
        case LensFreedom::kAllAndThird:
            return {};
    }
    return {};
}

// The values of the wands' poses while Ceres moves them.
class WandBlocks {
public:
    explicit WandBlocks(Bundle& bundle) : bundle_(bundle), form_(bundle.wand.form()) {
        if (form_ == WandForm::kLine) {
            places_ = bundle.wand.places_on_line_m();
            std::size_t far = 0;
            for (std::size_t i = 1; i < places_.size(); ++i)
                if (std::abs(places_[i]) > std::abs(places_[far])) far = i;
            along_ = (bundle.wand.lights_m[far] - bundle.wand.lights_m[0]) / places_[far];
        }
        values_.resize(bundle.wands.size());
        for (std::size_t i = 0; i < values_.size(); ++i)
            if (bundle.wands[i].is_placed) load(bundle.wands[i].world_from_wand, values_[i]);
    }
    double* of(std::size_t instant) { return values_[instant].data(); }

    void add_residual(ceres::Problem& problem,
                      const Sighting& sighting,
                      BundleCamera& camera,
                      ceres::LossFunction* loss) {
        LightOfWand light{form_, bundle_.wand.lights_m[sighting.light]};
        if (form_ == WandForm::kLine) light.along_m = places_[sighting.light];
        problem.AddResidualBlock(new LightError(light, sighting.px),
                                 loss,
                                 camera.pose.data(),
                                 camera.lens.data(),
                                 of(sighting.instant));
    }
    void set_manifold(ceres::Problem& problem, std::size_t instant) {
        if (form_ == WandForm::kLine)
            problem.SetManifold(of(instant),
                                new ceres::ProductManifold<ceres::EuclideanManifold<3>,
                                                           ceres::SphereManifold<3>>());
        if (form_ == WandForm::kBody)
            problem.SetManifold(of(instant),
                                new ceres::ProductManifold<ceres::EigenQuaternionManifold,
                                                           ceres::EuclideanManifold<3>>());
    }
    void store(std::size_t instant) {
        const auto& v = values_[instant];
        geometry::RigidTransform& pose = bundle_.wands[instant].world_from_wand;
        const Eigen::Vector3d& first = bundle_.wand.lights_m[0];
        if (form_ == WandForm::kBody) {
            pose.rotation = Eigen::Quaterniond(v[3], v[0], v[1], v[2]).normalized();
            pose.translation = {v[4], v[5], v[6]};
            return;
        }
        if (form_ == WandForm::kLine)
            pose.rotation = geometry::rotation_between(along_, Eigen::Vector3d(v[3], v[4], v[5]));
        pose.translation = Eigen::Vector3d(v[0], v[1], v[2]) - pose.rotation * first;
    }

private:
    void load(const geometry::RigidTransform& pose, std::array<double, 7>& v) const {
        const Eigen::Vector3d first = pose * bundle_.wand.lights_m[0];
        const Eigen::Vector3d along = pose.rotation * along_;
        const Eigen::Quaterniond& q = pose.rotation;
        const Eigen::Vector3d& t = pose.translation;
        if (form_ == WandForm::kBody)
            v = {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
        else
            v = {first.x(), first.y(), first.z(), along.x(), along.y(), along.z(), 0.0};
    }

    Bundle& bundle_;
    WandForm form_;
    std::vector<double> places_;
    Eigen::Vector3d along_ = Eigen::Vector3d::UnitX();
    std::vector<std::array<double, 7>> values_;
};

}  // namespace

geometry::PinholeCamera BundleCamera::intrinsics() const {
    geometry::PinholeCamera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = lens[0];
    camera.cx = lens[1];
    camera.cy = lens[2];
    camera.distortion = {lens[3], lens[4], lens[5], lens[6], lens[7]};
    return camera;
}

geometry::RigidTransform BundleCamera::camera_from_world() const {
    const Eigen::Vector3d turn(pose[0], pose[1], pose[2]);
    const double angle = turn.norm();
    geometry::RigidTransform transform;
    if (angle > 1e-12)
        transform.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
    transform.translation = {pose[3], pose[4], pose[5]};
    return transform;
}

void BundleCamera::set_camera_from_world(const geometry::RigidTransform& transform) {
    const Eigen::AngleAxisd turn(transform.rotation);
    const Eigen::Vector3d vector = turn.angle() * turn.axis();
    const Eigen::Vector3d& t = transform.translation;
    pose = {vector.x(), vector.y(), vector.z(), t.x(), t.y(), t.z()};
}

Eigen::Vector2d project(const BundleCamera& camera, const Eigen::Vector3d& point_world) {
    return project_in_camera(camera.lens, camera.camera_from_world() * point_world)
        .value_or(Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

Eigen::Vector3d light_world(const Bundle& bundle, const Sighting& sighting) {
    return bundle.wands[sighting.instant].world_from_wand * bundle.wand.lights_m[sighting.light];
}

Eigen::Vector2d error_px(const Bundle& bundle, const Sighting& sighting) {
    const BundleCamera& camera = bundle.cameras[sighting.camera];
    if (!camera.is_placed || !bundle.wands[sighting.instant].is_placed)
        return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
    return sighting.px - project(camera, light_world(bundle, sighting));
}

Expected<void> adjust(Bundle& bundle, const AdjustOptions& options) {
    const std::unique_ptr<ceres::LossFunction> loss(
        options.robust_px > 0.0 ? new ceres::CauchyLoss(options.robust_px) : nullptr);
    ceres::Problem::Options ownership;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    WandBlocks blocks(bundle);
    ceres::Solver::Options solver;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    std::vector<std::uint8_t> camera_is_in(bundle.cameras.size(), 0);
    std::vector<std::uint8_t> wand_is_in(bundle.wands.size(), 0);
    for (const Sighting& sighting : bundle.sightings) {
        BundleCamera& camera = bundle.cameras[sighting.camera];
        if (!sighting.is_used || !camera.is_placed || !bundle.wands[sighting.instant].is_placed)
            continue;
        blocks.add_residual(problem, sighting, camera, loss.get());
        camera_is_in[sighting.camera] = wand_is_in[sighting.instant] = 1;
    }
    for (std::size_t i = 0; i < wand_is_in.size(); ++i) {
        if (wand_is_in[i] == 0) continue;
        blocks.set_manifold(problem, i);
        ordering->AddElementToGroup(blocks.of(i), 0);
    }
    const std::vector<int> fixed = fixed_values(options.lens);
    bool is_first = true;
    for (std::size_t i = 0; i < camera_is_in.size(); ++i) {
        if (camera_is_in[i] == 0) continue;
        BundleCamera& camera = bundle.cameras[i];
        if (options.lens == LensFreedom::kFixed || options.are_cameras_fixed) {
            problem.SetParameterBlockConstant(camera.lens.data());
        } else {
            problem.AddResidualBlock(
                new LensPrior(camera.lens, camera.width), nullptr, camera.lens.data());
            if (!fixed.empty())
                problem.SetManifold(camera.lens.data(), new ceres::SubsetManifold(8, fixed));
        }
        if (is_first || options.are_cameras_fixed)
            problem.SetParameterBlockConstant(camera.pose.data());
        is_first = false;
        ordering->AddElementToGroup(camera.pose.data(), 1);
        ordering->AddElementToGroup(camera.lens.data(), 1);
    }
    if (is_first) return make_error(ErrorKind::kInternal, "no sightings to adjust");
    solver.linear_solver_ordering = ordering;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.max_num_iterations = options.max_iterations;
    solver.num_threads = options.num_threads;
    solver.function_tolerance = 1e-8;
    solver.logging_type = ceres::SILENT;
    FLAGS_minloglevel = google::GLOG_FATAL;  // its steps that fail are tried again, shorter
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable())
        return make_error(ErrorKind::kInternal,
                          fmt::format("the adjustment failed: {}", summary.message));
    for (std::size_t i = 0; i < wand_is_in.size(); ++i)
        if (wand_is_in[i] != 0) blocks.store(i);
    return {};
}

}  // namespace atrium::calibrate
