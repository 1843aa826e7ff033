#include "tests/fuzz/hull_input.hpp"

#include "tests/fuzz/byte_reader.hpp"
#include "tests/support/shapes/rig_maker.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::test {
namespace {

using Contour = std::vector<Eigen::Vector2d>;

// Repeatable noise in [0, 1) from few bytes.
class Noise {
public:
    explicit Noise(std::uint32_t seed) : state_(seed * 2654435761u + 1u) {}
    double operator()() {
        state_ = state_ * 1664525u + 1013904223u;
        return static_cast<double>(state_ >> 8) / 16777216.0;
    }

private:
    std::uint32_t state_;
};

constexpr double kMiddle_px = 499.5;

Eigen::Vector2d on_circle(double turn, double radius_px) {
    return {kMiddle_px + radius_px * std::cos(2.0 * std::numbers::pi * turn),
            kMiddle_px + radius_px * std::sin(2.0 * std::numbers::pi * turn)};
}

Contour star(ByteReader& reader, int num_points, bool with_spikes) {
    const double radius_px = reader.between(1.0, 400.0);
    const double depth = reader.between(0.0, 1.0);
    const Eigen::Vector2d shift(reader.between(-300.0, 300.0), reader.between(-300.0, 300.0));
    Noise noise(reader.word());
    Contour contour;
    for (int i = 0; i < num_points; ++i) {
        const double share = 1.0 - depth * (with_spikes ? i % 2 : noise());
        const double turn = (i + (with_spikes ? 0.0 : 0.5 * noise())) / num_points;
        contour.emplace_back(on_circle(turn, share * radius_px) + shift);
        if (with_spikes && i % 5 == 0) contour.push_back(contour.back());  // a repeated point
    }
    return contour;
}

// Many more points than bytes: walks that cross themselves.
Contour scribble(ByteReader& reader, int num_points) {
    const double step_px = reader.between(0.01, 200.0);
    Noise noise(reader.word());
    Contour contour;
    Eigen::Vector2d p(kMiddle_px, kMiddle_px);
    for (int i = 0; i < num_points; ++i) {
        p.x() += step_px * (noise() - 0.5);
        p.y() += step_px * (noise() - 0.5);
        contour.push_back(p);
    }
    return contour;
}

Contour decode_contour(ByteReader& reader, const Contour& former) {
    Contour contour;
    const int kind = reader.below(9);
    const int count = reader.byte();
    switch (kind) {
        case 0:  // point by point
            for (int i = 0; i < count % 40; ++i) {
                const double x = reader.between(0.0, 1000.0);
                contour.emplace_back(x, reader.between(0.0, 1000.0));
            }
            break;
        case 1:  // on a lattice: it touches and repeats itself
            for (int i = 0; i < count % 64; ++i) {
                const int cell = reader.byte();
                contour.emplace_back(50.0 * (cell / 16) + 100.0, 50.0 * (cell % 16) + 100.0);
            }
            break;
        case 2:
            return star(reader, count, false);
        case 3:
            return star(reader, count, true);
        case 4: {  // the previous contour again, shifted slightly or not at all
            const double shift_px = 0.25 * (count - 128);
            contour = former;
            for (Eigen::Vector2d& p : contour) p.x() += shift_px;
            break;
        }
        case 5:  // hardly larger than rounding
            for (int i = 0; i < count % 40; ++i) {
                const double x = 500.0 + 1e-7 * reader.byte();
                contour.emplace_back(x, 500.0 + 1e-7 * reader.byte());
            }
            break;
        case 6:  // non-finite numbers, rarely: a single one spoils the whole input
            if (count % 4 != 0) return star(reader, count, false);
            for (int i = 0; i < count % 10; ++i) {
                const double x = reader.hostile();
                contour.emplace_back(x, reader.hostile());
            }
            break;
        case 7:
            return scribble(reader, 12 * count);
        default:  // regular, the same in all views: several cameras see the same edges
            for (int i = 0; i < count % 32; ++i)
                contour.push_back(on_circle(static_cast<double>(i) / (count % 32), 150.0));
            break;
    }
    return contour;
}

geometry::RigidTransform decode_pose(ByteReader& reader,
                                     const std::vector<hull::SilhouetteView>& former) {
    const Eigen::Vector3d target(0.0, 0.0, 0.9);
    const int kind = reader.below(16);
    const double turn = 2.0 * std::numbers::pi * reader.byte() / 16.0;
    if (kind == 0 && !former.empty()) {  // at the same place, turned
        const geometry::RigidTransform turned_from_camera{
            Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * turn, Eigen::Vector3d::UnitY())),
            Eigen::Vector3d::Zero()};
        return turned_from_camera * former.back().camera_from_site;
    }
    if (kind == 1 && !former.empty()) {  // opposite, or behind on the same axis
        const Eigen::Vector3d centre = former.back().camera_from_site.inverse().translation;
        const double share = reader.below(2) == 0 ? -1.0 : 1.5;
        return look_at(target + share * (centre - target), target);
    }
    if (kind == 2) {
        geometry::RigidTransform pose;
        for (int i = 0; i < 4; ++i) pose.rotation.coeffs()[i] = reader.hostile();
        for (int i = 0; i < 3; ++i) pose.translation[i] = reader.hostile();
        return pose;
    }
    if (kind == 3) {  // anywhere, even inside the bodies
        Eigen::Vector3d centre;
        for (int i = 0; i < 3; ++i) centre[i] = reader.between(-4.0, 4.0);
        return look_at(centre + Eigen::Vector3d(1e-3, 0.0, 0.0), target);
    }
    const double height_m = 0.9 + 0.5 * reader.below(4);
    return look_at({3.0 * std::cos(turn), 3.0 * std::sin(turn), height_m}, target);
}

geometry::PinholeCamera decode_intrinsics(ByteReader& reader) {
    geometry::PinholeCamera camera{1000, 1000, 1300.0, 1300.0, kMiddle_px, kMiddle_px};
    const int kind = reader.below(16);
    if (kind == 0) {
        for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &camera.skew})
            *value = reader.hostile();
    } else if (kind == 1) {
        camera.fx = reader.between(0.01, 10'000.0);
        camera.skew = reader.between(-1000.0, 1000.0);
    }
    return camera;
}

Contour decode_field(ByteReader& reader) {
    switch (reader.below(16)) {
        case 0: {
            const double margin_px = reader.between(-100.0, 600.0);
            const double far_px = 999.0 - margin_px;
            return {
                {margin_px, margin_px}, {far_px, margin_px}, {far_px, far_px}, {margin_px, far_px}};
        }
        case 1:
            return decode_contour(reader, {});
        default:
            return {};
    }
}

void decode_options(ByteReader& reader, hull::HullOptions& options) {
    const int flags = reader.byte();
    options.keep_phantoms = (flags & 1) != 0;
    options.max_segments = (flags & 2) != 0 ? 300 : (flags & 16) != 0 ? 3000 : 1000;
    options.max_steps = (flags & 4) != 0 ? 1'000 : 2'000'000;
    options.min_contour_area_px2 = (flags & 8) != 0 ? 0.0 : 1e-2;
    options.min_views = static_cast<std::uint32_t>(reader.below(4));
    const int kind = reader.below(6);
    if (kind == 1) options.bounds = {Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, 1, 2)};
    if (kind == 2) options.bounds = geometry::Aabb{};  // empty
    if (kind == 3) {
        options.bounds.emplace();
        for (int i = 0; i < 3; ++i) options.bounds->min[i] = reader.hostile();
        for (int i = 0; i < 3; ++i) options.bounds->max[i] = reader.hostile();
    }
    if (kind == 4) {
        options.bounds.emplace();
        for (int i = 0; i < 3; ++i)
            options.bounds->add(Eigen::Vector3d::Constant(reader.between(-4.0, 4.0)));
    }
}

}  // namespace

HullInput decode_hull_input(std::span<const std::uint8_t> bytes) {
    ByteReader reader(bytes);
    HullInput input;
    decode_options(reader, input.options);
    const int num_views = 2 + reader.below(7);
    for (int v = 0; v < num_views; ++v) {
        hull::SilhouetteView view;
        view.camera_from_site = decode_pose(reader, input.views);
        view.intrinsics = decode_intrinsics(reader);
        view.field = decode_field(reader);
        Contour former;
        for (int contours = reader.below(5); contours > 0; --contours) {
            former = decode_contour(reader, former);
            view.contours.push_back(former);
        }
        if (view.contours.empty() && !input.views.empty())
            view.contours = input.views.front().contours;
        input.views.push_back(std::move(view));
    }
    return input;
}

}  // namespace atrium::test
