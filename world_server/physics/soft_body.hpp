#pragma once

#include "world_server/physics/soft_contacts.hpp"
#include "world_server/physics/soft_mesh.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/world.hpp"

#include <Eigen/Core>
#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

class btRigidBody;
class btSoftBody;
struct btSoftBodyWorldInfo;

namespace atrium::physics {

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

    /// One tick, after that of the rigid bodies.
    void step(const SoftSurroundings& surroundings);

    /// Back to where it started, at rest.
    void put_back();
    bool is_finite() const;
    /// Of all its nodes [m].
    Eigen::Vector3d centre() const;
    /// Stretched far beyond its size, for longer than a pull explains.
    bool is_torn() const { return num_torn_ticks_ > 60; }
    bool touches_person() const { return contacts_.num_person_contacts() > 0; }
    double kinetic_energy_j() const;
    double volume_m3() const;  // that it encloses; 0 of a cloth or rope

    /// One per node [m].
    void get_positions(std::vector<Eigen::Vector3f>& positions) const;
    void save(SoftState& state) const;
    /// False, and nothing is changed, where the sizes do not fit or a number is not finite.
    bool restore(const SoftState& state);

private:
    struct Tie {
        std::uint32_t node = 0;
        btRigidBody* body = nullptr;
        btVector3 place;     // in the body's frame
        btVector3 velocity;  // of that place when the tick began
        btVector3 shift;     // [m] that impulses have moved it in this tick
    };

    struct Drive {
        btVector3 out;       // unit length
        btScalar speed = 0;  // [m/s] along it
    };

    void make_body(btSoftBodyWorldInfo& info);
    void make_samples();
    void find_loose();
    void find_bounds();
    void begin_ties();
    void move_freely(btScalar part_s);
    void match_shape();
    btScalar find_gradients();
    void keep_volume();
    void solve_ties(btScalar part_s, btScalar left_s);
    void end_part(btScalar part_s);
    void damp_inside(btScalar seconds);
    void damp_links(btScalar seconds);
    void calm_down(btScalar seconds);
    /// False: it is being led out of a person and must have no contacts with people.
    bool keep_off(const PeopleField& people);
    /// Gives every node at least this speed.
    void drive(const Drive& drive);
    Eigen::Vector3f mean_velocity() const;
    bool has_volume() const {
        return object_.shape != SoftShape::kCloth && object_.shape != SoftShape::kRope;
    }

    SoftObject object_;
    WorldOptions options_;
    SoftMesh mesh_;
    SoftContactOptions contact_options_;
    std::unique_ptr<btSoftBody> body_;
    std::vector<btVector3> start_;  // one per node
    std::vector<SoftSample> samples_;
    std::vector<Tie> ties_;
    SoftContacts contacts_;
    std::vector<Drive> drives_;         // of this tick, by people whose surface is inside a volume
    std::vector<std::uint8_t> loose_;   // per node, see SoftContacts::find
    std::vector<btVector3> gradients_;  // per node, of the volume
    std::vector<btVector3> rest_outward_;  // per node, unit length, of the shape at rest
    std::vector<btVector3> outward_;       // the same, turned as the body now is
    btScalar rest_volume_ = 0;
    btScalar match_share_ = 0;   // of the way to the matched shape that a node goes in a part
    btScalar inner_radius_ = 1;  // half of the smallest extent of a volume at rest [m]
    btScalar rest_extent_ = 0;   // diagonal of its bounds [m]
    int num_parts_ = 1;          // of a tick
    int num_torn_ticks_ = 0;
};

}  // namespace atrium::physics
