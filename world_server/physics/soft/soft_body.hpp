#pragma once

#include "world_server/physics/options/world_options.hpp"
#include "world_server/physics/soft/soft_anchors.hpp"
#include "world_server/physics/soft/soft_contacts.hpp"
#include "world_server/physics/soft/soft_depenetration.hpp"
#include "world_server/physics/soft/soft_mesh.hpp"
#include "world_server/physics/soft/soft_motors.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/soft/soft_soft_contacts.hpp"
#include "world_server/physics/soft/soft_volume.hpp"
#include "world_server/physics/state/world_state.hpp"

#include <Eigen/Core>
#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

class btRigidBody;
class btSoftBody;
struct btSoftBodyWorldInfo;

namespace atrium::physics {

/// A substep of a tick.
struct SoftSubstep {
    btScalar substep_s = 0;  // length
    btScalar left_s = 0;     // from the end of the substep to the end of the tick
    btScalar part = 1;       // of SoftOptions::substep_s
};

/// One soft object of the world.
///
/// A btSoftBody holds nodes and links, and Bullet solves the links. This class does the rest of the
/// step, for three reasons: Bullet's step has no contacts with people; its contacts with rigid
/// bodies use a coarse distance grid and a layer of fixed depth below planes; one step of 1/120 s
/// leaves links too slack.
///
/// A tick has substeps of about 2 ms. In each substep nodes first move freely. Then links, shape,
/// volume, anchors and contacts correct the positions in turn. The corrected motion gives the
/// velocities (Müller et al., "Position Based Dynamics", 2007; substeps: "Detailed Rigid Body
/// Simulation with Extended Position Based Dynamics", 2020).
class SoftBody {
public:
    /// `find_problem(object)` must be empty; `info` must outlive this.
    SoftBody(const SoftObject& object, btSoftBodyWorldInfo& info, const WorldOptions& options);
    ~SoftBody();
    SoftBody(const SoftBody&) = delete;
    SoftBody& operator=(const SoftBody&) = delete;

    btSoftBody& body() { return *body_; }
    const SoftObject& object() const { return object_; }
    const SoftTopology& topology() const { return mesh_.topology; }
    std::size_t num_nodes() const { return mesh_.nodes.size(); }

    /// Attaches the nodes of all pins that name an object. If `find` does not know an object,
    /// returns false and attaches nothing.
    bool attach(const std::function<btRigidBody*(std::uint32_t id)>& find);
    /// Detaches from a body that is about to be removed.
    void detach(const btRigidBody& body);

    /// Drives a handle in the coming tick; see `SoftMotors::add`.
    void drive(const SoftHandle& handle, const btVector3& velocity, btScalar max_force_n) {
        motors_.add(handle, velocity, max_force_n);
    }

    // Order of calls in a tick, after the tick of the rigid bodies: begin_tick; for each substep
    // begin_substep, solve in each iteration, end_substep; then end_tick.
    void begin_tick(const SoftSurroundings& surroundings, AnchoredBodies& anchored);
    /// The most that a body may press in this tick: its mass in masses of a volume, or of what it
    /// touches of a cloth or rope.
    btScalar load() const {
        return volume_ ? contacts_.heaviest_kg() / btScalar(object_.mass_kg)
                       : contacts_.heaviest_load();
    }
    void begin_substep(const SoftSubstep& substep);
    void solve(const SoftSubstep& substep, int iteration);
    void end_substep(const SoftSubstep& substep);
    void end_tick();

    /// Surface for contacts with other soft bodies in this tick. Call after begin_tick.
    SoftSurface surface();

    /// Returns the object to its start pose, at rest.
    void reset_to_start();
    bool is_finite() const;
    /// Mean of all nodes [m].
    Eigen::Vector3d centre() const;
    /// True if the object was stretched far beyond its size for more than 60 ticks.
    bool is_torn() const { return num_torn_ticks_ > 60; }
    bool touches_person() const { return contacts_.num_person_contacts() > 0; }

    /// Writes one position per node [m].
    void get_positions(std::vector<Eigen::Vector3f>& positions) const;
    void save(SoftState& state) const;
    /// Returns false and changes nothing if the sizes do not match or a number is not finite.
    bool restore(const SoftState& state);

private:
    void make_body(btSoftBodyWorldInfo& info);
    void make_samples();
    void find_stretched();
    void resist_folds();
    void find_bounds();
    void move_freely(btScalar substep_s);
    void damp_links(btScalar seconds);
    bool is_calm() const;
    void calm_down(btScalar seconds);
    void limit_speeds();

    SoftObject object_;
    WorldOptions options_;
    SoftMesh mesh_;
    SoftContactSetup contact_setup_;
    std::unique_ptr<btSoftBody> body_;
    std::optional<SoftVolume> volume_;  // empty for cloth and rope
    std::vector<btVector3> start_;      // one per node
    std::vector<SoftSample> samples_;
    SoftAnchors anchors_;
    SoftMotors motors_;
    SoftContacts contacts_;
    std::vector<btRigidBody*> loose_bodies_;  // scratch: bodies without an anchor of this object
    // pushes of people whose surface is inside the volume, for this tick
    SoftDepenetration depenetration_;
    std::vector<std::uint8_t> loose_;  // per node; see SoftSkin::loose
    std::vector<std::uint8_t> taut_;   // per node: ticks left in which it snaps back
    std::size_t first_bend_ = 0;       // index of the first bending link; these come last
    btScalar rest_extent_ = 0;         // diagonal of its bounds at rest [m]
    int num_torn_ticks_ = 0;
};

}  // namespace atrium::physics
