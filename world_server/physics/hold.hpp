#pragma once

#include "world_server/physics/people_field.hpp"
#include "world_server/physics/person_contact.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace atrium::physics {

/// Keeps what sticks to a person where it sticks.
///
/// Friction carries an object along with the velocity of the surface, and of that velocity a few
/// per cent, in places of it more, are wrong: over a metre an object would slide out of the hands
/// that hold it. So the surface around it is remembered as it lies in the object's frame, and once
/// a mesh registered with the surface as it is by then (point to plane, as Chen and Medioni 1992).
/// What is between both is how far the object has been left behind; that is added to the velocity
/// that friction carries it with. Friction still decides: what the hands let go of slips, and what
/// has slipped is remembered anew.
class Hold {
public:
    /// Once a tick in which the object touches the person, before the contacts are used.
    void update(const ContactMotion& motion,
                const PersonField& person,
                std::span<const PersonContact> contacts,
                const Eigen::Vector3f& surface_turning);
    void forget();

    /// [m/s] and [rad/s], to be added to the motion of the surface.
    Eigen::Vector3f velocity_at(const Eigen::Vector3f& offset) const {
        return velocity_ + turning_.cross(offset);
    }
    const Eigen::Vector3f& turning() const { return turning_; }

private:
    struct Kept {  // of the surface, in the object's frame
        Eigen::Vector3f position;
        Eigen::Vector3f normal;
    };
    struct Offset {  // of the surface from where it was, about the object's centre, world's axes
        Eigen::Vector3f shift = Eigen::Vector3f::Zero();  // [m]
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();   // [rad]
        bool is_sure = false;
    };
    static bool sticks(const ContactMotion& motion,
                       std::span<const PersonContact> contacts,
                       const Eigen::Vector3f& surface_turning);
    /// `behind`: what the object already lags.
    void remember(const ContactMotion& motion,
                  const PersonField& person,
                  std::span<const PersonContact> contacts,
                  const Offset& behind);
    Offset find_offset(const ContactMotion& motion, const PersonField& person) const;

    std::vector<Kept> kept_;
    Offset last_;
    std::size_t num_loose_ = 0;  // ticks in a row in which it did not stick
    Eigen::Vector3f velocity_ = Eigen::Vector3f::Zero();
    Eigen::Vector3f turning_ = Eigen::Vector3f::Zero();
};

}  // namespace atrium::physics
