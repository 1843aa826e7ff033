#include "swept_room.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace atrium::calibrate_test {
namespace {

geometry::CalibratedCamera camera_at(std::size_t i,
                                     const SweepOptions& options,
                                     std::mt19937& rng) {
    std::uniform_real_distribution<double> vary(-1.0, 1.0);
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(i) + 0.3 * vary(rng)) /
                         static_cast<double>(options.num_cameras);
    const Eigen::Vector3d centre(
        3.0 * std::cos(angle), 3.0 * std::sin(angle), 1.9 + 0.7 * vary(rng));
    const Eigen::Vector3d target(0.3 * vary(rng), 0.3 * vary(rng), 1.0 + 0.2 * vary(rng));
    const Eigen::Vector3d z = (target - centre).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d camera_from_site;
    camera_from_site << x.transpose(), z.cross(x).transpose(), z.transpose();
    geometry::CalibratedCamera camera;
    camera.name = fmt::format("cam{}", i);
    camera.camera_from_site = {Eigen::Quaterniond(camera_from_site), -(camera_from_site * centre)};
    geometry::PinholeCamera& lens = camera.intrinsics;
    lens.width = 1280;
    lens.height = 1024;
    lens.fx = lens.fy = 1000.0 + 80.0 * vary(rng);
    lens.cx = 639.5 + 12.0 * vary(rng);
    lens.cy = 511.5 + 12.0 * vary(rng);
    lens.distortion = {
        -0.18 + 0.06 * vary(rng), 0.06 + 0.03 * vary(rng), 4e-4 * vary(rng), 4e-4 * vary(rng), 0.0};
    return camera;
}

// A smooth sweep through a space of 2.4 x 2.4 x 1.8 m, at about 1 m/s.
geometry::RigidTransform wand_at(double time_s, const std::vector<double>& phases) {
    const auto wave = [&](std::size_t k, double hz) {
        return std::sin(2.0 * std::numbers::pi * hz * time_s + phases[k]);
    };
    geometry::RigidTransform pose;
    pose.translation = {0.8 * wave(0, 0.17) + 0.35 * wave(1, 0.53),
                        0.8 * wave(2, 0.13) + 0.35 * wave(3, 0.47),
                        1.05 + 0.6 * wave(4, 0.23) + 0.25 * wave(5, 0.61)};
    pose.rotation = Eigen::AngleAxisd(2.0 * wave(6, 0.11) + time_s, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(1.3 * wave(7, 0.29), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(2.0 * wave(8, 0.19), Eigen::Vector3d::UnitX());
    return pose;
}

}  // namespace

SweptRoom sweep(const calibrate::Wand& wand, const SweepOptions& options) {
    std::mt19937 rng(options.seed);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    std::normal_distribution<double> noise(0.0, options.noise_px);
    SweptRoom room;
    for (std::size_t i = 0; i < options.num_cameras; ++i)
        room.cameras.push_back(camera_at(i, options, rng));
    if (options.change) options.change(room.cameras);
    if (options.sweep_seed != 0) rng.seed(options.sweep_seed);
    std::vector<double> phases;
    for (int i = 0; i < 9; ++i) phases.push_back(2.0 * std::numbers::pi * chance(rng));
    for (std::size_t c = 0; c < room.cameras.size(); ++c) {
        const geometry::CalibratedCamera& camera = room.cameras[c];
        const geometry::PinholeCamera& lens = camera.intrinsics;
        const double off = 1.0 + options.nominal_error * (2.0 * chance(rng) - 1.0);
        room.nominal.push_back({camera.name, lens.width, lens.height, lens.fx * off});
        calibrate::LightCamera seen{camera.name, {}};
        const double late = options.late_instants.empty() ? 0.0 : options.late_instants[c];
        for (std::uint32_t instant = 0; instant < options.num_instants; ++instant) {
            const auto pose = wand_at((instant - late) / options.rate_hz, phases);
            std::vector<calibrate::LightPoint> points;
            for (std::uint32_t light = 0; light < wand.size(); ++light) {
                const Eigen::Vector3d p = camera.camera_from_site * (pose * wand.lights_m[light]);
                if (p.z() < 0.3 || chance(rng) < options.missed) continue;
                Eigen::Vector2d px = lens.distort(lens.project(p));
                px += Eigen::Vector2d(noise(rng), noise(rng));
                if (chance(rng) < options.outliers)
                    px += 60.0 * Eigen::Vector2d(chance(rng) - 0.5, chance(rng) - 0.5);
                if (px.x() < 0 || px.y() < 0 || px.x() > lens.width - 1 || px.y() > lens.height - 1)
                    continue;
                points.push_back({instant, std::nullopt, px});
                if (options.has_labels) points.back().light = light;
            }
            if (chance(rng) < options.reflections && !options.has_labels)
                points.push_back(
                    {instant, std::nullopt, {lens.width * chance(rng), lens.height * chance(rng)}});
            std::shuffle(points.begin(), points.end(), rng);
            seen.points.insert(seen.points.end(), points.begin(), points.end());
        }
        room.points.push_back(std::move(seen));
    }
    return room;
}

double centres_rms_m(const SweptRoom& room,
                     const calibrate::WandSolution& solution,
                     bool may_scale) {
    const auto n = static_cast<Eigen::Index>(room.cameras.size());
    Eigen::Matrix3Xd truth(3, n), found(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        truth.col(i) = room.cameras[static_cast<std::size_t>(i)].centre_site();
        found.col(i) = solution.bundle.cameras[static_cast<std::size_t>(i)].centre_world();
    }
    const Eigen::Matrix4d fit = Eigen::umeyama(found, truth, may_scale);
    const Eigen::Matrix3Xd off =
        ((fit.topLeftCorner<3, 3>() * found).colwise() + fit.topRightCorner<3, 1>()) - truth;
    return std::sqrt(off.squaredNorm() / static_cast<double>(n));
}

}  // namespace atrium::calibrate_test
