#include "simulation/room.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace atrium::simulation {
namespace {

using Eigen::Vector3d;

constexpr int kShadowSizePx = 512;

// Returns a hash of a lattice point, 0 to 1.
double lattice_value(int x, int y, int salt) {
    auto h = static_cast<std::uint32_t>(x) * 0x8da6b343u ^
             static_cast<std::uint32_t>(y) * 0xd8163841u ^
             static_cast<std::uint32_t>(salt) * 0xcb1ab31fu;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 12;
    h *= 0x297a2d39u;
    h ^= h >> 15;
    return h / 4294967295.0;
}

// Returns smooth value noise of wavelength one, 0 to 1.
double value_noise(double x, double y, int salt) {
    const double fx = std::floor(x);
    const double fy = std::floor(y);
    const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double tx = smooth(x - fx);
    const double ty = smooth(y - fy);
    const int ix = static_cast<int>(fx);
    const int iy = static_cast<int>(fy);
    const double low = std::lerp(lattice_value(ix, iy, salt), lattice_value(ix + 1, iy, salt), tx);
    const double high =
        std::lerp(lattice_value(ix, iy + 1, salt), lattice_value(ix + 1, iy + 1, salt), tx);
    return std::lerp(low, high, ty);
}

Vector3d planks(double x, double y) {
    constexpr double kPlankM = 0.16;
    const int plank = static_cast<int>(std::floor(x / kPlankM));
    const double tone =
        0.93 + 0.14 * lattice_value(plank, static_cast<int>(std::floor(y / 1.4 + 0.37 * plank)), 1);
    const double grain = 0.96 + 0.08 * value_noise(60.0 * x, 4.0 * y, 2) +
                         0.05 * (value_noise(2.0 * x, 2.0 * y, 3) - 0.5);
    const double across = x / kPlankM - plank;
    const double gap = across < 0.025 || across > 0.975 ? 0.86 : 1.0;
    // lilac, as in a capture room: its hue is far from skin, wood colours and grey clothes, in
    // light and in shadow
    return Vector3d(0.61, 0.50, 0.71) * tone * grain * gap;
}

Vector3d plaster(double along, double z, int wall) {
    if (z < 0.10)
        return Vector3d(0.72, 0.64, 0.82) * (0.97 + 0.06 * value_noise(3.0 * along, 0.0, 9));
    const double blotches = 0.95 + 0.10 * value_noise(1.3 * along, 1.3 * z, 4 + wall);
    const double grain = 0.97 + 0.06 * value_noise(25.0 * along, 25.0 * z, 8);
    const double band = std::abs(z - 1.05) < 0.015 ? 0.88 : 1.0;
    const Vector3d upper(0.67, 0.58, 0.78);
    const Vector3d lower(0.60, 0.50, 0.71);
    return (z > 1.05 ? upper : lower) * blotches * grain * band;
}

Vector3d table_top(double x, double y) {
    const double grain = 0.95 + 0.10 * value_noise(5.0 * x, 70.0 * y, 11);
    return Vector3d(0.82, 0.80, 0.75) * grain;
}

struct Hit {
    Vector3d point;
    Vector3d normal;
    Vector3d albedo;
};

// Returns where a ray enters a box from outside, and sets `normal` to that of the face; nullopt if
// it misses.
std::optional<double> enter(const geometry::Aabb& box,
                            const Vector3d& origin,
                            const Vector3d& ray,
                            Vector3d& normal) {
    double first = 0.0;
    double last = std::numeric_limits<double>::infinity();
    int face = -1;
    for (int axis = 0; axis < 3; ++axis) {
        const double inverse = 1.0 / ray[axis];
        double near = (box.min[axis] - origin[axis]) * inverse;
        double far = (box.max[axis] - origin[axis]) * inverse;
        if (near > far) std::swap(near, far);
        if (near > first) {
            first = near;
            face = axis;
        }
        last = std::min(last, far);
    }
    if (face < 0 || first >= last) return std::nullopt;
    normal = Vector3d::Zero();
    normal[face] = ray[face] > 0.0 ? -1.0 : 1.0;
    return first;
}

Hit hit_walls(const Room& room, const Vector3d& origin, const Vector3d& ray) {
    double distance = std::numeric_limits<double>::infinity();
    int wall = 0;
    for (int axis = 0; axis < 3; ++axis) {
        if (ray[axis] == 0.0) continue;
        const double bound = ray[axis] > 0.0 ? room.walls.max[axis] : room.walls.min[axis];
        const double t = (bound - origin[axis]) / ray[axis];
        if (t < distance) {
            distance = t;
            wall = 2 * axis + (ray[axis] > 0.0 ? 1 : 0);
        }
    }
    Hit hit;
    hit.point = origin + distance * ray;
    const int axis = wall / 2;
    hit.normal = Vector3d::Zero();
    hit.normal[axis] = wall % 2 == 1 ? -1.0 : 1.0;
    if (wall == 4) {
        hit.albedo = planks(hit.point.x(), hit.point.y());
    } else if (wall == 5) {
        hit.albedo = Vector3d::Constant(0.85);
    } else {
        hit.albedo = plaster(hit.point[1 - axis], hit.point.z(), wall);
    }
    return hit;
}

std::optional<Hit> hit_table(const Room& room, const Vector3d& origin, const Vector3d& ray) {
    if (room.table.empty()) return std::nullopt;
    const Vector3d origin_table = room.table_from_site(origin);
    const Vector3d ray_table = room.table_from_site(origin + ray) - origin_table;
    std::optional<Hit> nearest;
    double nearest_distance = std::numeric_limits<double>::infinity();
    for (const geometry::Aabb& box : room.table) {
        Vector3d normal;
        const auto distance = enter(box, origin_table, ray_table, normal);
        if (!distance || *distance >= nearest_distance) continue;
        nearest_distance = *distance;
        const Vector3d p = origin_table + *distance * ray_table;
        nearest =
            Hit{.point = origin + *distance * ray,
                .normal = room.site_from_table(normal) - room.site_from_table(Vector3d::Zero()),
                .albedo = table_top(p.x(), p.y())};
    }
    return nearest;
}

// Returns the lamp's light on a surface, without shadows.
double lamp_light(const Room& room, const Hit& hit) {
    const Vector3d to_lamp = room.lamp - hit.point;
    return kDiffuse * std::max(0.0, hit.normal.dot(to_lamp.normalized()));
}

bool table_shades(const Room& room, const Hit& hit) {
    if (room.table.empty()) return false;
    const Vector3d start = hit.point + 1e-4 * hit.normal;
    const auto blocker = hit_table(room, start, (room.lamp - start).normalized());
    return blocker && (blocker->point - start).norm() < (room.lamp - start).norm();
}

geometry::CalibratedCamera look_at(const Vector3d& eye, const Vector3d& target) {
    Eigen::Matrix3d camera_from_site;
    const Vector3d forwards = (target - eye).normalized();
    const Vector3d right = forwards.cross(Vector3d::UnitZ()).normalized();
    camera_from_site.row(0) = right;
    camera_from_site.row(1) = forwards.cross(right);
    camera_from_site.row(2) = forwards;
    geometry::CalibratedCamera camera;
    camera.name = "lamp";
    camera.camera_from_site.rotation = Eigen::Quaterniond(camera_from_site);
    camera.camera_from_site.translation = -(camera_from_site * eye);
    return camera;
}

}  // namespace

Vector3d Room::table_from_site(const Vector3d& p_site) const {
    const Vector3d d = p_site - table_centre;
    const Vector3d axis_y(-table_axis_x.y(), table_axis_x.x(), 0.0);
    return {d.dot(table_axis_x), d.dot(axis_y), d.z()};
}

Vector3d Room::site_from_table(const Vector3d& p_table) const {
    const Vector3d axis_y(-table_axis_x.y(), table_axis_x.x(), 0.0);
    return table_centre + p_table.x() * table_axis_x + p_table.y() * axis_y +
           p_table.z() * Vector3d::UnitZ();
}

Room make_room(std::span<const geometry::CalibratedCamera> cameras, const RoomOptions& options) {
    Room room;
    room.walls.add(options.position_m + Vector3d(-2.6, -2.6, 0.0));
    room.walls.add(options.position_m + Vector3d(2.6, 2.6, 3.6));
    for (const geometry::CalibratedCamera& camera : cameras) {
        const Vector3d centre = camera.centre_site();
        room.walls.add(centre - Vector3d(0.7, 0.7, 0.0));
        room.walls.add(centre + Vector3d(0.7, 0.7, 0.5));
    }
    room.walls.min.z() = options.position_m.z();
    if (find_motion(options.motion) == Motion::kTableHands) {
        constexpr double kThicknessM = 0.04;
        geometry::Aabb top;
        top.add({-kTableHalfSideM, -kTableHalfSideM, kTableHeightM - kThicknessM});
        top.add({kTableHalfSideM, kTableHalfSideM, kTableHeightM});
        geometry::Aabb foot;
        foot.add({-0.08, -0.08, 0.0});
        foot.add({0.08, 0.08, kTableHeightM - kThicknessM});
        room.table = {top, foot};
        room.table_centre = options.position_m;
        room.table_axis_x = {std::cos(options.heading_rad), std::sin(options.heading_rad), 0.0};
    }
    room.lamp = options.position_m + Vector3d(1.1, 1.5, 3.5);
    // a sphere around the reach of people of 2.5 m
    const Vector3d centre = options.position_m + Vector3d(0.0, 0.0, 1.15);
    const double reach_m = 1.45 + circle_of_people_m(options.num_people);
    room.shadow_camera = look_at(room.lamp, centre);
    const double half_angle = std::asin(reach_m / (room.lamp - centre).norm());
    geometry::PinholeCamera& intrinsics = room.shadow_camera.intrinsics;
    intrinsics.width = intrinsics.height = kShadowSizePx;
    intrinsics.fx = intrinsics.fy = 0.5 * kShadowSizePx / std::tan(half_angle);
    intrinsics.cx = intrinsics.cy = 0.5 * (kShadowSizePx - 1);
    return room;
}

std::vector<Eigen::Vector3f> table_triangles(const Room& room) {
    constexpr int kCuts = 12;
    std::vector<Eigen::Vector3f> corners;
    for (const geometry::Aabb& box : room.table) {
        const Eigen::Vector3d size = box.size();
        for (int face = 0; face < 6; ++face) {
            const int axis = face / 2;
            const auto at = [&](int i, int j) {
                Eigen::Vector3d p = box.min;
                p[axis] += face % 2 == 1 ? size[axis] : 0.0;
                p[(axis + 1) % 3] += size[(axis + 1) % 3] * i / kCuts;
                p[(axis + 2) % 3] += size[(axis + 2) % 3] * j / kCuts;
                return Eigen::Vector3f(room.site_from_table(p).cast<float>());
            };
            for (int i = 0; i < kCuts; ++i) {
                for (int j = 0; j < kCuts; ++j) {
                    for (const auto& [di, dj] : std::array<std::array<int, 2>, 6>{
                             {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}}) {
                        corners.push_back(at(i + di, j + dj));
                    }
                }
            }
        }
    }
    return corners;
}

RoomView view_room(const Room& room,
                   const geometry::PinholeCamera& intrinsics,
                   const geometry::RigidTransform& camera_from_site) {
    const geometry::RigidTransform site_from_camera = camera_from_site.inverse();
    const Vector3d eye = site_from_camera.translation;
    const Eigen::Matrix3d to_site = site_from_camera.rotation.toRotationMatrix();
    const Eigen::Matrix3d to_lamp = room.shadow_camera.camera_from_site.rotation.toRotationMatrix();
    const geometry::PinholeCamera& lamp_camera = room.shadow_camera.intrinsics;
    RoomView view;
    view.width = intrinsics.width;
    view.height = intrinsics.height;
    const auto num_pixels =
        static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    view.bgr.resize(3 * num_pixels);
    view.shadow_index.assign(num_pixels, 0);
    view.shadow_strength.assign(num_pixels, 0);
    std::size_t i = 0;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x, ++i) {
            Vector3d sum = Vector3d::Zero();
            for (int sample = 0; sample < 4; ++sample) {
                const Eigen::Vector2d px(x - 0.25 + 0.5 * (sample & 1),
                                         y - 0.25 + 0.5 * (sample >> 1));
                const Vector3d ray =
                    to_site * intrinsics.ray_camera(intrinsics.undistort(px).value_or(px));
                const auto on_table = hit_table(room, eye, ray);
                const Hit hit = on_table ? *on_table : hit_walls(room, eye, ray);
                const double lamp = table_shades(room, hit) ? 0.0 : lamp_light(room, hit);
                sum += hit.albedo * (kAmbient + lamp);
                if (sample != 0 || lamp == 0.0) continue;
                const Vector3d p_lamp = to_lamp * (hit.point - room.lamp);
                if (p_lamp.z() <= 0.0) continue;
                const Eigen::Vector2d shadow_px = lamp_camera.project(p_lamp);
                const auto column = std::lround(shadow_px.x());
                const auto row = std::lround(shadow_px.y());
                if (column < 0 || row < 0 || column >= lamp_camera.width ||
                    row >= lamp_camera.height)
                    continue;
                view.shadow_index[i] = static_cast<std::uint32_t>(row * lamp_camera.width + column);
                view.shadow_strength[i] =
                    static_cast<std::uint8_t>(std::lround(255.0 * lamp / (kAmbient + lamp)));
            }
            for (int channel = 0; channel < 3; ++channel) {
                const double value = 255.0 * 0.25 * sum[2 - channel];
                view.bgr[3 * i + static_cast<std::size_t>(channel)] =
                    static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l));
            }
        }
    }
    return view;
}

}  // namespace atrium::simulation
