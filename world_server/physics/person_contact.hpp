#pragma once

#include "world_server/physics/body_samples.hpp"
#include "world_server/physics/people_field.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

class btRigidBody;

namespace atrium::physics {

/// Where an object touches a person, or will within this tick; world frame.
struct PersonContact {
    Eigen::Vector3f point;     // on the object
    Eigen::Vector3f normal;    // of the person's surface, unit length, outwards
    Eigen::Vector3f velocity;  // [m/s] of the person's surface
    float distance_m = 0.0F;   // < 0: the point is inside the person
    float after_m = 0.0F;      // what the distance would be after the tick if nothing acted
    bool is_at_edge = false;   // of a sphere with what may be an edge of the surface
};

/// An object's surface as the contact search sees it.
struct ContactBody {
    bool is_sphere = false;
    float radius_m = 0.0F;            // of a sphere
    float size_m = 0.0F;              // largest extent
    std::vector<BodySample> samples;  // of a sphere: relative to its centre, world's axes
};

/// The object's motion at the beginning of a tick; world frame.
struct ContactMotion {
    Eigen::Isometry3f world_from_body;
    Eigen::Vector3f linear_velocity;   // [m/s]
    Eigen::Vector3f angular_velocity;  // [rad/s]
    Eigen::Vector3f low;               // of the object's bounds
    Eigen::Vector3f high;
};

inline constexpr std::size_t kMaxContacts = 12;  // of one object and one person

/// Finds where objects touch people. Reuses its memory; not thread-safe.
class ContactFinder {
public:
    /// At most `kMaxContacts`, those first that would be deepest after the tick; valid until the
    /// next call. `num_near`: how many surfels were looked at; 0: nothing of the person is near.
    std::span<const PersonContact> find(const ContactBody& body,
                                        const ContactMotion& motion,
                                        const PersonField& person,
                                        double tick_s);
    std::size_t num_near() const { return near_.size(); }
    /// [rad/s], world frame, of what is near as if it were one piece; of the last call that found
    /// contacts.
    const Eigen::Vector3f& turning() const { return turning_; }

private:
    void gather(const ContactMotion& motion, const PersonField& person, float tick_s);
    void find_turning();
    void test(const ContactBody& body,
              const ContactMotion& motion,
              const BodySample& sample,
              const PersonField& person,
              float tick_s);
    const PlacedSurfel* first_on_path(const Eigen::Vector3f& point,
                                      const Asker& asker,
                                      const ContactMotion& motion,
                                      const PersonField& person,
                                      float tick_s) const;
    void select(float size_m);

    Eigen::Vector3f turning_ = Eigen::Vector3f::Zero();
    std::vector<const PlacedSurfel*> near_;
    Eigen::Vector3f near_low_;
    Eigen::Vector3f near_high_;
    // Of what is near and so fast that the field's reach does not do.
    bool has_fast_ = false;
    Eigen::Vector3f fast_low_mps_;
    Eigen::Vector3f fast_high_mps_;
    std::vector<PersonContact> candidates_;
    std::vector<PersonContact> selected_;
};

}  // namespace atrium::physics
