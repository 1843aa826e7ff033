#pragma once

#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/rigid/body_samples.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

class btRigidBody;

namespace atrium::physics {

/// A contact of an object and a person, now or within this tick. World frame.
struct PersonContact {
    Eigen::Vector3f point;     // on the object
    Eigen::Vector3f normal;    // of the person's surface, unit length, outward
    Eigen::Vector3f velocity;  // [m/s] of the person's surface
    float distance_m = 0.0F;   // < 0: the point is inside the person
    float after_m = 0.0F;      // predicted distance at the end of the tick without contact forces
    bool is_at_edge = false;   // sphere touching a possible edge of the surface
};

/// Surface of an object for the contact search.
struct ContactBody {
    bool is_sphere = false;
    float radius_m = 0.0F;            // spheres only
    float size_m = 0.0F;              // largest extent
    std::vector<BodySample> samples;  // sphere: relative to the centre, world axes
};

/// Motion of an object at the start of a tick. World frame.
struct ContactMotion {
    Eigen::Isometry3f world_from_body;
    Eigen::Vector3f linear_velocity;   // [m/s]
    Eigen::Vector3f angular_velocity;  // [rad/s]
    Eigen::Vector3f low;               // bounds of the object
    Eigen::Vector3f high;
};

/// Finds contacts between objects and people. Reuses its memory. Not thread-safe.
class ContactFinder {
public:
    explicit ContactFinder(const ContactSearchOptions& options) : options_(options) {}

    /// Returns at most `max_contacts` contacts, those first that would be deepest after the tick.
    /// Valid until the next call.
    std::span<const PersonContact> find(const ContactBody& body,
                                        const ContactMotion& motion,
                                        const PersonField& person,
                                        double tick_s);
    /// Number of surfels that the last `find` examined; 0: no part of the person is near.
    std::size_t num_near() const { return near_.size(); }
    /// Rotation of the nearby surface as one rigid piece [rad/s], world frame. Belongs to the last
    /// call that found contacts.
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
                                      const SurfaceProbe& probe,
                                      const ContactMotion& motion,
                                      const PersonField& person,
                                      float tick_s) const;
    void select(float size_m);

    ContactSearchOptions options_;
    Eigen::Vector3f turning_ = Eigen::Vector3f::Zero();
    std::vector<const PlacedSurfel*> near_;
    Eigen::Vector3f near_low_;
    Eigen::Vector3f near_high_;
    // Velocity bounds of nearby surfels that are too fast for the field's reach.
    bool has_fast_ = false;
    Eigen::Vector3f fast_low_mps_;
    Eigen::Vector3f fast_high_mps_;
    std::vector<PersonContact> candidates_;
    std::vector<PersonContact> selected_;
};

}  // namespace atrium::physics
