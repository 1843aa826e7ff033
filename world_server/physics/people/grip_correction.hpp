#pragma once

#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/people/person_contact.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace atrium::physics {

/// Corrects the drift of an object that sticks to a person.
///
/// Friction moves an object with the velocity of the person's surface. That velocity is wrong by a
/// few per cent, in places by more. Over a metre, an object would slide out of the hands that hold
/// it. This class therefore remembers the surface around the object, in the object's frame. Once
/// per mesh it registers the remembered surface with the current one (point to plane, Chen and
/// Medioni 1992). The offset between both is the object's lag. A velocity that removes the lag is
/// added to the velocity of the surface. Friction still decides: an object that the hands release
/// slips, and after a slip the surface is remembered anew.
class GripCorrection {
public:
    /// `options` must outlive this.
    explicit GripCorrection(const GripOptions& options) : options_(options) {}

    /// Call once per tick while the object touches the person, before the contacts are used.
    /// `surface_turning` [rad/s] is the rotation of the surface near the object.
    void update(const ContactMotion& motion,
                const PersonField& person,
                std::span<const PersonContact> contacts,
                const Eigen::Vector3f& surface_turning);
    void forget();

    /// Correction to add to the motion of the surface [m/s], at `offset` from the object's centre.
    Eigen::Vector3f velocity_at(const Eigen::Vector3f& offset) const {
        return velocity_ + turning_.cross(offset);
    }
    const Eigen::Vector3f& turning() const { return turning_; }

private:
    struct Kept {  // sample of the surface, in the object's frame
        Eigen::Vector3f position;
        Eigen::Vector3f normal;
    };
    struct Offset {  // drift of the surface about the object's centre, world axes
        Eigen::Vector3f shift = Eigen::Vector3f::Zero();  // [m]
        Eigen::Vector3f turn = Eigen::Vector3f::Zero();   // [rad]
        bool is_sure = false;
    };
    bool sticks(const ContactMotion& motion,
                std::span<const PersonContact> contacts,
                const Eigen::Vector3f& surface_turning) const;
    /// `behind`: lag of the object that is already known.
    void remember(const ContactMotion& motion,
                  const PersonField& person,
                  std::span<const PersonContact> contacts,
                  const Offset& behind);
    Offset find_offset(const ContactMotion& motion, const PersonField& person) const;

    const GripOptions& options_;
    std::vector<Kept> kept_;
    Offset last_;
    std::size_t num_loose_ = 0;  // consecutive ticks without sticking
    Eigen::Vector3f velocity_ = Eigen::Vector3f::Zero();
    Eigen::Vector3f turning_ = Eigen::Vector3f::Zero();
};

}  // namespace atrium::physics
