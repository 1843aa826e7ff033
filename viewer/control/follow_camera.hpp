#pragma once

#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace atrium::viewer {

/// Position and size of a person [m].
struct PersonPlace {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // centre of the bounding box
    Eigen::Vector3d eyes = Eigen::Vector3d::Zero();    // centre of the head
    Eigen::Vector3d top = Eigen::Vector3d::Zero();     // top of the head
    /// Extents of the bounding box along the site's axes.
    Eigen::Vector3d size = Eigen::Vector3d::Zero();
    /// Where the site's +X points, a unit vector: its people face there. Zero: the site has no
    /// place in the world.
    Eigen::Vector3d front = Eigen::Vector3d::Zero();
};

/// Computes the place of a person from the vertices of a mesh that is not empty; +Z is up. The head
/// is the part within 25 cm below the top; of a wider part, as with a raised arm, what is near the
/// body's axis.
PersonPlace place_of(std::span<const Eigen::Vector3f> vertices);

/// Moves the viewpoint with a person: follows the person, or looks through the person's eyes. A
/// hull does not show where the person looks, so the view begins towards the nearest other person,
/// else the nearest thing, and the mouse chooses the direction.
class FollowCamera {
public:
    using Clock = std::chrono::steady_clock;
    using Places = std::map<std::string, PersonPlace>;  // all people, in the world frame

    /// Follows the person nearest to the camera's target, or stops following.
    void toggle_follow(const renderer::ViewCamera& camera, const Places& places);
    /// Looks through the eyes of person `number`, counted from 1 in the order of the names. The
    /// same number again, or a number without a person, leaves the person: the next `update`
    /// returns to the viewpoint before the first person was entered. `things`: where to look if the
    /// person is alone [m, world].
    void toggle_first_person(std::size_t number,
                             const Places& places,
                             std::span<const Eigen::Vector3d> things = {});
    /// Like `toggle_first_person` with the same number. Does nothing outside of eyes.
    void leave_eyes() {
        if (is_first_person()) toggle_first_person(0, {});
    }
    /// Leaves the person. The camera stays where it is.
    void leave() {
        name_.clear();
        before_.reset();
        returns_ = false;
    }

    bool is_first_person() const { return !name_.empty() && is_inside_; }
    const std::string& name() const { return name_; }  // empty: nobody

    /// Returns the camera after the person has moved. Leaves a person who is gone.
    renderer::ViewCamera update(renderer::ViewCamera camera,
                                const Places& places,
                                Clock::time_point now);

private:
    void drop();

    std::string name_;
    bool is_inside_ = false;
    std::optional<Eigen::Vector3d> to_thing_;     // from the eyes, at the moment of entering
    std::optional<renderer::ViewCamera> before_;  // the camera outside, while in the eyes
    bool returns_ = false;                        // the next update returns to `before_`
    std::optional<Eigen::Vector3d> at_;           // smoothed position that the camera follows
    Clock::time_point time_;
};

}  // namespace atrium::viewer
