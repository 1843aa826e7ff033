#include "simulation/wand_room.hpp"

#include "simulation/hash.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

namespace atrium::simulation {
namespace {

constexpr double kDark_lsb = 10.0;     // of the dark room
constexpr double kPeak_lsb = 320.0;    // of a light at rest: the nearest ones saturate
constexpr double kLight_m = 0.006;     // radius of a light
constexpr double kLens_px = 0.9;       // blur of the lens, standard deviation
constexpr double kNearest_m = 0.3;     // from the camera
constexpr double kReach_sigmas = 4.5;  // how far a light is drawn
constexpr double kStep_sigmas = 0.5;   // between the places of a light in motion
constexpr int kMostSteps = 256;
constexpr double kLongestSpan_m = 4.0;  // of the sweep, however large the bounds are

// Adds amounts of light, which the sensor rounds and limits.
class Canvas {
public:
    explicit Canvas(image::Plane& plane) : plane_(plane) {}

    void add(int x, int y, double lsb) {
        if (x < 0 || y < 0 || x >= plane_.width || y >= plane_.height) return;
        std::uint8_t& pixel = plane_.row(y)[x];
        pixel = static_cast<std::uint8_t>(std::clamp(std::round(pixel + lsb), 0.0, 255.0));
    }

    // A bright area with soft edges, as of a lamp or a window.
    void add_area(const Eigen::Vector2d& centre, const Eigen::Vector2d& half, double lsb) {
        for (int y = static_cast<int>(centre.y() - 2 * half.y());
             y <= static_cast<int>(centre.y() + 2 * half.y());
             ++y) {
            for (int x = static_cast<int>(centre.x() - 2 * half.x());
                 x <= static_cast<int>(centre.x() + 2 * half.x());
                 ++x) {
                const double r = (Eigen::Vector2d(x, y) - centre).cwiseQuotient(half).lpNorm<4>();
                add(x, y, lsb / (1.0 + std::exp(12.0 * (r - 1.0))));
            }
        }
    }

    void add_spot(const Eigen::Vector2d& centre, double sigma_px, double lsb) {
        const double reach = kReach_sigmas * sigma_px;
        for (int y = static_cast<int>(std::floor(centre.y() - reach)); y <= centre.y() + reach; ++y)
            for (int x = static_cast<int>(std::floor(centre.x() - reach)); x <= centre.x() + reach;
                 ++x)
                add(x,
                    y,
                    lsb * std::exp(-0.5 * (Eigen::Vector2d(x, y) - centre).squaredNorm() /
                                   (sigma_px * sigma_px)));
    }

private:
    image::Plane& plane_;
};

// On the floor, at one of three places that no line joins.
geometry::RigidTransform lying_wand(double time_s) {
    constexpr double kRest_s = 4.0;
    constexpr std::array<std::array<double, 3>, 3> kPlaces{
        {{0.0, 0.0, 0.0}, {0.3, 0.7, 1.0}, {-0.7, -0.2, 2.3}}};  // x, y [m], yaw [rad]
    const auto& [x, y, yaw] =
        kPlaces[static_cast<std::size_t>(std::max(0.0, time_s) / kRest_s) % kPlaces.size()];
    geometry::RigidTransform pose;
    pose.rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
    pose.translation = {x, y, 0.0};
    return pose;
}

std::optional<Eigen::Vector2d> seen_at(const geometry::CalibratedCamera& camera,
                                       const Eigen::Vector3d& p_site) {
    const Eigen::Vector3d p = camera.camera_from_site * p_site;
    if (p.z() < kNearest_m) return std::nullopt;
    const geometry::PinholeCamera& lens = camera.intrinsics;
    const Eigen::Vector2d plain = lens.project(p);
    // far outside, the polynomials of the lens come back into the picture
    const Eigen::Array2d size(lens.width, lens.height);
    if ((plain.array() < -0.5 * size).any() || (plain.array() > 1.5 * size).any())
        return std::nullopt;
    return lens.distort(plain);
}

}  // namespace

std::vector<Eigen::Vector3d> lights_of_wand() {
    return {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, {0.3, 0.0, 0.0}, {0.6, 0.0, 0.0}};
}

WandRoom::WandRoom(const config::Rig& rig, const WandRoomOptions& options)
    : cameras_(rig.cameras),
      bounds_site_(rig.bounds_site),
      options_(options),
      noise_(options.noise_lsb, options.seed) {
    std::mt19937_64 rng(hash_of(options.seed, 0));
    std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
    for (int i = 0; i < 9; ++i) phases_rad_.push_back(turn(rng));
    for (const geometry::CalibratedCamera& camera : cameras_) {
        const auto first =
            std::ranges::find(cameras_, camera.name, &geometry::CalibratedCamera::name);
        const auto number = static_cast<std::uint64_t>(first - cameras_.begin()) + 1;
        scenery_.push_back(scenery(camera.intrinsics, hash_of(options.seed, number)));
    }
}

// One lamp, two reflections of it that look like lights, and four hot pixels.
image::Plane WandRoom::scenery(const geometry::PinholeCamera& lens, std::uint64_t seed) const {
    std::mt19937_64 rng(seed);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    image::Plane plane(
        lens.width & ~1, lens.height & ~1, static_cast<std::uint8_t>(std::lround(kDark_lsb)));
    Canvas canvas(plane);
    const auto place = [&] {
        const double x = any(rng);  // in this order with every compiler
        return Eigen::Vector2d(x * plane.width, any(rng) * plane.height);
    };
    const Eigen::Vector2d lamp(any(rng) * plane.width, 0.15 * any(rng) * plane.height);
    const double wide = 0.02 + 0.03 * any(rng);
    canvas.add_area(lamp, {wide * plane.width, (0.02 + 0.02 * any(rng)) * plane.width}, 230.0);
    for (int i = 0; i < 2; ++i) {
        const Eigen::Vector2d at = place();
        canvas.add_spot(at, 1.2 + any(rng), 60.0 + 100.0 * any(rng));
    }
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d at = place();
        canvas.add(static_cast<int>(at.x()), static_cast<int>(at.y()), 200.0);
    }
    return plane;
}

geometry::RigidTransform WandRoom::site_from_wand(double time_s) const {
    if (options_.lies) return lying_wand(time_s);
    const auto wave = [&](std::size_t k, double hz) {
        return std::sin(2.0 * std::numbers::pi * hz * time_s + phases_rad_[k]);
    };
    const Eigen::Vector3d half =
        0.5 * bounds_site_.size().cwiseMin(kLongestSpan_m).cwiseMax(lights_of_wand().back().x());
    const Eigen::Vector3d centre = 0.5 * (bounds_site_.min + bounds_site_.max);
    geometry::RigidTransform pose;
    pose.rotation = Eigen::AngleAxisd(2.0 * wave(6, 0.11) + time_s, Eigen::Vector3d::UnitZ()) *
                    Eigen::AngleAxisd(1.3 * wave(7, 0.29), Eigen::Vector3d::UnitY()) *
                    Eigen::AngleAxisd(2.0 * wave(8, 0.19), Eigen::Vector3d::UnitX());
    const Eigen::Vector3d middle =
        centre + half.cwiseProduct(Eigen::Vector3d(0.7 * wave(0, 0.17) + 0.3 * wave(1, 0.41),
                                                   0.7 * wave(2, 0.13) + 0.3 * wave(3, 0.37),
                                                   0.65 * wave(4, 0.23) + 0.25 * wave(5, 0.47)));
    pose.translation = middle - pose.rotation * (0.5 * lights_of_wand().back());
    return pose;
}

std::vector<std::optional<Eigen::Vector2d>> WandRoom::lights_px(double time_s,
                                                                std::size_t camera) const {
    const geometry::RigidTransform pose = site_from_wand(time_s);
    const image::Plane& picture = scenery_[camera];
    std::vector<std::optional<Eigen::Vector2d>> places;
    for (const Eigen::Vector3d& light : lights_of_wand()) {
        auto at = seen_at(cameras_[camera], pose * light);
        if (at && !(at->x() >= 0.0 && at->y() >= 0.0 && at->x() <= picture.width - 1 &&
                    at->y() <= picture.height - 1))
            at.reset();
        places.push_back(at);
    }
    return places;
}

bool WandRoom::is_lost(double time_s, std::size_t camera) const {
    const std::uint64_t drawn =
        hash_of(hash_of(options_.seed, 1000 + camera), microseconds(time_s));
    return static_cast<double>(drawn >> 11) * 0x1p-53 < 0.01 * options_.lost_percent;
}

void WandRoom::draw_light(double time_s,
                          const geometry::CalibratedCamera& camera,
                          const Eigen::Vector3d& p_wand,
                          image::Plane& out) const {
    const auto at = [&](double share) {
        const double t = time_s + share * 1e-3 * options_.exposure_ms;
        return seen_at(camera, site_from_wand(t) * p_wand);
    };
    const auto first = at(-0.5), last = at(0.5);
    if (!first || !last) return;
    const double depth_m = (camera.camera_from_site * (site_from_wand(time_s) * p_wand)).z();
    // a disc of radius r spreads as much as a Gaussian of r / 2
    const double radius_px = camera.intrinsics.fx * kLight_m / depth_m;
    const double sigma_px = std::hypot(kLens_px, 0.5 * radius_px);
    const int num_steps =
        std::clamp(static_cast<int>(std::ceil((*last - *first).norm() / (kStep_sigmas * sigma_px))),
                   1,
                   kMostSteps);
    // summed before rounding
    const double reach = kReach_sigmas * sigma_px;
    std::vector<Eigen::Vector2d> places;
    Eigen::Array2d low = *first, high = *first;
    for (int k = 0; k < num_steps; ++k) {
        const auto place = at((k + 0.5) / num_steps - 0.5);
        if (!place) return;
        places.push_back(*place);
        low = low.min(place->array());
        high = high.max(place->array());
    }
    Canvas canvas(out);
    const double each = kPeak_lsb / num_steps;
    for (int y = static_cast<int>(std::floor(low.y() - reach)); y <= high.y() + reach; ++y) {
        for (int x = static_cast<int>(std::floor(low.x() - reach)); x <= high.x() + reach; ++x) {
            double lsb = 0.0;
            for (const Eigen::Vector2d& place : places)
                lsb += each * std::exp(-0.5 * (Eigen::Vector2d(x, y) - place).squaredNorm() /
                                       (sigma_px * sigma_px));
            canvas.add(x, y, lsb);
        }
    }
}

void WandRoom::render(double time_s, std::size_t camera, image::Plane& out) const {
    out = scenery_[camera];
    for (const Eigen::Vector3d& light : lights_of_wand())
        draw_light(time_s, cameras_[camera], light, out);
    add_noise(hash_of(microseconds(time_s), camera), out);
}

void WandRoom::render_empty(std::uint64_t shot, std::size_t camera, image::Plane& out) const {
    out = scenery_[camera];
    add_noise(hash_of(~shot, camera), out);
}

void WandRoom::add_noise(std::uint64_t picture, image::Plane& out) const {
    for (int y = 0; y < out.height; ++y)
        noise_.add(picture, y, std::span(out.row(y), static_cast<std::size_t>(out.width)));
}

}  // namespace atrium::simulation
