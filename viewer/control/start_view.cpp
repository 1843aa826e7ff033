#include "viewer/control/start_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace atrium::viewer {
namespace {

constexpr double kFilledShare = 0.8;  // share of the picture's width and height
constexpr double kStandingM = 2.0;    // a person of whom the first mesh may be a part
constexpr double kLowestEyeM = 0.3;
// From the front towards the usual side: straight ahead the site opposite would be at the eye.
constexpr double kAside = std::numbers::pi / 6.0;
constexpr double kFrontsAgree = 0.5;  // length of the mean of unit vectors
// Sides that are tried if something hides the people, at these angles above the floor.
constexpr int kNumSides = 12;
constexpr double kRaised = 0.7, kSteep = 1.2;
constexpr double kFromWallM = 0.2;
constexpr double kClearlyFurtherM = 0.3;  // else the side nearer to the preferred one
constexpr std::chrono::seconds kForModels{5};

// From the people to the eye, a unit vector.
Eigen::Vector3d towards_eye(const FollowCamera::Places& people, const renderer::ViewCamera& usual) {
    const Eigen::Vector3d usual_side = (usual.position_m - usual.target_m).normalized();
    Eigen::Vector3d front = Eigen::Vector3d::Zero();
    for (const auto& [name, place] : people) front += place.front;
    front.z() = 0.0;
    if (front.norm() < kFrontsAgree * static_cast<double>(people.size())) return usual_side;
    const double level = std::hypot(usual_side.x(), usual_side.y());
    const double sense = front.cross(usual_side).z() < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d ahead =
        Eigen::AngleAxisd(sense * kAside, Eigen::Vector3d::UnitZ()) * front.normalized();
    return {level * ahead.x(), level * ahead.y(), usual_side.z()};
}

// All these people in the picture, from `to_eye`, a unit vector.
renderer::ViewCamera view_from(const Eigen::Vector3d& to_eye,
                               const FollowCamera::Places& people,
                               const renderer::ViewCamera& usual,
                               double aspect) {
    // upright boxes around the people, wide enough for each direction of their sites
    Eigen::AlignedBox3d bounds;
    for (const auto& [name, place] : people) {
        const double radius = 0.5 * std::hypot(place.size.x(), place.size.y());
        const Eigen::Vector3d half(radius, radius, 0.5 * place.size.z());
        bounds.extend(place.middle - half);
        bounds.extend(place.middle + half);
    }
    renderer::ViewCamera camera = usual;
    camera.target_m = bounds.center();
    Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(to_eye);
    right = right.norm() > 1e-6 ? right.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    const Eigen::Vector3d up = to_eye.cross(right);
    const double tall = kFilledShare * std::tan(usual.fov_deg * std::numbers::pi / 360.0);
    const double wide = tall * aspect;
    double distance = 0.5 * kStandingM / tall;
    for (const auto& [name, place] : people) {
        const double radius = 0.5 * std::hypot(place.size.x(), place.size.y());
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d corner(
                (i & 1) != 0 ? radius : -radius,
                (i & 2) != 0 ? radius : -radius,
                (i & 4) != 0 ? 0.5 * place.size.z() : -0.5 * place.size.z());
            const Eigen::Vector3d p = place.middle + corner - camera.target_m;
            distance = std::max({distance,
                                 std::abs(p.dot(right)) / wide + p.dot(to_eye),
                                 std::abs(p.dot(up)) / tall + p.dot(to_eye)});
        }
    }
    camera.position_m = camera.target_m + distance * to_eye;
    camera.position_m.z() = std::max(camera.position_m.z(), kLowestEyeM);
    return camera;
}

// Whether nothing hides more of the head, the middle and the knees of anybody than `most_hidden`.
bool is_free(const renderer::ViewCamera& camera,
             const FollowCamera::Places& people,
             const std::function<double(const Ray&)>& free_m,
             int most_hidden) {
    return std::ranges::all_of(people, [&](const auto& person) {
        const PersonPlace& place = person.second;
        const Eigen::Vector3d knees =
            place.middle - 0.25 * place.size.z() * Eigen::Vector3d::UnitZ();
        const auto num_hidden = std::ranges::count_if(
            std::array{place.eyes, place.middle, knees}, [&](const Eigen::Vector3d& at) {
                const Eigen::Vector3d way = camera.position_m - at;
                return free_m({at, way.normalized()}) < way.norm();
            });
        return num_hidden <= most_hidden;
    });
}

bool is_free_of_fixed(const renderer::ViewCamera& camera,
                      const FollowCamera::Places& people,
                      const Sight& sight) {
    return is_free(camera, people, sight.free_m, 0);
}

// A ball before somebody's knees is no reason to go elsewhere.
bool is_free_of_all(const renderer::ViewCamera& camera,
                    const FollowCamera::Places& people,
                    const Sight& sight) {
    return is_free_of_fixed(camera, people, sight) &&
           is_free(camera, people, sight.free_of_loose_m, 1);
}

// `to_eye` turned about the vertical, and raised to an angle above the floor.
Eigen::Vector3d turned(const Eigen::Vector3d& to_eye, double turn_rad, double up_rad) {
    Eigen::Vector3d level(to_eye.x(), to_eye.y(), 0.0);
    level = level.norm() > 1e-6 ? level.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitX());
    level = Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()) * level;
    return std::cos(up_rad) * level + std::sin(up_rad) * Eigen::Vector3d::UnitZ();
}

}  // namespace

renderer::ViewCamera view_of_people(const FollowCamera::Places& people,
                                    const renderer::ViewCamera& usual,
                                    double aspect,
                                    const Sight& sight) {
    const Eigen::Vector3d preferred = towards_eye(people, usual);
    const renderer::ViewCamera first = view_from(preferred, people, usual, aspect);
    if (is_free_of_all(first, people, sight)) return first;
    const double usual_up = std::asin(std::clamp(preferred.z(), -1.0, 1.0));
    std::vector<Eigen::Vector3d> sides;  // the nearest to the preferred one first
    for (const double up : {usual_up, kRaised, kSteep}) {
        for (int i = 0; i < kNumSides; ++i) {
            const int steps = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
            const double turn_rad = 2.0 * std::numbers::pi * steps / kNumSides;
            sides.push_back(turned(preferred, turn_rad, std::max(up, usual_up)));
        }
    }
    for (const auto& is_free_of : {is_free_of_all, is_free_of_fixed}) {
        for (const Eigen::Vector3d& side : sides) {
            const renderer::ViewCamera camera = view_from(side, people, usual, aspect);
            if (is_free_of(camera, people, sight)) return camera;
        }
    }
    // from the side on which it is free the furthest
    renderer::ViewCamera nearer = first;
    double furthest_m = 0.0;
    for (int i = 0; i < kNumSides; ++i) {
        const Eigen::Vector3d& side = sides[static_cast<std::size_t>(i)];
        const double free_m = sight.free_m({first.target_m, side}) - kFromWallM;
        if (free_m < furthest_m + kClearlyFurtherM) continue;
        furthest_m = free_m;
        nearer = view_from(side, people, usual, aspect);
        const Eigen::Vector3d way = nearer.position_m - nearer.target_m;
        nearer.position_m = nearer.target_m + std::min(free_m, way.norm()) * way.normalized();
    }
    return nearer;
}

renderer::ViewCamera StartView::choose(const FollowCamera::Places& people,
                                       double aspect,
                                       const Sight& sight) {
    seen_revision_ = sight.revision;
    return view_of_people(people, usual_, aspect, sight);
}

std::optional<renderer::ViewCamera> StartView::update(const FollowCamera::Places& people,
                                                      double aspect,
                                                      const Sight& sight,
                                                      Clock::time_point now) {
    if (!is_wanted_) return std::nullopt;
    // nobody is left of those whom the picture shows: others begin anew
    const bool is_left = std::ranges::none_of(
        framed_, [&](const auto& framed) { return people.contains(framed.first); });
    if (is_left && !people.empty()) framed_.clear();
    const auto has_place = [](const PersonPlace& place) { return !place.front.isZero(); };
    if (framed_.empty()) {
        if (people.empty() || people.size() < num_people_) {
            came_at_.reset();
            return std::nullopt;
        }
        if (!came_at_) came_at_ = now;
        if (!sight.is_complete && now < *came_at_ + kForModels) return std::nullopt;
        for (const auto& [name, place] : people) framed_[name] = has_place(place);
        return choose(people, aspect, sight);
    }
    FollowCamera::Places still_here;
    bool is_moved = false;
    for (auto& [name, had_place] : framed_) {
        const auto person = people.find(name);
        if (person == people.end()) continue;
        still_here.insert(*person);
        is_moved = is_moved || (!had_place && has_place(person->second));
        had_place = has_place(person->second);
    }
    const bool has_more = sight.revision != seen_revision_ && sight.is_complete && came_at_ &&
                          now < *came_at_ + kForModels;
    return is_moved || has_more ? std::optional(choose(still_here, aspect, sight)) : std::nullopt;
}

}  // namespace atrium::viewer
