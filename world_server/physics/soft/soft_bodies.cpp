#include "world_server/physics/soft/soft_bodies.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodySolvers.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::physics {

// Adapts `SoftBodies` to Bullet's solver interface. Predicts nothing before the rigid bodies move:
// a soft body makes its whole step after them.
class SoftBodies::Solver final : public btSoftBodySolver {
public:
    explicit Solver(SoftBodies& owner) : owner_(owner) {}
    SolverTypes getSolverType() const override { return DEFAULT_SOLVER; }
    bool checkInitialized() override { return true; }
    void optimize(btAlignedObjectArray<btSoftBody*>&, bool) override {}
    void copyBackToSoftBodies(bool) override {}
    void predictMotion(btScalar) override {}
    void solveConstraints(btScalar) override { owner_.step(); }
    void updateSoftBodies() override {}
    void processCollision(btSoftBody*, const btCollisionObjectWrapper*) override {}
    void processCollision(btSoftBody*, btSoftBody*) override {}

private:
    SoftBodies& owner_;
};

SoftBodies::SoftBodies(const WorldOptions& options, std::function<void()> after_rigid)
    : options_(options),
      after_rigid_(std::move(after_rigid)),
      solver_(std::make_unique<Solver>(*this)) {}
SoftBodies::~SoftBodies() = default;

btSoftBodySolver* SoftBodies::solver() { return solver_.get(); }

AddResult SoftBodies::add(const SoftObject& object,
                          btSoftRigidDynamicsWorld& world,
                          const std::function<btRigidBody*(std::uint32_t id)>& find) {
    if (find_problem(object)) return AddResult::kInvalid;
    if (contains(object.id)) return AddResult::kIdInUse;
    if (num_nodes_ + count_soft_nodes(object) > kMaxSoftNodesTotal) return AddResult::kWorldFull;
    auto body = std::make_unique<SoftBody>(object, world.getWorldInfo(), options_);
    if (!body->attach(find)) return AddResult::kInvalid;
    // no group and no mask: the soft body finds its contacts itself
    world.addSoftBody(&body->body(), 0, 0);
    num_nodes_ += body->num_nodes();
    bodies_.emplace(object.id, std::move(body));
    return AddResult::kAdded;
}

bool SoftBodies::remove(std::uint32_t id, btSoftRigidDynamicsWorld& world) {
    const auto found = bodies_.find(id);
    if (found == bodies_.end()) return false;
    world.removeSoftBody(&found->second->body());
    num_nodes_ -= found->second->num_nodes();
    bodies_.erase(found);
    return true;
}

void SoftBodies::clear(btSoftRigidDynamicsWorld& world) {
    for (auto& [id, body] : bodies_) world.removeSoftBody(&body->body());
    bodies_.clear();
    num_nodes_ = 0;
}

void SoftBodies::detach(const btRigidBody& body) {
    for (auto& [id, soft] : bodies_) soft->detach(body);
}

void SoftBodies::reset() {
    for (auto& [id, soft] : bodies_) soft->reset_to_start();
}

bool SoftBodies::push(std::uint32_t id, const Eigen::Vector3d& impulse_ns) {
    SoftBody* soft = find(id);
    if (soft == nullptr || !impulse_ns.allFinite()) return false;
    const btVector3 gain = to_bullet(impulse_ns) / btScalar(soft->object().mass_kg);
    for (int i = 0; i < soft->body().m_nodes.size(); ++i) {
        btSoftBody::Node& node = soft->body().m_nodes[i];
        if (node.m_im > 0) node.m_v += gain;
    }
    return true;
}

SoftSurroundings& SoftBodies::begin_tick(const PeopleField& people) {
    surroundings_.people = &people;
    surroundings_.bodies.clear();
    surroundings_.supports.clear();
    return surroundings_;
}

// The lighter its nodes and the longer the substeps, the less a body resists: the solver moves each
// node at most to where nothing presses it. Without more substeps, a heavy box shakes and tips
// over.
int SoftBodies::num_substeps_of_tick() const {
    const SoftOptions& soft = options_.soft;
    btScalar load = 0;
    for (const auto& [id, body] : bodies_) load = std::max(load, body->load());
    const btScalar most = btScalar(soft.max_substeps);
    const btScalar shorter =
        std::sqrt(std::clamp(load / soft.heavy_load, btScalar(1), most * most));
    const auto usual = btScalar(std::lround(options_.tick_s / soft.substep_s));
    return static_cast<int>(std::clamp(usual * std::ceil(shorter), btScalar(1), most));
}

// Steps all soft bodies together, substep by substep: they can push each other.
void SoftBodies::step() {
    after_rigid_();
    surfaces_.clear();
    anchored_.begin_tick();
    for (auto& [id, body] : bodies_) {
        body->begin_tick(surroundings_, anchored_);
        surfaces_.push_back(body->surface());
    }
    contacts_.find(surfaces_, btScalar(options_.tick_s));
    const SoftOptions& soft = options_.soft;
    const int num_substeps = num_substeps_of_tick();
    const btScalar substep_s = btScalar(options_.tick_s) / btScalar(num_substeps);
    const btScalar part = substep_s / btScalar(soft.substep_s);
    for (int i = 1; i <= num_substeps; ++i) {
        const SoftSubstep substep{substep_s, substep_s * btScalar(num_substeps - i), part};
        for (auto& [id, body] : bodies_) body->begin_substep(substep);
        contacts_.begin_substep();
        for (int iteration = 0; iteration < soft.num_iterations; ++iteration) {
            for (auto& [id, body] : bodies_) body->solve(substep, iteration);
            contacts_.solve(substep.left_s);
        }
        for (auto& [id, body] : bodies_) body->end_substep(substep);
        contacts_.end_substep();
        anchored_.end_substep(substep_s);
    }
    anchored_.end_tick();
    for (auto& [id, body] : bodies_) body->end_tick();
}

const std::vector<std::uint32_t>& SoftBodies::end_tick(
    WorldCounters& counters, const std::function<void(const Incident& incident)>& record) {
    const geometry::Aabb box = box_of(options_);
    left_.clear();
    for (auto& [id, soft] : bodies_) {
        const bool is_finite = soft->is_finite();
        if (!is_finite || soft->is_torn()) {
            ++(is_finite ? counters.num_torn : counters.num_not_finite);
            record({id, is_finite ? IncidentKind::kMisshapen : IncidentKind::kNotFinite});
            soft->reset_to_start();
        } else if (!box.contains(soft->centre())) {
            ++counters.num_strays;
            const bool is_removed = options_.leaving == LeavePolicy::kRemove;
            record({id, is_removed ? IncidentKind::kRemoved : IncidentKind::kLeft});
            if (is_removed)
                left_.push_back(id);
            else
                soft->reset_to_start();
        }
    }
    return left_;
}

bool SoftBodies::is_touched() const {
    return std::any_of(bodies_.begin(), bodies_.end(), [](const auto& entry) {
        return entry.second->touches_person();
    });
}

SoftBody* SoftBodies::find(std::uint32_t id) const {
    const auto found = bodies_.find(id);
    return found == bodies_.end() ? nullptr : found->second.get();
}

}  // namespace atrium::physics
