#pragma once

#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace atrium::viewer {

/// Where somebody is [m].
struct PersonPlace {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the bounds
    Eigen::Vector3d eyes = Eigen::Vector3d::Zero();    // in the middle of the head
    Eigen::Vector3d top = Eigen::Vector3d::Zero();     // of the head
    Eigen::Vector3d size = Eigen::Vector3d::Zero();    // of the bounds, along the site's axes
};

/// Of a surface that is not empty; +Z is up. The head is what lies within 25 cm below the top.
PersonPlace place_of(std::span<const Eigen::Vector3f> vertices);

/// Lets the viewpoint go with a person: follows her, or sees through her eyes. Nobody can tell from
/// a hull where she looks: that stays with the mouse.
class Companion {
public:
    using Clock = std::chrono::steady_clock;
    using Places = std::map<std::string, PersonPlace>;  // of all people, in the world

    /// Follows the person nearest to the camera's target, or stops.
    void toggle_follow(const renderer::ViewCamera& camera, const Places& places);
    /// Through the eyes of the person of that number, counted from 1 in the order of the names; the
    /// same number again, or one that nobody has, leaves her.
    void toggle_eyes(std::size_t number, const Places& places);
    void leave() { name_.clear(); }

    bool has_own_eyes() const { return !name_.empty() && is_inside_; }
    const std::string& name() const { return name_; }  // empty: of nobody

    /// The camera after the person has moved on. Leaves her where she is gone.
    renderer::ViewCamera update(renderer::ViewCamera camera,
                                const Places& places,
                                Clock::time_point now);

private:
    std::string name_;
    bool is_inside_ = false;
    std::optional<Eigen::Vector3d> at_;  // where the viewpoint has her: she is followed softly
    Clock::time_point time_;
};

}  // namespace atrium::viewer
