#include "tools/calibrate/report/compare_rigs.hpp"

#include "core/base/median.hpp"
#include "core/geometry/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace atrium::calibrate {
namespace {

// Two good calibrations of a room differ by less.
constexpr double kStays_m = 0.010;
constexpr double kStays_deg = 0.15;
// A camera that hangs in the mount of another one.
constexpr double kSameMount_m = 0.10;
constexpr double kSameMount_deg = 5.0;
// From here on a camera has moved, for the choice of the transform.
constexpr double kMoved_m = 0.1;
// A turn as a move, for the choice of the camera that stays: at this distance.
constexpr double kLever_m = 3.0;

// A camera in both rigs. Its orientation is that of its rays: a principal point that is some pixels
// off and a turn that makes up for it, which no calibration tells apart, are no turn.
struct Both {
    geometry::RigidTransform old_site_from_camera;
    geometry::RigidTransform new_site_from_camera;  // as if the camera had the old lens
};

// Directions of a grid of pixels, in the camera; empty where the lens has no inverse.
using Directions = std::vector<std::optional<Eigen::Vector3d>>;

Directions directions_of(const geometry::PinholeCamera& lens) {
    constexpr int kSide = 7;
    Directions directions;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Eigen::Vector2d px(lens.width * (i % kSide + 0.5) / kSide - 0.5,
                                 lens.height * (i / kSide + 0.5) / kSide - 0.5);
        const auto undistorted = lens.undistort(px);
        if (undistorted) {
            directions.emplace_back(lens.ray_camera(*undistorted).normalized());
        } else {
            directions.emplace_back();
        }
    }
    return directions;
}

// The rotation that lays the directions of one lens on those of another one (Kabsch 1976).
Eigen::Quaterniond rotation_between_lenses(const geometry::PinholeCamera& from,
                                           const geometry::PinholeCamera& to) {
    const Directions a = directions_of(from), b = directions_of(to);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i] || !b[i]) continue;
        sum += *b[i] * a[i]->transpose();
        ++count;
    }
    if (count < 3) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond(geometry::rotation_of(sum));
}

Both in_both(const geometry::CalibratedCamera& old_camera,
             const geometry::CalibratedCamera& new_camera) {
    Both both{old_camera.camera_from_site.inverse(), new_camera.camera_from_site.inverse()};
    both.new_site_from_camera.rotation =
        both.new_site_from_camera.rotation *
        rotation_between_lenses(old_camera.intrinsics, new_camera.intrinsics);
    return both;
}

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return a.angularDistance(b);
}

double move_of(const Both& camera, const geometry::RigidTransform& old_from_new) {
    const geometry::RigidTransform laid = old_from_new * camera.new_site_from_camera;
    return (laid.translation - camera.old_site_from_camera.translation).norm() +
           kLever_m * angle_between(laid.rotation, camera.old_site_from_camera.rotation);
}

bool are_near(const geometry::RigidTransform& a,
              const geometry::RigidTransform& b,
              double most_m,
              double most_deg) {
    return (a.translation - b.translation).norm() <= most_m &&
           angle_between(a.rotation, b.rotation) <= most_deg * std::numbers::pi / 180.0;
}

bool stays(const Both& camera, const geometry::RigidTransform& old_from_new) {
    return are_near(old_from_new * camera.new_site_from_camera,
                    camera.old_site_from_camera,
                    kStays_m,
                    kStays_deg);
}

bool are_exchanged(const Both& a, const Both& b, const geometry::RigidTransform& old_from_new) {
    if (stays(a, old_from_new) || stays(b, old_from_new)) return false;
    const auto hangs_at = [&](const Both& camera, const Both& other) {
        return are_near(old_from_new * camera.new_site_from_camera,
                        other.old_site_from_camera,
                        kSameMount_m,
                        kSameMount_deg);
    };
    return hangs_at(a, b) && hangs_at(b, a);
}

geometry::RigidTransform laid_on(const Both& camera) {
    return camera.old_site_from_camera * camera.new_site_from_camera.inverse();
}

// The transform that most cameras agree with: a camera that moved counts alike however far it did.
geometry::RigidTransform agreed(const std::vector<Both>& cameras) {
    geometry::RigidTransform best;
    double least = -1.0;
    for (const Both& one : cameras) {
        const geometry::RigidTransform candidate = laid_on(one);
        double sum = 0.0;
        for (const Both& other : cameras) sum += std::min(move_of(other, candidate), kMoved_m);
        if (least >= 0.0 && sum >= least) continue;
        least = sum;
        best = candidate;
    }
    return best;
}

// Mean rotation of the cameras (Moakher, 2002: the projected arithmetic mean), mean shift of their
// centres.
geometry::RigidTransform mean_over(const std::vector<const Both*>& cameras) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d old_middle = Eigen::Vector3d::Zero(), new_middle = Eigen::Vector3d::Zero();
    for (const Both* camera : cameras) {
        sum += laid_on(*camera).rotation.toRotationMatrix();
        old_middle += camera->old_site_from_camera.translation;
        new_middle += camera->new_site_from_camera.translation;
    }
    const auto n = static_cast<double>(cameras.size());
    geometry::RigidTransform mean;
    mean.rotation = Eigen::Quaterniond(geometry::rotation_of(sum)).normalized();
    mean.translation = old_middle / n - mean.rotation * (new_middle / n);
    return mean;
}

double ratio_of_lengths(const std::vector<Both>& cameras) {
    std::vector<double> ratios;
    for (std::size_t a = 0; a < cameras.size(); ++a) {
        for (std::size_t b = a + 1; b < cameras.size(); ++b) {
            const auto apart = [&](auto pose) {
                return ((cameras[a].*pose).translation - (cameras[b].*pose).translation).norm();
            };
            const double before = apart(&Both::old_site_from_camera);
            if (before > 0.1) ratios.push_back(apart(&Both::new_site_from_camera) / before);
        }
    }
    return ratios.size() < 3 ? 1.0 : median_of(std::move(ratios));
}

}  // namespace

std::size_t RigComparison::num_staying() const {
    return static_cast<std::size_t>(std::ranges::count_if(moves, &CameraMove::stays));
}

bool RigComparison::shares_frame() const {
    return moves.size() >= 3 && 2 * num_staying() > moves.size();
}

RigComparison compare_rigs(const config::Rig& old_rig, const config::Rig& new_rig) {
    RigComparison comparison;
    std::vector<Both> cameras;
    for (const geometry::CalibratedCamera& camera : new_rig.cameras) {
        const auto found =
            std::ranges::find(old_rig.cameras, camera.name, &geometry::CalibratedCamera::name);
        if (found == old_rig.cameras.end()) {
            comparison.only_in_new.push_back(camera.name);
            continue;
        }
        cameras.push_back(in_both(*found, camera));
        CameraMove move;
        move.name = camera.name;
        move.focal_ratio = camera.intrinsics.fx / found->intrinsics.fx;
        comparison.moves.push_back(move);
    }
    for (const geometry::CalibratedCamera& camera : old_rig.cameras)
        if (std::ranges::find(new_rig.cameras, camera.name, &geometry::CalibratedCamera::name) ==
            new_rig.cameras.end())
            comparison.only_in_old.push_back(camera.name);
    if (cameras.empty()) return comparison;

    comparison.length_ratio = ratio_of_lengths(cameras);
    comparison.old_from_new = agreed(cameras);
    for (int round = 0; round < 2; ++round) {
        std::vector<const Both*> staying;
        for (const Both& camera : cameras)
            if (stays(camera, comparison.old_from_new)) staying.push_back(&camera);
        if (!staying.empty()) comparison.old_from_new = mean_over(staying);
    }
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const geometry::RigidTransform laid =
            comparison.old_from_new * cameras[i].new_site_from_camera;
        const geometry::RigidTransform& before = cameras[i].old_site_from_camera;
        CameraMove& move = comparison.moves[i];
        move.moved_m = (laid.translation - before.translation).norm();
        move.turned_deg = angle_between(laid.rotation, before.rotation) * 180.0 / std::numbers::pi;
        move.stays = stays(cameras[i], comparison.old_from_new);
    }
    for (std::size_t a = 0; a < cameras.size(); ++a)
        for (std::size_t b = a + 1; b < cameras.size(); ++b)
            if (are_exchanged(cameras[a], cameras[b], comparison.old_from_new))
                comparison.exchanged.emplace_back(comparison.moves[a].name,
                                                  comparison.moves[b].name);
    return comparison;
}

config::Rig in_frame_of_old(const config::Rig& new_rig, const RigComparison& comparison) {
    config::Rig laid = new_rig;
    laid.bounds_site = {};
    laid.has_bounds = false;
    const geometry::RigidTransform new_from_old = comparison.old_from_new.inverse();
    for (geometry::CalibratedCamera& camera : laid.cameras)
        camera.camera_from_site = camera.camera_from_site * new_from_old;
    return laid;
}

}  // namespace atrium::calibrate
