#pragma once

#include "world_server/physics/soft_contacts.hpp"
#include "world_server/physics/soft_drives.hpp"
#include "world_server/physics/soft_mesh.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/soft_pairs.hpp"
#include "world_server/physics/soft_pulls.hpp"
#include "world_server/physics/soft_ties.hpp"
#include "world_server/physics/soft_volume.hpp"
#include "world_server/physics/world.hpp"

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

/// A part of a tick.
struct SoftPart {
    btScalar part_s = 0;  // its length
    btScalar left_s = 0;  // from its end to the end of the tick
};

/// How often all constraints of a part are gone through.
inline constexpr int kSoftPasses = 2;

/// One soft object of the world.
///
/// The nodes and links are a btSoftBody's, and Bullet solves the links. The rest of a step is made
/// here: Bullet's own has no contacts with people, its contacts with rigid bodies go by a coarse
/// grid of distances and a layer of fixed depth below planes, and one step of 1/120 s leaves links
/// too slack. A tick goes by in parts of about 2 ms. In each, nodes fly freely; then links, shape,
/// volume, ties and contacts move them in turn; and what they have moved is their velocity
/// (Müller et al., "Position Based Dynamics", 2007, "Detailed Rigid Body Simulation with Extended
/// Position Based Dynamics", 2020, for the parts).
class SoftBody {
public:
    /// `object` must have no problem; `info` must outlive this.
    SoftBody(const SoftObject& object, btSoftBodyWorldInfo& info, const WorldOptions& options);
    ~SoftBody();
    SoftBody(const SoftBody&) = delete;
    SoftBody& operator=(const SoftBody&) = delete;

    btSoftBody& body() { return *body_; }
    const SoftObject& object() const { return object_; }
    const SoftTopology& topology() const { return mesh_.topology; }
    std::size_t num_nodes() const { return mesh_.nodes.size(); }

    /// Ties the nodes of the pins that name an object. False, and nothing is tied, where `find`
    /// knows none of that id.
    bool tie(const std::function<btRigidBody*(std::uint32_t id)>& find);
    /// The body is about to go.
    void untie(const btRigidBody& body);

    /// Pulls in the coming tick; see `SoftPulls::add`.
    void pull(const SoftHandle& handle, const btVector3& velocity, btScalar max_force_n) {
        pulls_.add(handle, velocity, max_force_n);
    }

    // A tick, after that of the rigid bodies, is: begin_tick; for each part begin_part, solve
    // kSoftPasses times, end_part; end_tick.
    void begin_tick(const SoftSurroundings& surroundings, TiedBodies& tied);
    void begin_part(const SoftPart& part);
    void solve(const SoftPart& part, int pass);
    void end_part(const SoftPart& part);
    void end_tick();

    /// For others, in this tick: after begin_tick.
    SoftSurface surface();

    /// Back to where it started, at rest.
    void put_back();
    bool is_finite() const;
    /// Of all its nodes [m].
    Eigen::Vector3d centre() const;
    /// Stretched far beyond its size, for longer than a pull explains.
    bool is_torn() const { return num_torn_ticks_ > 60; }
    bool touches_person() const { return contacts_.num_person_contacts() > 0; }

    /// One per node [m].
    void get_positions(std::vector<Eigen::Vector3f>& positions) const;
    void save(SoftState& state) const;
    /// False, and nothing is changed, where the sizes do not fit or a number is not finite.
    bool restore(const SoftState& state);

private:
    void make_body(btSoftBodyWorldInfo& info);
    void make_samples();
    void find_stretched();
    void resist_folds();
    void find_bounds();
    void move_freely(btScalar part_s);
    void damp_links(btScalar seconds);
    void calm_down(btScalar seconds);
    void limit_speeds();

    SoftObject object_;
    WorldOptions options_;
    SoftMesh mesh_;
    SoftContactOptions contact_options_;
    std::unique_ptr<btSoftBody> body_;
    std::optional<SoftVolume> volume_;  // none of a cloth or rope
    std::vector<btVector3> start_;      // one per node
    std::vector<SoftSample> samples_;
    SoftTies ties_;
    SoftPulls pulls_;
    SoftContacts contacts_;
    std::vector<btRigidBody*> loose_bodies_;  // scratch: that it is not tied to
    SoftDrives drives_;                // of this tick, by people whose surface is inside a volume
    std::vector<std::uint8_t> loose_;  // per node, see SoftContacts::find
    std::vector<std::uint8_t> taut_;   // ticks, per node, in which it snaps back
    std::size_t first_bend_ = 0;       // of the links: these come last
    btScalar rest_extent_ = 0;         // diagonal of its bounds [m]
    int num_torn_ticks_ = 0;
};

}  // namespace atrium::physics
