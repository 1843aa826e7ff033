#include "viewer/control/start_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::viewer {
namespace {

constexpr double kFilledShare = 0.8;  // share of the picture's width and height
constexpr double kStandingM = 2.0;    // a person of whom the first mesh may be a part
constexpr double kLowestEyeM = 0.3;
// From the front towards the usual side: straight ahead the site opposite would be at the eye.
constexpr double kAside = std::numbers::pi / 6.0;
constexpr double kFrontsAgree = 0.5;  // length of the mean of unit vectors

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

}  // namespace

renderer::ViewCamera view_of_people(const FollowCamera::Places& people,
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
    const Eigen::Vector3d to_eye = towards_eye(people, usual);
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

std::optional<renderer::ViewCamera> StartView::update(const FollowCamera::Places& people,
                                                      double aspect) {
    if (!is_wanted_) return std::nullopt;
    // nobody is left of those whom the picture shows: others begin anew
    const bool is_left = std::ranges::none_of(
        framed_, [&](const auto& framed) { return people.contains(framed.first); });
    if (is_left && !people.empty()) framed_.clear();
    const auto has_place = [](const PersonPlace& place) { return !place.front.isZero(); };
    if (framed_.empty()) {
        if (people.empty() || people.size() < num_people_) return std::nullopt;
        for (const auto& [name, place] : people) framed_[name] = has_place(place);
        return view_of_people(people, usual_, aspect);
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
    return is_moved ? std::optional(view_of_people(still_here, usual_, aspect)) : std::nullopt;
}

}  // namespace atrium::viewer
