#include "tools/calibrate/adjust/bundle.hpp"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>
#include <glog/logging.h>

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

// Pixel of a point in the camera's frame (OpenCV's distortion). False behind the camera.
template <typename T>
bool project_in_camera(const T* lens, const T* p, T* px) {
    if (!(p[2] > T(1e-6))) return false;
    const T x = p[0] / p[2], y = p[1] / p[2];
    const T r2 = x * x + y * y;
    const T radial = T(1) + r2 * (lens[3] + r2 * (lens[4] + r2 * lens[7]));
    const T dx = T(2) * lens[5] * x * y + lens[6] * (r2 + T(2) * x * x);
    const T dy = lens[5] * (r2 + T(2) * y * y) + T(2) * lens[6] * x * y;
    px[0] = lens[0] * (x * radial + dx) + lens[1];
    px[1] = lens[0] * (y * radial + dy) + lens[2];
    return true;
}

// Blocks of a wand's pose, by its form. Each gives the place of a light in the world.
struct PointBlock {
    static constexpr int kSize = 3;
    Eigen::Vector3d light_m;
    template <typename T>
    void place(const T* block, T* world) const {
        for (int i = 0; i < 3; ++i) world[i] = block[i];
    }
};

// Place of light 0 and direction of the line: turning about itself does not move a line.
struct LineBlock {
    static constexpr int kSize = 6;
    double along_m;
    template <typename T>
    void place(const T* block, T* world) const {
        for (int i = 0; i < 3; ++i) world[i] = block[i] + T(along_m) * block[3 + i];
    }
};

struct BodyBlock {
    static constexpr int kSize = 7;  // quaternion x, y, z, w, translation
    Eigen::Vector3d light_m;
    template <typename T>
    void place(const T* block, T* world) const {
        const T q[4] = {block[3], block[0], block[1], block[2]};  // Ceres: w first
        const T light[3] = {T(light_m.x()), T(light_m.y()), T(light_m.z())};
        ceres::UnitQuaternionRotatePoint(q, light, world);
        for (int i = 0; i < 3; ++i) world[i] += block[4 + i];
    }
};

template <typename Block>
struct Reprojection {
    Block light;
    Eigen::Vector2d px;
    template <typename T>
    bool operator()(const T* pose, const T* lens, const T* block, T* residual) const {
        T world[3], camera[3], seen[2];
        light.place(block, world);
        ceres::AngleAxisRotatePoint(pose, world, camera);
        for (int i = 0; i < 3; ++i) camera[i] += pose[3 + i];
        if (!project_in_camera(lens, camera, seen)) return false;
        residual[0] = seen[0] - T(px.x());
        residual[1] = seen[1] - T(px.y());
        return true;
    }
};

struct LensPrior {
    std::array<double, 8> nominal;
    double width;
    template <typename T>
    bool operator()(const T* lens, T* residual) const {
        if (!(lens[0] > T(0))) return false;
        residual[0] = log(lens[0] / T(nominal[0])) / T(kFocalPrior);
        for (int i : {1, 2}) residual[i] = (lens[i] - T(nominal[i])) / T(kCentrePrior * width);
        for (int i : {3, 4, 7}) residual[i] = lens[i] / T(kRadialPrior);
        for (int i : {5, 6}) residual[i] = lens[i] / T(kTangentialPrior);
        return true;
    }
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
        const Eigen::Vector3d& light = bundle_.wand.lights_m[sighting.light];
        double* const block = of(sighting.instant);
        switch (form_) {
            case WandForm::kPoint:
                add(problem, PointBlock{light}, sighting, camera, loss, block);
                return;
            case WandForm::kLine:
                add(problem, LineBlock{places_[sighting.light]}, sighting, camera, loss, block);
                return;
            case WandForm::kBody:
                add(problem, BodyBlock{light}, sighting, camera, loss, block);
                return;
        }
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
            pose.rotation =
                Eigen::Quaterniond::FromTwoVectors(along_, Eigen::Vector3d(v[3], v[4], v[5]));
        pose.translation = Eigen::Vector3d(v[0], v[1], v[2]) - pose.rotation * first;
    }

private:
    template <typename Block>
    static void add(ceres::Problem& problem,
                    const Block& light,
                    const Sighting& sighting,
                    BundleCamera& camera,
                    ceres::LossFunction* loss,
                    double* block) {
        using Cost = ceres::AutoDiffCostFunction<Reprojection<Block>, 2, 6, 8, Block::kSize>;
        problem.AddResidualBlock(new Cost(new Reprojection<Block>{light, sighting.px}),
                                 loss,
                                 camera.pose.data(),
                                 camera.lens.data(),
                                 block);
    }
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
    const Eigen::Vector3d p = camera.camera_from_world() * point_world;
    Eigen::Vector2d px;
    if (!project_in_camera(camera.lens.data(), p.data(), px.data()))
        px.setConstant(std::numeric_limits<double>::quiet_NaN());
    return px;
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
            problem.AddResidualBlock(new ceres::AutoDiffCostFunction<LensPrior, 8, 8>(new LensPrior{
                                         camera.lens, static_cast<double>(camera.width)}),
                                     nullptr,
                                     camera.lens.data());
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
