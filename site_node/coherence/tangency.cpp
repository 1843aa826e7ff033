#include "site_node/coherence/tangency.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace atrium::coherence {
namespace {

constexpr std::size_t kAllPairs = 17;
constexpr std::size_t kMostSteps = 8;
constexpr std::size_t kMostJudges = 8;
constexpr double kLeastBaseline_m = 1e-3;
// Sine of the least angle between a tangent and the baseline, and cosine of the half silhouette
// about it: nearer to the epipole the planes turn too fast.
constexpr double kLeastSine = 0.1;
constexpr double kLeastCosine = 0.2;
constexpr double kLeastParallax = 0.05;  // sine of the angle between rays that meet in a point

// A camera, prepared.
struct Eye {
    Eigen::Vector3d centre;
    Eigen::Matrix3d site_from_camera;
    Eigen::Matrix<double, 3, 2> site_from_px;  // of ray_camera's derivative
};

Eye eye_of(const geometry::CalibratedCamera& camera) {
    Eye eye;
    eye.centre = camera.centre_site();
    eye.site_from_camera = camera.camera_from_site.rotation.conjugate().toRotationMatrix();
    const geometry::PinholeCamera& k = camera.intrinsics;
    Eigen::Matrix<double, 3, 2> by_px = Eigen::Matrix<double, 3, 2>::Zero();
    by_px(0, 0) = 1.0 / k.fx;
    by_px(0, 1) = -k.skew / (k.fx * k.fy);
    by_px(1, 1) = 1.0 / k.fy;
    eye.site_from_px = eye.site_from_camera * by_px;
    return eye;
}

// The half-planes about the baseline of a pair, by their tangent to the one in the middle.
struct Pencil {
    Eigen::Vector3d axis, middle, across;  // orthonormal, right-handed
};

// The ends of a silhouette in a pencil.
struct Span {
    std::array<std::size_t, 2> points;  // lowest, highest
    std::array<double, 2> angles;       // [rad]
};

std::optional<Span> span_of(const SilhouetteHull& hull,
                            const geometry::PinholeCamera& camera,
                            const Eye& eye,
                            const Pencil& pencil) {
    const Eigen::RowVector3d middle = pencil.middle.transpose() * eye.site_from_camera;
    const Eigen::RowVector3d across = pencil.across.transpose() * eye.site_from_camera;
    Span span{{0, 0}, {std::numeric_limits<double>::infinity(), 0.0}};
    span.angles[1] = -span.angles[0];
    for (std::size_t i = 0; i < hull.points.size(); ++i) {
        const Eigen::Vector3d ray = camera.ray_camera(hull.points[i]);
        const double ahead = middle.dot(ray);
        if (ahead < kLeastCosine * kLeastSine * ray.norm()) return std::nullopt;
        const double slope = across.dot(ray) / ahead;
        if (slope < span.angles[0]) {
            span.angles[0] = slope;
            span.points[0] = i;
        }
        if (slope > span.angles[1]) {
            span.angles[1] = slope;
            span.points[1] = i;
        }
    }
    const double steepest = std::sqrt(1.0 / (kLeastCosine * kLeastCosine) - 1.0);
    if (-span.angles[0] > steepest || span.angles[1] > steepest) return std::nullopt;
    for (double& angle : span.angles) angle = std::atan(angle);
    return span;
}

Eigen::Vector3d middle_ray(const SilhouetteHull& hull,
                           const geometry::PinholeCamera& camera,
                           const Eye& eye) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector2d& p : hull.points) sum += camera.ray_camera(p).normalized();
    return (eye.site_from_camera * sum).normalized();
}

class Finder {
public:
    Finder(std::span<const geometry::CalibratedCamera> cameras,
           const Sight& sight,
           std::uint32_t number,
           const TangencyOptions& options,
           std::vector<Tangency>& out)
        : cameras_(cameras), sight_(sight), number_(number), options_(options), out_(out) {
        for (std::size_t i = 0; i < cameras.size(); ++i) {
            eyes_.push_back(eye_of(cameras[i]));
            middles_.push_back(sees(sight.now, i)
                                   ? middle_ray(sight.now[i], cameras[i].intrinsics, eyes_[i])
                                   : Eigen::Vector3d::Zero());
        }
    }

    void find(std::uint32_t a, std::uint32_t b) {
        if (!sees(sight_.now, a) || !sees(sight_.now, b)) return;
        const Eigen::Vector3d baseline = eyes_[b].centre - eyes_[a].centre;
        const double length = baseline.norm();
        if (length < kLeastBaseline_m) return;
        Pencil pencil;
        pencil.axis = baseline / length;
        pencil.middle = middles_[a] + middles_[b];
        pencil.middle -= pencil.middle.dot(pencil.axis) * pencil.axis;
        if (pencil.middle.norm() < 2.0 * kLeastSine * kLeastCosine) return;
        pencil.middle.normalize();
        pencil.across = pencil.axis.cross(pencil.middle);
        const auto span_a = span(sight_.now, a, pencil);
        const auto span_b = span(sight_.now, b, pencil);
        if (!span_a || !span_b) return;
        const auto before_a = span(sight_.before, a, pencil);
        const auto before_b = span(sight_.before, b, pencil);
        for (std::size_t side = 0; side < 2; ++side) {
            const std::size_t at_a = span_a->points[side];
            const std::size_t at_b = span_b->points[side];
            if (sight_.now[a].at_border[at_a] != 0 || sight_.now[b].at_border[at_b] != 0) continue;
            Tangency found;
            found.sight = number_;
            found.error_px = span_a->angles[side] - span_b->angles[side];
            if (!complete(a, at_a, b, at_b, pencil, length, side, found)) continue;
            const bool is_moving = before_a && before_b &&
                                   sight_.before[a].at_border[before_a->points[side]] == 0 &&
                                   sight_.before[b].at_border[before_b->points[side]] == 0;
            found.motion_px = is_moving ? 0.5 *
                                              (span_a->angles[side] - before_a->angles[side] +
                                               span_b->angles[side] - before_b->angles[side]) /
                                              found.rad_per_px
                                        : std::numeric_limits<double>::quiet_NaN();
            out_.push_back(found);
        }
    }

private:
    static bool sees(const std::vector<SilhouetteHull>& hulls, std::size_t i) {
        return i < hulls.size() && hulls[i].points.size() >= 3;
    }
    std::optional<Span> span(const std::vector<SilhouetteHull>& hulls,
                             std::size_t i,
                             const Pencil& pencil) const {
        if (!sees(hulls, i)) return std::nullopt;
        return span_of(hulls[i], cameras_[i].intrinsics, eyes_[i], pencil);
    }

    // `found.error_px` is an angle at the beginning.
    bool complete(std::uint32_t a,
                  std::size_t at_a,
                  std::uint32_t b,
                  std::size_t at_b,
                  const Pencil& pencil,
                  double baseline_m,
                  std::size_t side,
                  Tangency& found) const {
        const std::array<std::uint32_t, 2> cameras{a, b};
        const std::array<std::size_t, 2> points{at_a, at_b};
        std::array<Eigen::Vector3d, 2> rays;
        std::array<double, 2> sines;
        std::array<double, 2> per_px;
        for (std::size_t e = 0; e < 2; ++e) {
            const Eye& eye = eyes_[cameras[e]];
            TangentEnd& end = found.ends[e];
            end.camera = cameras[e];
            const Eigen::Vector3d along = cameras_[end.camera].intrinsics.ray_camera(
                sight_.now[end.camera].points[points[e]]);
            end.ray_camera = along.normalized();
            rays[e] = eye.site_from_camera * end.ray_camera;
            const Eigen::Vector3d ahead = pencil.axis.cross(rays[e]);
            sines[e] = ahead.norm();
            if (sines[e] < kLeastSine) return false;
            const Eigen::Vector3d normal = ahead / sines[e];
            per_px[e] = (normal.transpose() * eye.site_from_px).norm() / (along.norm() * sines[e]);
            end.by_turn = rays[e].cross(normal) / sines[e];
        }
        found.rad_per_px = std::sqrt(0.5 * (per_px[0] * per_px[0] + per_px[1] * per_px[1]));
        found.error_px /= found.rad_per_px;
        if (std::abs(found.error_px) > options_.most_px) return false;
        const Eigen::Vector3d by_move =
            rays[0].cross(rays[1]) / (baseline_m * sines[0] * sines[1] * found.rad_per_px);
        const double outwards = side == 0 ? -1.0 : 1.0;
        for (std::size_t e = 0; e < 2; ++e) {
            const double sign = e == 0 ? 1.0 : -1.0;
            TangentEnd& end = found.ends[e];
            end.by_turn *= sign / found.rad_per_px;
            end.by_move = sign * by_move;
            end.by_dilation = sign * outwards * per_px[e] / found.rad_per_px;
        }
        return is_confirmed(a, rays[0], b, rays[1]);
    }

    // Whether most of the others see somebody where the rays meet.
    bool is_confirmed(std::uint32_t a,
                      const Eigen::Vector3d& ray_a,
                      std::uint32_t b,
                      const Eigen::Vector3d& ray_b) const {
        const Eigen::Vector3d normal = ray_a.cross(ray_b);
        if (normal.norm() < kLeastParallax) return true;
        const Eigen::Vector3d baseline = eyes_[b].centre - eyes_[a].centre;
        const double depth_a = baseline.cross(ray_b).dot(normal) / normal.squaredNorm();
        const double depth_b = baseline.cross(ray_a).dot(normal) / normal.squaredNorm();
        if (depth_a <= 0.0 || depth_b <= 0.0) return false;
        const Eigen::Vector3d point =
            0.5 * (eyes_[a].centre + depth_a * ray_a + eyes_[b].centre + depth_b * ray_b);
        const std::size_t n = cameras_.size();
        const std::size_t step = std::max<std::size_t>(1, n / kMostJudges);
        int votes = 0;
        for (std::size_t i = a % step; i < n; i += step) {
            if (i == a || i == b || i >= sight_.now.size() || !sight_.now[i].has_picture) continue;
            const geometry::CalibratedCamera& camera = cameras_[i];
            const Eigen::Vector3d p = camera.camera_from_site * point;
            if (p.z() <= 0.0) continue;
            const Eigen::Vector2d px = camera.intrinsics.project(p);
            const Eigen::Vector2d seen = camera.intrinsics.distort(px);
            if (!(seen.x() > 0.0 && seen.y() > 0.0 && seen.x() < camera.intrinsics.width - 1 &&
                  seen.y() < camera.intrinsics.height - 1))
                continue;
            const bool agrees = sees(sight_.now, i) &&
                                distance_outside_px(sight_.now[i], px) <= options_.confirmed_px;
            votes += agrees ? 1 : -1;
        }
        return votes >= 0;
    }

    std::span<const geometry::CalibratedCamera> cameras_;
    const Sight& sight_;
    std::uint32_t number_;
    const TangencyOptions& options_;
    std::vector<Tangency>& out_;
    std::vector<Eye> eyes_;
    std::vector<Eigen::Vector3d> middles_;
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_of(std::size_t num_cameras) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const std::size_t half = num_cameras / 2;
    const auto steps = num_cameras <= kAllPairs ? half : kMostSteps;
    for (std::size_t s = 1; s <= steps; ++s) {
        // from 1 to half, so that all cameras hang together
        const std::size_t step = s == 1 ? 1 : 1 + (s - 1) * (half - 1) / (steps - 1);
        // the longest step of an even number meets each pair twice
        const std::size_t end = 2 * step == num_cameras ? half : num_cameras;
        for (std::size_t a = 0; a < end; ++a) {
            const auto [low, high] = std::minmax({a, (a + step) % num_cameras});
            pairs.emplace_back(static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high));
        }
    }
    std::ranges::sort(pairs);
    return pairs;
}

void find_tangencies(std::span<const geometry::CalibratedCamera> cameras,
                     const Sight& sight,
                     std::uint32_t number,
                     const TangencyOptions& options,
                     std::vector<Tangency>& out) {
    Finder finder(cameras, sight, number, options, out);
    for (const auto& [a, b] : pairs_of(cameras.size())) finder.find(a, b);
}

}  // namespace atrium::coherence
