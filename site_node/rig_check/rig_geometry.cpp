#include "site_node/rig_check/rig_geometry.hpp"

#include "site_node/rig_check/length_mistakes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::rig_check {
namespace {

// Camera distances [m] that no room has, and those of large halls.
constexpr double kImpossible_m = 100.0;
constexpr double kFarFromOrigin_m = 12.0;
constexpr double kMostTangential = 0.1;
constexpr double kUnusual_m = 40.0;
constexpr double kTooNear_m = 0.02;
constexpr double kNear_m = 1.0;  // a person is half a metre wide
// Length of the mean unit vector to the cameras: from one side, and from around.
constexpr double kOneSided = 0.6;
constexpr double kAround = 0.45;
// A pinhole camera of more than this has no use: the focal length is in another unit.
constexpr double kWidestView_deg = 150.0;
constexpr double kNarrowestView_deg = 1.0;

double widest_distance_m(std::span<const geometry::CalibratedCamera> cameras) {
    double widest = 0.0;
    for (const auto& a : cameras) {
        for (const auto& b : cameras)
            widest = std::max(widest, (a.centre_site() - b.centre_site()).norm());
    }
    return widest;
}

std::string length_text(double m) {
    return m < 0.1 ? fmt::format("{:.3g} mm", 1e3 * m) : fmt::format("{:.3g} m", m);
}

// The mistake with which cameras `widest_m` apart would fit into a room.
std::string likely_mistake(double widest_m, double unit_m) {
    const auto mistakes = likely_length_mistakes(widest_m, kRoomWidth, unit_m);
    return mistakes.empty() ? "the translations look wrong; check them, and the key units"
                            : explain(mistakes, kRoomWidth);
}

void check_distances(std::span<const geometry::CalibratedCamera> cameras,
                     double unit_m,
                     std::vector<Finding>& findings) {
    const double widest = widest_distance_m(cameras);
    if (widest > kUnusual_m) {
        findings.push_back({widest > kImpossible_m,
                            fmt::format("the cameras are up to {} apart: {}",
                                        length_text(widest),
                                        likely_mistake(widest, unit_m))});
    } else if (widest >= kTooNear_m && widest < kNear_m &&
               find_common_view(cameras).one_sidedness < kOneSided) {
        findings.push_back(
            {false,
             fmt::format("the cameras stand around a place and are at most {} apart: there is "
                         "space for a hand, not for a person; if people stand there, the "
                         "translations are too small",
                         length_text(widest))});
    } else if (widest < kTooNear_m) {
        findings.push_back(
            {true,
             fmt::format("the cameras are at most {} apart, and a hull needs different places: {}",
                         length_text(widest),
                         widest > 1e-4 ? likely_mistake(widest, unit_m)
                                       : "all translations say the same place; write those of the "
                                         "calibration")});
    }
}

// People are published in the rig's frame, and worlds are a few metres large.
void check_origin(std::span<const geometry::CalibratedCamera> cameras,
                  std::vector<Finding>& findings) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto& camera : cameras)
        middle += camera.centre_site() / static_cast<double>(cameras.size());
    if (middle.cwiseAbs().maxCoeff() < kFarFromOrigin_m) return;
    findings.push_back(
        {false,
         fmt::format("the cameras stand around a place at ({:.4g}, {:.4g}, {:.4g}) m, so people "
                     "will be there, and world servers refuse people more than 15 m from the "
                     "origin: give the rig the frame of its room with `calibrate floor`, or import "
                     "it again, which moves the origin below the cameras",
                     middle.x(),
                     middle.y(),
                     middle.z())});
}

bool sees(const geometry::CalibratedCamera& camera, const Eigen::Vector3d& p_site) {
    const Eigen::Vector3d p = camera.camera_from_site * p_site;
    if (!(p.z() > 0.0)) return false;
    const Eigen::Vector2d pixel = camera.intrinsics.project(p);
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= camera.intrinsics.width - 1.0 &&
           pixel.y() <= camera.intrinsics.height - 1.0;
}

std::vector<geometry::CalibratedCamera> reread(std::span<const geometry::CalibratedCamera> cameras,
                                               Misreading misreading) {
    std::vector<geometry::CalibratedCamera> result(cameras.begin(), cameras.end());
    for (auto& camera : result)
        camera.camera_from_site = corrected(camera.camera_from_site, misreading);
    return result;
}

// Warns only where the other reading makes a good rig, and this one a bad one.
void check_directions(std::span<const geometry::CalibratedCamera> cameras,
                      std::vector<Finding>& findings) {
    const CommonView as_is = find_common_view(cameras);
    const bool is_hopeless = as_is.num_cameras < 2;
    const bool share_little = 2 * as_is.num_cameras < cameras.size() + 1;
    const bool is_one_sided = as_is.one_sidedness > kOneSided && cameras.size() > 2;
    if (!is_hopeless && !share_little && !is_one_sided) return;
    std::string cause;
    double best = is_hopeless ? 1.0 : kAround;
    for (const Misreading misreading : kMisreadings) {
        const CommonView other = find_common_view(reread(cameras, misreading));
        const bool is_good =
            other.num_cameras == cameras.size() || (is_hopeless && other.num_cameras > 1);
        if (!is_good || other.one_sidedness >= best) continue;
        best = other.one_sidedness;
        cause = explain(misreading);
    }
    if (is_hopeless) {
        findings.push_back(
            {true,
             "no point is seen by two cameras, so no hull is possible: " +
                 (cause.empty() ? "check rotation and translation of each camera" : cause)});
    } else if (!cause.empty()) {
        findings.push_back(
            {false,
             fmt::format("{}: {}",
                         !share_little
                             ? std::string("all cameras look from one side")
                             : fmt::format("at most {} of {} cameras see a point in common",
                                           as_is.num_cameras,
                                           cameras.size()),
                         cause)});
    }
}

// Upright cameras around a room agree about up.
void check_up(std::span<const geometry::CalibratedCamera> cameras, std::vector<Finding>& findings) {
    if (cameras.size() < 3 || find_common_view(cameras).one_sidedness > 0.6) return;
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (const auto& camera : cameras) {
        up -= camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::UnitY() /
              static_cast<double>(cameras.size());
    }
    if (up.norm() < 0.6 || up.z() > 0.5 * up.norm()) return;
    int axis = 0;
    up.cwiseAbs().maxCoeff(&axis);
    findings.push_back({false,
                        fmt::format("the cameras are upright along {}{} of the site, but +Z is up "
                                    "in Atrium: people would lie or stand on their heads; turn the "
                                    "site frame of the calibration",
                                    up[axis] > 0.0 ? '+' : '-',
                                    "XYZ"[axis])});
}

double view_deg(double size_px, double focal_px) {
    return 2.0 * std::atan(0.5 * size_px / focal_px) * 180.0 / std::numbers::pi;
}

void check_intrinsics(const geometry::CalibratedCamera& camera, std::vector<Finding>& findings) {
    const geometry::PinholeCamera& k = camera.intrinsics;
    const double view = view_deg(k.width, k.fx);
    if (view > kWidestView_deg) {
        findings.push_back(
            {false,
             fmt::format("camera '{}': fx = {:g} px in pictures {} px wide is a view "
                         "of {:.0f} degrees: fx and fy look like millimetres or "
                         "shares of the width; write them in pixels",
                         camera.name,
                         k.fx,
                         k.width,
                         view)});
        return;
    }
    if (view < kNarrowestView_deg) {
        findings.push_back(
            {false,
             fmt::format("camera '{}': fx = {:g} px in pictures {} px wide is a view of {:.2g} "
                         "degrees; check fx, fy and width",
                         camera.name,
                         k.fx,
                         k.width,
                         view)});
        return;
    }
    const double tangential = std::max(std::abs(k.distortion[2]), std::abs(k.distortion[3]));
    if (tangential > kMostTangential) {
        findings.push_back(
            {false,
             fmt::format("camera '{}': its distortion has p1 = {:g} and p2 = {:g}, which no lens "
                         "has: is the order of the numbers k1, k2, p1, p2, k3, k4, k5, k6? Kinects "
                         "give k1 to k6 first",
                         camera.name,
                         k.distortion[2],
                         k.distortion[3])});
    }
    const double off =
        std::max(std::abs((k.cx + 0.5) / k.width - 0.5), std::abs((k.cy + 0.5) / k.height - 0.5));
    if (off > 0.3) {
        findings.push_back(
            {false,
             fmt::format("camera '{}': the principal point ({:g}, {:g}) is far from the middle of "
                         "pictures of {}x{} px: the calibration looks like that of another picture "
                         "size; scale fx, fy, cx and cy with it",
                         camera.name,
                         k.cx,
                         k.cy,
                         k.width,
                         k.height)});
    } else if (const double ratio = k.fx / k.fy; ratio > 1.3 || ratio < 1.0 / 1.3) {
        findings.push_back({false,
                            fmt::format("camera '{}': fx = {:g} and fy = {:g} differ by more than "
                                        "30 %, which only pixels that are not square explain",
                                        camera.name,
                                        k.fx,
                                        k.fy)});
    }
}

}  // namespace

std::vector<Finding> check_lens(const geometry::CalibratedCamera& camera) {
    std::vector<Finding> findings;
    check_intrinsics(camera, findings);
    return findings;
}

geometry::RigidTransform corrected(const geometry::RigidTransform& camera_from_site,
                                   Misreading misreading) {
    // turns the axes of a camera that looks along -Z, +Y up, into ours
    const geometry::RigidTransform flip{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0),
                                        Eigen::Vector3d::Zero()};
    switch (misreading) {
        case Misreading::kNone:
            return camera_from_site;
        case Misreading::kInverted:
            return camera_from_site.inverse();
        case Misreading::kOpenGl:
            return flip * camera_from_site;
        case Misreading::kInvertedOpenGl:
            return flip * camera_from_site.inverse();
    }
    return camera_from_site;
}

std::string explain(Misreading misreading) {
    switch (misreading) {
        case Misreading::kNone:
            break;
        case Misreading::kInverted:
            return "rotation and translation look like site_from_camera (inverted); write "
                   "camera_from_site: p_camera = rotation * p_site + translation";
        case Misreading::kOpenGl:
            return "the cameras look backwards, as in OpenGL's convention (-Z ahead, +Y up); "
                   "multiply the second and third row of each rotation, and the second and third "
                   "number of each translation, by -1";
        case Misreading::kInvertedOpenGl:
            return "rotation and translation look like site_from_camera (inverted) of cameras in "
                   "OpenGL's convention (-Z ahead, +Y up); invert them, then multiply the second "
                   "and third row by -1";
    }
    return "";
}

CommonView find_common_view(std::span<const geometry::CalibratedCamera> cameras) {
    constexpr int kGrid = 5;     // rays per row and column of a picture
    constexpr int kDepths = 12;  // from 1/16 to 8 times the size of the rig
    const double size = std::max(widest_distance_m(cameras), 1e-9);
    CommonView best;
    for (const geometry::CalibratedCamera& camera : cameras) {
        const geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
        for (int i = 0; i < kGrid * kGrid * kDepths; ++i) {
            const double u = (i % kGrid + 0.5) / kGrid;
            const double v = (i / kGrid % kGrid + 0.5) / kGrid;
            const double depth = size * std::exp2(i / (kGrid * kGrid) * 7.0 / (kDepths - 1) - 4.0);
            const Eigen::Vector2d pixel(u * (camera.intrinsics.width - 1),
                                        v * (camera.intrinsics.height - 1));
            const Eigen::Vector3d p =
                site_from_camera * (depth * camera.intrinsics.ray_camera(pixel));
            std::size_t count = 0;
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (const auto& other : cameras) {
                if (&other != &camera && !sees(other, p)) continue;
                ++count;
                sum += (other.centre_site() - p).normalized();
            }
            const double one_sidedness = sum.norm() / static_cast<double>(count);
            if (count > best.num_cameras ||
                (count == best.num_cameras && one_sidedness < best.one_sidedness))
                best = {count, one_sidedness};
        }
    }
    return best;
}

std::vector<Finding> check_rig(std::span<const geometry::CalibratedCamera> cameras, double unit_m) {
    std::vector<Finding> findings;
    check_distances(cameras, unit_m, findings);
    // the other checks of the extrinsics say nothing about cameras in one place
    if (findings.empty() || !findings.front().is_error) {
        check_directions(cameras, findings);
        const bool are_read_right = findings.empty();
        if (are_read_right) check_up(cameras, findings);
        if (are_read_right) check_origin(cameras, findings);
    }
    for (const auto& camera : cameras) check_intrinsics(camera, findings);
    std::stable_partition(
        findings.begin(), findings.end(), [](const Finding& finding) { return finding.is_error; });
    return findings;
}

}  // namespace atrium::rig_check
