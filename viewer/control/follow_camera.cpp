#include "viewer/control/follow_camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr float kHeadM = 0.25F;
constexpr double kSoftS = 0.12;  // smooths the flicker of a hull's top

// From those eyes to the eyes of the nearest other person. Empty: there is no other.
std::optional<Eigen::Vector3d> way_to_nearest(const std::string& from_name,
                                              const Eigen::Vector3d& from,
                                              const FollowCamera::Places& places) {
    std::optional<Eigen::Vector3d> nearest;
    for (const auto& [name, place] : places) {
        const Eigen::Vector3d way = place.eyes - from;
        if (name != from_name && (!nearest || way.norm() < nearest->norm())) nearest = way;
    }
    return nearest;
}

// The same to the nearest thing, level. Things that the person holds or stands on do not count.
std::optional<Eigen::Vector3d> way_to_nearest_thing(const Eigen::Vector3d& from,
                                                    std::span<const Eigen::Vector3d> things) {
    constexpr double kWithinReachM = 0.4;
    std::optional<Eigen::Vector3d> nearest;
    for (const Eigen::Vector3d& thing : things) {
        const Eigen::Vector3d way(thing.x() - from.x(), thing.y() - from.y(), 0.0);
        if (way.norm() > kWithinReachM && (!nearest || way.norm() < nearest->norm())) nearest = way;
    }
    return nearest;
}

}  // namespace

PersonPlace place_of(std::span<const Eigen::Vector3f> vertices) {
    Eigen::Vector3f low = vertices.front();
    Eigen::Vector3f high = vertices.front();
    for (const Eigen::Vector3f& v : vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    Eigen::Vector3f head_low = high;
    Eigen::Vector3f head_high = low;
    for (const Eigen::Vector3f& v : vertices) {
        if (v.z() < high.z() - kHeadM) continue;
        head_low = head_low.cwiseMin(v);
        head_high = head_high.cwiseMax(v);
    }
    PersonPlace place;
    place.middle = (0.5F * (low + high)).cast<double>();
    place.size = (high - low).cast<double>();
    place.eyes = (0.5F * (head_low + head_high)).cast<double>();
    place.top = {place.eyes.x(), place.eyes.y(), static_cast<double>(high.z())};
    return place;
}

void FollowCamera::toggle_follow(const renderer::ViewCamera& camera, const Places& places) {
    const bool was_following = !name_.empty() && !is_inside_;
    drop();
    at_.reset();
    if (was_following) return;
    is_inside_ = false;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const auto& [name, place] : places) {
        const double distance_m = (place.middle - camera.target_m).norm();
        if (distance_m >= nearest_m) continue;
        nearest_m = distance_m;
        name_ = name;
    }
}

void FollowCamera::toggle_first_person(std::size_t number,
                                       const Places& places,
                                       std::span<const Eigen::Vector3d> things) {
    const std::string before = is_first_person() ? name_ : "";
    drop();
    at_.reset();
    if (number < 1 || number > places.size()) return;
    const auto chosen = std::next(places.begin(), static_cast<std::ptrdiff_t>(number - 1));
    if (chosen->first == before) return;
    name_ = chosen->first;
    is_inside_ = true;
    returns_ = false;  // into other eyes
    to_thing_ = way_to_nearest_thing(chosen->second.eyes, things);
}

void FollowCamera::drop() {
    returns_ = is_first_person() && before_.has_value();
    name_.clear();
}

renderer::ViewCamera FollowCamera::update(renderer::ViewCamera camera,
                                          const Places& places,
                                          Clock::time_point now) {
    const double passed_s = std::chrono::duration<double>(now - time_).count();
    time_ = now;
    if (std::exchange(returns_, false)) camera = *std::exchange(before_, std::nullopt);
    if (name_.empty()) return camera;
    const auto found = places.find(name_);
    if (found == places.end()) {
        leave();
        return camera;
    }
    const Eigen::Vector3d wanted = is_inside_ ? found->second.eyes : found->second.middle;
    if (!at_ && is_inside_) {
        if (!before_) before_ = camera;
        // look horizontally
        Eigen::Vector3d ahead =
            way_to_nearest(name_, wanted, places)
                .value_or(to_thing_.value_or(camera.target_m - camera.position_m));
        ahead.z() = 0.0;
        if (ahead.norm() < 1e-6) ahead = Eigen::Vector3d::UnitY();
        camera.position_m = wanted;
        camera.target_m = wanted + ahead.normalized();
    } else {
        if (!at_) at_ = camera.target_m;
        const double share = 1.0 - std::exp(-std::max(passed_s, 0.0) / kSoftS);
        const Eigen::Vector3d from = is_inside_ ? camera.position_m : *at_;
        const Eigen::Vector3d shift = share * (wanted - from);
        camera.position_m += shift;
        camera.target_m += shift;
        at_ = from + shift;
        return camera;
    }
    at_ = wanted;
    return camera;
}

}  // namespace atrium::viewer
