#include "viewer/control/follow_camera.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

namespace atrium::viewer {
namespace {

constexpr float kHeadM = 0.25F;
constexpr float kHeadWidthM = 0.4F;      // what is wider has an arm beside it
constexpr double kTopSmoothingS = 0.12;  // smooths the flicker of a hull's top

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

struct Box {
    Eigen::Vector3f low;
    Eigen::Vector3f high;
};

// Box of the vertices that `counts`. Empty: none does.
template <class Counts>
std::optional<Box> box_of(std::span<const Eigen::Vector3f> vertices, const Counts& counts) {
    std::optional<Box> box;
    for (const Eigen::Vector3f& v : vertices) {
        if (!counts(v)) continue;
        if (!box) box = Box{v, v};
        box->low = box->low.cwiseMin(v);
        box->high = box->high.cwiseMax(v);
    }
    return box;
}

// The vertical line through the middle of the body, which raised arms hardly move.
Eigen::Vector2f axis_of(std::span<const Eigen::Vector3f> vertices) {
    std::vector<float> values(vertices.size());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    Eigen::Vector2f axis;
    for (const int i : {0, 1}) {
        std::ranges::transform(vertices, values.begin(), [i](const auto& v) { return v[i]; });
        std::nth_element(values.begin(), middle, values.end());
        axis[i] = *middle;
    }
    return axis;
}

Box head_of(std::span<const Eigen::Vector3f> vertices, float top) {
    const auto in_head = [](float of) {
        return [of](const Eigen::Vector3f& v) { return v.z() >= of - kHeadM; };
    };
    const Box head = *box_of(vertices, in_head(top));
    if ((head.high - head.low).head<2>().maxCoeff() <= kHeadWidthM) return head;
    // about the body's axis, then about the head that was found there
    Box found = head;
    Eigen::Vector2f axis = axis_of(vertices);
    for (int pass = 0; pass < 2; ++pass) {
        const auto is_near = [&](const Eigen::Vector3f& v) {
            return (v.head<2>() - axis).norm() <= 0.5F * kHeadWidthM;
        };
        const auto near = box_of(vertices, is_near);
        if (!near || near->high.z() < top - kHeadM) return found;
        found = *box_of(vertices, [&](const Eigen::Vector3f& v) {
            return is_near(v) && in_head(near->high.z())(v);
        });
        axis = 0.5F * (found.low + found.high).head<2>();
    }
    return found;
}

}  // namespace

PersonPlace place_of(std::span<const Eigen::Vector3f> vertices) {
    const Box all = *box_of(vertices, [](const Eigen::Vector3f&) { return true; });
    const Box head = head_of(vertices, all.high.z());
    PersonPlace place;
    place.middle = (0.5F * (all.low + all.high)).cast<double>();
    place.size = (all.high - all.low).cast<double>();
    place.eyes = (0.5F * (head.low + head.high)).cast<double>();
    place.top = {place.eyes.x(), place.eyes.y(), static_cast<double>(head.high.z())};
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
        const double share = 1.0 - std::exp(-std::max(passed_s, 0.0) / kTopSmoothingS);
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
