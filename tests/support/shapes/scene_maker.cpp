#include "tests/support/shapes/scene_maker.hpp"

#include "tests/support/random.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::test {
namespace {

using Eigen::Vector3d;
bool chance(Random& random, double share) { return between(random, 0.0, 1.0) < share; }

ConvexPart limb(const Vector3d& a, double radius_a_m, const Vector3d& b, double radius_b_m) {
    return {{}, {{a, radius_a_m}, {b, radius_b_m}}};
}

ConvexPart random_box(Random& random, bool upright) {
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    if (!upright) {
        const double angle = between(random, 0.0, 3.0);
        rotation = Eigen::AngleAxisd(angle, random_direction(random));
    }
    const Vector3d half = between(random, Vector3d::Constant(0.05), Vector3d::Constant(0.4));
    Vector3d centre = between(random, Vector3d(-0.4, -0.4, 0.5), Vector3d(0.4, 0.4, 1.3));
    // upper faces of upright boxes all lie in the plane z = 1.2
    if (upright) centre.z() = 1.2 - half.z();
    ConvexPart box;
    for (int corner = 0; corner < 8; ++corner) {
        const Vector3d sign(
            corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
        box.corners_site.emplace_back(centre + rotation * half.cwiseProduct(sign));
    }
    return box;
}

Vector3d near_middle(Random& random, double reach_m) {
    const double distance_m = between(random, 0.0, reach_m);
    return Vector3d(0.0, 0.0, 0.9) + distance_m * random_direction(random);
}

ConvexPart random_ball(Random& random) {
    const Vector3d centre = near_middle(random, 0.6);
    return {{}, {{centre, between(random, 0.08, 0.4)}}};
}

ConvexPart random_rod(Random& random) {
    const Vector3d middle = near_middle(random, 0.4);
    const double half_m = between(random, 0.2, 0.7);
    const Vector3d half = half_m * random_direction(random);
    const double radius_m = between(random, 0.015, 0.05);
    return limb(middle - half, radius_m, middle + half, radius_m);
}

}  // namespace

std::vector<ConvexPart> make_person(Random& random, const Vector3d& floor_site) {
    const double turn = between(random, 0.0, 2.0 * std::numbers::pi);
    const double scale = between(random, 0.9, 1.1);
    const Eigen::Quaterniond heading(Eigen::AngleAxisd(turn, Vector3d::UnitZ()));
    const auto at = [&](double x, double y, double z) -> Vector3d {
        return floor_site + scale * (heading * Vector3d(x, y, z));
    };
    const auto thick = [&](double radius_m) { return scale * radius_m; };
    std::vector<ConvexPart> parts{
        limb(at(0.0, 0.0, 0.95), thick(0.15), at(0.0, 0.0, 1.15), thick(0.13)),   // belly
        limb(at(0.0, 0.0, 1.15), thick(0.13), at(0.0, 0.0, 1.38), thick(0.15)),   // chest
        limb(at(0.0, 0.0, 1.45), thick(0.06), at(0.02, 0.0, 1.6), thick(0.06)),   // neck
        limb(at(0.02, 0.0, 1.64), thick(0.10), at(0.02, 0.0, 1.7), thick(0.09)),  // head
    };
    for (const double side : {-1.0, 1.0}) {
        const Vector3d shoulder = at(0.0, 0.19 * side, 1.42);
        Vector3d elbow;
        Vector3d hand;
        if (chance(random, 0.35)) {
            elbow = at(between(random, -0.1, 0.05), 0.44 * side, 1.22);  // hand on the hip
            hand = at(0.02, 0.18 * side, 1.0);
        } else {
            Vector3d upper = between(random, Vector3d(-0.6, 0.1, -1.0), Vector3d(0.9, 1.0, 0.7));
            Vector3d lower = between(random, Vector3d(0.0, -0.4, -1.0), Vector3d(1.0, 0.6, 1.0));
            upper.y() *= side;
            lower.y() *= side;
            elbow = shoulder + thick(0.29) * (heading * upper.normalized());
            hand = elbow + thick(0.3) * (heading * lower.normalized());
        }
        parts.push_back(limb(shoulder, thick(0.06), elbow, thick(0.045)));
        parts.push_back(limb(elbow, thick(0.045), hand, thick(0.035)));
        const Vector3d hip = at(0.0, 0.1 * side, 0.9);
        const double step = between(random, -0.3, 0.3);
        const double apart = between(random, 0.05, 0.3) * side;
        const Vector3d knee = at(step + 0.05, 0.1 * side + 0.5 * apart, 0.5);
        const Vector3d ankle = at(step, 0.1 * side + apart, 0.08);
        parts.push_back(limb(hip, thick(0.09), knee, thick(0.06)));
        parts.push_back(limb(knee, thick(0.06), ankle, thick(0.045)));
        parts.push_back(
            limb(ankle, thick(0.05), at(step + 0.17, 0.1 * side + apart, 0.05), thick(0.035)));
    }
    return parts;
}

Bodies make_bodies(BodyKind kind, Random& random) {
    Bodies bodies;
    if (kind == BodyKind::kPeople) {
        const int count = chance(random, 0.7) ? 1 : between(random, 2, 3);
        const double first = between(random, 0.0, 2.0 * std::numbers::pi);
        for (int i = 0; i < count; ++i) {
            const double angle = first + 2.0 * std::numbers::pi * i / count;
            const double radius = count == 1 ? 0.1 : between(random, 0.4, 0.6);
            const auto person =
                make_person(random, {radius * std::cos(angle), radius * std::sin(angle), 0.0});
            bodies.parts.insert(bodies.parts.end(), person.begin(), person.end());
        }
        bodies.radius_m = count == 1 ? 1.15 : 1.5;
        return bodies;
    }
    const bool upright = chance(random, 0.5);
    for (int count = between(random, 1, kind == BodyKind::kMixed ? 6 : 3); count > 0; --count) {
        int sort = between(random, 0, 2);
        if (kind == BodyKind::kBalls) sort = 0;
        if (kind == BodyKind::kBoxes) sort = 1;
        if (kind == BodyKind::kRods) sort = 2;
        if (sort == 0) bodies.parts.push_back(random_ball(random));
        if (sort == 1) bodies.parts.push_back(random_box(random, upright));
        if (sort == 2) bodies.parts.push_back(random_rod(random));
    }
    return bodies;
}

namespace {

Vector3d on_ring(double angle, double radius_m, double height_m) {
    return {radius_m * std::cos(angle), radius_m * std::sin(angle), height_m};
}

// Centres and targets of the cameras of `kind`, before any random change of single cameras.
struct Pose {
    Vector3d centre;
    Vector3d target;
};

std::vector<Pose> rig_poses(RigKind kind, int num_views, const Bodies& bodies, Random& random) {
    const double radius_m = between(random, 2.4, 4.0);
    const double first = kind == RigKind::kCoplanar ? 0.0 : between(random, 0.0, 6.28);
    const Vector3d& middle = bodies.centre_site;
    const Vector3d start = middle + on_ring(first, radius_m, between(random, -0.3, 1.5));
    const double turn = between(random, 1.2, 1.9);
    const Vector3d along = on_ring(first + turn, 2.0, between(random, -0.2, 0.2));
    std::vector<Pose> poses;
    for (int i = 0; i < num_views; ++i) {
        const double angle = first + 2.0 * std::numbers::pi * i / num_views;
        Pose pose{on_ring(angle, radius_m, i % 2 == 0 ? 1.1 : 2.4), middle};
        if (kind == RigKind::kAnywhere) {
            const double distance_m = between(random, 2.4, 4.0);
            pose.centre = middle + distance_m * random_direction(random);
        } else if (kind == RigKind::kCollinear) {
            pose.centre = start + (2.0 * i / (num_views - 1.0) - 1.0) * along;
        } else if (kind == RigKind::kCoplanar) {
            pose.centre.z() = 1.2;
            pose.target.z() =
                1.2;  // cameras see the upper faces edge-on, in the middle of the picture
        } else if (kind == RigKind::kOpposite && i % 2 == 1) {
            pose.centre = 2.0 * middle - poses.back().centre;
        } else if (kind == RigKind::kBehindEachOther && i % 2 == 1) {
            pose.centre = middle + 1.5 * (poses.back().centre - middle);
        } else if (kind == RigKind::kSharedCentre && i == num_views - 1) {
            pose.centre = poses.front().centre;
            pose.target += 0.2 * random_direction(random);
        }
        poses.push_back(pose);
    }
    return poses;
}

}  // namespace

std::vector<geometry::CalibratedCamera> make_scene_rig(RigKind kind,
                                                       int num_views,
                                                       const Bodies& bodies,
                                                       Random& random) {
    std::vector<geometry::CalibratedCamera> rig;
    for (Pose& pose : rig_poses(kind, num_views, bodies, random)) {
        if (kind == RigKind::kRing || kind == RigKind::kAnywhere)
            pose.target += 0.15 * random_direction(random);
        geometry::CalibratedCamera camera;
        const double distance_m = (pose.centre - bodies.centre_site).norm();
        camera.intrinsics.width = camera.intrinsics.height = 1000;
        // the bodies fill most of the picture
        camera.intrinsics.fx = 460.0 * distance_m / bodies.radius_m;
        camera.intrinsics.fy = camera.intrinsics.fx * between(random, 0.97, 1.03);
        camera.intrinsics.cx = 499.5 + between(random, -20.0, 20.0);
        camera.intrinsics.cy = 499.5 + between(random, -20.0, 20.0);
        camera.intrinsics.skew = chance(random, 0.2) ? between(random, -3.0, 3.0) : 0.0;
        camera.camera_from_site = look_at(pose.centre, pose.target);
        rig.push_back(camera);
    }
    return rig;
}

namespace {

Contour projection(const ConvexPart& part,
                   const geometry::CalibratedCamera& camera,
                   int ball_vertices) {
    Contour points;
    for (const Vector3d& corner : part.corners_site)
        points.push_back(camera.intrinsics.project(camera.camera_from_site * corner));
    for (const Sphere& ball : part.balls) {
        const Contour outline = outline_of(ball, camera, ball_vertices);
        points.insert(points.end(), outline.begin(), outline.end());
    }
    return convex_hull(points);
}

// Adds points on the edges until there are about `num_segments`. They are exactly collinear up to
// rounding.
Contour subdivided(const Contour& polygon, int num_segments) {
    const int parts = std::max(1, num_segments / static_cast<int>(polygon.size()));
    Contour result;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector2d& a = polygon[i];
        const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
        for (int part = 0; part < parts; ++part)
            result.emplace_back(a + (b - a) * (static_cast<double>(part) / parts));
    }
    return result;
}

std::vector<Contour> silhouette_of(const Bodies& bodies,
                                   const geometry::CalibratedCamera& camera,
                                   const SceneOptions& options) {
    if (bodies.parts.size() == 1 && !options.cropped) {
        const ConvexPart& part = bodies.parts.front();
        const int per_ball = std::max(
            8, options.segments_per_view / std::max<int>(1, static_cast<int>(part.balls.size())));
        const Contour outline = projection(part, camera, per_ball);
        return {part.balls.empty() ? subdivided(outline, options.segments_per_view) : outline};
    }
    std::vector<Contour> shapes;
    for (const ConvexPart& part : bodies.parts) shapes.push_back(projection(part, camera, 16));
    constexpr double kFar_px = 1e4;
    PixelBox picture{Eigen::Vector2d::Constant(-kFar_px), Eigen::Vector2d::Constant(kFar_px)};
    if (options.cropped) {
        picture.min.setConstant(-0.5);
        picture.max = {camera.intrinsics.width - 0.5, camera.intrinsics.height - 0.5};
    }
    const int num_cells = std::clamp(options.segments_per_view, 96, 256);
    return outline_of_union(shapes, picture, {options.segments_per_view, num_cells});
}

// Zooms until the bodies leave the picture on some sides.
void crop(geometry::PinholeCamera& intrinsics, Random& random) {
    const double zoom = between(random, 1.0, 1.6);
    intrinsics.fx *= zoom;
    intrinsics.fy *= zoom;
    intrinsics.cx += between(random, -150.0, 150.0);
    intrinsics.cy += between(random, -150.0, 150.0);
}

}  // namespace

SceneOptions random_scene_options(std::uint64_t seed) {
    Random random(seed ^ 0x5ce7e5ULL);
    SceneOptions options;
    options.bodies = static_cast<BodyKind>(between(random, 0, 4));
    options.rig = static_cast<RigKind>(between(random, 0, 6));
    if (chance(random, 0.5))
        options.rig = chance(random, 0.5) ? RigKind::kRing : RigKind::kAnywhere;
    options.num_views = between(random, 3, 8);
    if (chance(random, 0.1)) options.num_views = 2;
    const int most = chance(random, 0.3) ? 150 : 60;
    options.segments_per_view = between(random, 20, most);
    if (chance(random, 0.04)) options.segments_per_view = between(random, 150, 600);
    if (chance(random, 0.05)) {
        options.num_views = between(random, 9, 16);
        options.segments_per_view = between(random, 20, 80);
    }
    if (options.rig == RigKind::kSharedCentre) options.num_views = std::max(options.num_views, 3);
    if (chance(random, 0.4)) options.noise_px = between(random, 0.0, 1.5);
    // scribbles: outlines that cross themselves and each other
    if (chance(random, 0.06)) options.noise_px = between(random, 1.5, 15.0);
    if (chance(random, 0.15)) options.shift_px = between(random, 1.0, 40.0);
    options.cropped = chance(random, 0.2);
    return options;
}

std::vector<hull::SilhouetteView> views_of(const Bodies& bodies,
                                           std::vector<geometry::CalibratedCamera> rig,
                                           const SceneOptions& options,
                                           Random& random) {
    std::vector<hull::SilhouetteView> views;
    for (geometry::CalibratedCamera& camera : rig) {
        if (options.cropped) crop(camera.intrinsics, random);
        std::vector<Contour> contours = silhouette_of(bodies, camera, options);
        const Vector3d shift = random_in_cube(random, 1.0);
        for (Contour& contour : contours) {
            for (Eigen::Vector2d& p : contour) {
                const Vector3d noise = random_in_cube(random, 1.0);
                p += (options.shift_px * shift + options.noise_px * noise).head<2>();
            }
        }
        views.push_back(make_view(camera, std::move(contours)));
    }
    return views;
}

std::vector<hull::SilhouetteView> make_scene(const SceneOptions& options, std::uint64_t seed) {
    Random random(seed);
    const Bodies bodies = make_bodies(options.bodies, random);
    auto rig = make_scene_rig(options.rig, options.num_views, bodies, random);
    return views_of(bodies, std::move(rig), options, random);
}

std::string describe(const SceneOptions& options, std::uint64_t seed) {
    constexpr std::array<const char*, 5> kBodies{"people", "balls", "boxes", "rods", "mixed"};
    constexpr std::array<const char*, 7> kRigs{"ring",
                                               "anywhere",
                                               "collinear",
                                               "opposite",
                                               "coplanar",
                                               "behind each other",
                                               "shared centre"};
    return "seed " + std::to_string(seed) + ": " +
           kBodies[static_cast<std::size_t>(options.bodies)] + ", " +
           kRigs[static_cast<std::size_t>(options.rig)] + ", " + std::to_string(options.num_views) +
           " views of " + std::to_string(options.segments_per_view) + " segments, noise " +
           std::to_string(options.noise_px) + " px, shift " + std::to_string(options.shift_px) +
           " px" + (options.cropped ? ", cropped" : "");
}

}  // namespace atrium::test
