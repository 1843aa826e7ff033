#include "world_server/physics/soft/soft_body.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

namespace atrium::physics {
namespace {

bool has_volume(const SoftObject& object) {
    return object.shape != SoftShape::kCloth && object.shape != SoftShape::kRope;
}

// Maps the 0..1 of a description to the share of an error that a solver iteration corrects.
// Logarithmic, because people judge stiffness that way.
double between(double softest, double stiffest, double stiffness) {
    return softest * std::pow(stiffest / softest, stiffness);
}

btVector3 slowed(const btVector3& velocity, btScalar most) {
    const btScalar speed = velocity.length();
    return speed > most ? velocity * (most / speed) : velocity;
}

}  // namespace

SoftBody::SoftBody(const SoftObject& object, btSoftBodyWorldInfo& info, const WorldOptions& options)
    : object_(object), options_(options), mesh_(make_soft_mesh(object)) {
    assert(!find_problem(object));
    contact_setup_.options = options.soft.contacts;
    contact_setup_.tick_s = btScalar(options.tick_s);
    contact_setup_.friction = btScalar(object.friction);
    contact_setup_.person_friction = btScalar(options.people.contacts.friction);
    contact_setup_.thickness_m = btScalar(0.005);
    if (object.shape == SoftShape::kCloth) {
        contact_setup_.thickness_m = btScalar(std::max(0.005, object.size_m.z() / 2.0));
    } else if (object.shape == SoftShape::kRope) {
        contact_setup_.thickness_m = btScalar(object.size_m.y() / 2.0);
    }
    make_body(info);
    make_samples();
    // only now: lengths and volume are those of the rest shape
    for (std::size_t i = 0; i < start_.size(); ++i)
        start_[i] = to_bullet(start_of_node(object_, mesh_, i));
    reset_to_start();
    rest_extent_ = (body_->m_bounds[1] - body_->m_bounds[0]).length();
    if (object.shape == SoftShape::kRope) rest_extent_ = btScalar(object.size_m.x());
    if (object.span_m) rest_extent_ = btScalar(object.size_m.head<2>().norm());
}

SoftBody::~SoftBody() = default;

void SoftBody::make_body(btSoftBodyWorldInfo& info) {
    std::vector<btScalar> masses;
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
        start_.push_back(to_bullet((object_.world_from_object * mesh_.nodes[i]).eval()));
        masses.push_back(btScalar(object_.mass_kg * mesh_.shares[i]));
    }
    body_ = std::make_unique<btSoftBody>(
        &info, static_cast<int>(start_.size()), start_.data(), masses.data());
    body_->m_cfg.collisions = 0;
    body_->getCollisionShape()->setMargin(contact_setup_.thickness_m);

    btSoftBody::Material& along = *body_->m_materials[0];
    btSoftBody::Material& across = *body_->appendMaterial();
    along.m_kLST = has_volume(object_) ? btScalar(between(0.02, 0.5, object_.stiffness)) : 1;
    across.m_kLST = btScalar(between(0.0005, 0.1, object_.stiffness));
    for (const SoftLink& link : mesh_.links) {
        body_->appendLink(static_cast<int>(link.nodes[0]),
                          static_cast<int>(link.nodes[1]),
                          link.bends ? &across : &along);
    }
    for (const auto& t : mesh_.topology.triangles) {
        body_->appendFace(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    }
    for (const SoftPin& pin : object_.pins) {
        if (pin.object_id != 0) continue;
        for (const std::uint32_t node : nodes_at(mesh_, object_, pin)) {
            body_->setMass(static_cast<int>(node), 0);
        }
    }
    body_->updateConstants();
    first_bend_ = static_cast<std::size_t>(std::ranges::find(mesh_.links, true, &SoftLink::bends) -
                                           mesh_.links.begin());
    loose_.assign(start_.size(), 0);
    taut_.assign(start_.size(), 0);
    find_bounds();
    if (has_volume(object_)) {
        const auto match_share = btScalar(between(0.006, 0.12, object_.stiffness));
        volume_.emplace(*body_, mesh_.topology, match_share, options_.soft.volume);
    }
}

void SoftBody::make_samples() {
    for (std::uint32_t i = 0; i < start_.size(); ++i) samples_.push_back({{i, i, i}, {1, 0, 0}});
    btScalar longest = 0;
    for (int i = 0; i < body_->m_links.size(); ++i) {
        const btSoftBody::Link& link = body_->m_links[i];
        if (!mesh_.links[static_cast<std::size_t>(i)].bends) longest = std::max(longest, link.m_rl);
    }
    if (longest <= options_.soft.fingers_m) return;
    for (const auto& t : mesh_.topology.triangles) {
        const btScalar third = btScalar(1) / 3;
        samples_.push_back({{t[0], t[1], t[2]}, {third, third, third}});
    }
    for (const auto& s : mesh_.topology.segments) {
        samples_.push_back({{s[0], s[1], s[1]}, {btScalar(0.5), btScalar(0.5), 0}});
    }
}

bool SoftBody::attach(const std::function<btRigidBody*(std::uint32_t id)>& find) {
    SoftAnchors anchors;
    for (const SoftPin& pin : object_.pins) {
        if (pin.object_id == 0) continue;
        btRigidBody* body = find(pin.object_id);
        if (body == nullptr) return false;
        for (const std::uint32_t node : nodes_at(mesh_, object_, pin)) {
            anchors.attach(*body_, node, *body);
        }
    }
    anchors_ = std::move(anchors);
    return true;
}

void SoftBody::detach(const btRigidBody& body) { anchors_.detach(body); }

void SoftBody::begin_tick(const SoftSurroundings& surroundings, AnchoredBodies& anchored) {
    find_stretched();
    resist_folds();
    find_bounds();
    const PeopleField* people = surroundings.people;
    if (volume_) {
        volume_->begin_tick();
        depenetration_.clear();
        const bool meets =
            people != nullptr && depenetration_.find(*body_,
                                                     volume_->inner_radius_m(),
                                                     btScalar(options_.people.contacts.escape_mps),
                                                     options_.soft.depenetration,
                                                     *people);
        if (!meets) people = nullptr;
    }
    SoftSkin skin{.samples = samples_, .loose = loose_, .is_calm = is_calm() && motors_.empty()};
    if (volume_) {
        skin.outward = volume_->outward();
        skin.depth_m = volume_->inner_radius_m();
        skin.is_star_shaped = object_.shape != SoftShape::kModel;
    }
    // bodies anchored to its nodes touch them: contacts with them would fight the anchors
    loose_bodies_.clear();
    for (btRigidBody* body : surroundings.bodies)
        if (!anchors_.is_attached_to(*body)) loose_bodies_.push_back(body);
    contacts_.find(*body_, skin, people, loose_bodies_, surroundings.supports, contact_setup_);
    if (volume_) volume_->set_rebound(contacts_.rebound_mps());
    anchors_.begin_tick(anchored);
    contacts_.visit_bodies([&](btRigidBody& body) {
        if (!surroundings.supports.touches_fixed(body)) anchored.add(body);
    });
    motors_.begin_tick(*body_);
}

SoftSurface SoftBody::surface() {
    SoftSurface surface;
    surface.body = body_.get();
    surface.topology = &mesh_.topology;
    surface.samples = samples_;
    // between two bodies with faces, the nodes of both suffice
    if (!mesh_.topology.triangles.empty()) surface.samples = surface.samples.first(num_nodes());
    if (volume_) {
        surface.outward = volume_->outward();
        surface.depth_m = volume_->inner_radius_m();
    }
    surface.thickness_m = contact_setup_.thickness_m;
    surface.friction = contact_setup_.friction;
    return surface;
}

void SoftBody::begin_substep(const SoftSubstep& substep) {
    depenetration_.apply(*body_);
    move_freely(substep.substep_s);
    contacts_.begin_substep();
    motors_.begin_substep();
    if (volume_) volume_->match_shape(substep.part);
}

void SoftBody::solve(const SoftSubstep& substep, int iteration) {
    const int num_rounds = object_.shape == SoftShape::kRope ? options_.soft.links.rope_rounds : 1;
    for (int round = 0; round < num_rounds; ++round) {
        btSoftBody::PSolve_Links(body_.get(), 1, 0);
        if (volume_ && iteration == 0) volume_->keep_volume();
        anchors_.solve(*body_, substep.substep_s, substep.left_s);
        motors_.solve(*body_, substep.substep_s, contact_setup_.tick_s - substep.left_s);
        contacts_.solve(*body_, substep.substep_s, substep.left_s, contact_setup_);
    }
}

void SoftBody::end_substep(const SoftSubstep& substep) {
    const btScalar max_speed = btScalar(options_.max_speed_mps);
    const btScalar snap_mps = options_.soft.links.snap_mps;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        const bool is_taut = taut_[static_cast<std::size_t>(i)] != 0;
        const btScalar most = is_taut ? std::max(snap_mps, node.m_v.length()) : max_speed;
        node.m_v = slowed((node.m_x - node.m_q) / substep.substep_s, std::min(most, max_speed));
    }
    contacts_.end_substep(*body_, substep.substep_s, contact_setup_);
    anchors_.end_substep(substep.substep_s);
}

void SoftBody::end_tick() {
    volume_ ? volume_->damp_inside(contact_setup_.tick_s) : damp_links(contact_setup_.tick_s);
    if (volume_)
        motors_.damp_swing(*body_, contact_setup_.tick_s, options_.soft.handle.swing_damping_hz);
    motors_.end_tick();
    calm_down(contact_setup_.tick_s);
    anchors_.limit(taut_, options_.soft.links.snap_mps);
    // each end of a link can have gained the other's speed
    limit_speeds();
    contacts_.load_carriers();
    if (!is_calm()) contacts_.wake_bodies();
    const btScalar extent = (body_->m_bounds[1] - body_->m_bounds[0]).length();
    num_torn_ticks_ = extent > options_.soft.torn_extents * rest_extent_ ? num_torn_ticks_ + 1 : 0;
}

void SoftBody::find_stretched() {
    const SoftLinkOptions links = options_.soft.links;
    std::fill(loose_.begin(), loose_.end(), std::uint8_t{0});
    for (std::uint8_t& ticks : taut_) ticks -= ticks > 0 ? 1 : 0;
    if (volume_) return;
    for (int i = 0; i < body_->m_links.size(); ++i) {
        const btSoftBody::Link& link = body_->m_links[i];
        if (mesh_.links[static_cast<std::size_t>(i)].bends) continue;
        const btScalar length = (link.m_n[0]->m_x - link.m_n[1]->m_x).length();
        if (length < links.taut_stretch * link.m_rl) continue;
        for (const std::uint32_t node : mesh_.links[static_cast<std::size_t>(i)].nodes) {
            taut_[node] = links.snap_ticks;
            if (length >= links.loose_stretch * link.m_rl) loose_[node] = 1;
        }
    }
    // when one link slips out of hands, the whole object snaps back
    if (std::ranges::any_of(loose_, [](std::uint8_t node) { return node != 0; }))
        std::fill(taut_.begin(), taut_.end(), links.snap_ticks);
}

// Only the bending links open a fold as sharp as the node spacing, and they would never manage it.
// They become stiffer the shorter they are.
void SoftBody::resist_folds() {
    const btScalar open_sq = options_.soft.links.open;
    const btScalar fold_stiffness = options_.soft.links.fold_stiffness;
    for (std::size_t i = first_bend_; i < mesh_.links.size(); ++i) {
        btSoftBody::Link& link = body_->m_links[static_cast<int>(i)];
        const btScalar length_sq = (link.m_n[0]->m_x - link.m_n[1]->m_x).length2();
        const btScalar open = length_sq / link.m_c1;  // square of the relative length
        const btScalar fold = std::clamp((open_sq - open) / open_sq, btScalar(0), btScalar(1));
        const btScalar least = link.m_material->m_kLST;
        const btScalar stiffness = least + std::max(btScalar(0), fold_stiffness - least) * fold;
        link.m_c0 = (link.m_n[0]->m_im + link.m_n[1]->m_im) / stiffness;
    }
}

// Bounds of the path through the coming tick, including the contact distance.
void SoftBody::find_bounds() {
    const btScalar reach = contact_setup_.thickness_m + contact_setup_.options.margin_m;
    btVector3 low = start_[0], high = start_[0];
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        const btVector3 end = node.m_x + node.m_v * contact_setup_.tick_s;
        if (i == 0) low = high = node.m_x;
        low.setMin(node.m_x);
        low.setMin(end);
        high.setMax(node.m_x);
        high.setMax(end);
    }
    body_->m_bounds[0] = low - btVector3(reach, reach, reach);
    body_->m_bounds[1] = high + btVector3(reach, reach, reach);
}

void SoftBody::move_freely(btScalar substep_s) {
    const btVector3 fall = to_bullet(options_.gravity) * substep_s;
    const btScalar kept = std::exp(-btScalar(object_.damping_hz) * substep_s);
    const btScalar max_speed = btScalar(options_.max_speed_mps);
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_q = node.m_x;
        if (!(node.m_im > 0)) {
            node.m_v.setZero();
            continue;
        }
        node.m_v = slowed((node.m_v + fall) * kept, max_speed);
        node.m_x += node.m_v * substep_s;
    }
}

// Damps relative motion of link ends along the link.
void SoftBody::damp_links(btScalar seconds) {
    const btScalar lost = 1 - std::exp(-options_.soft.links.damping_hz * seconds);
    for (int i = 0; i < body_->m_links.size(); ++i) {
        btSoftBody::Node& a = *body_->m_links[i].m_n[0];
        btSoftBody::Node& b = *body_->m_links[i].m_n[1];
        const btVector3 along = b.m_x - a.m_x;
        const btScalar scale = along.length2() * (a.m_im + b.m_im);
        if (!(scale > 0)) continue;
        const btVector3 impulse = along * (lost * along.dot(b.m_v - a.m_v) / scale);
        a.m_v += impulse * a.m_im;
        b.m_v -= impulse * b.m_im;
    }
}

bool SoftBody::is_calm() const {
    btScalar mass = 0, energy = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        if (!(node.m_im > 0)) continue;
        mass += 1 / node.m_im;
        energy += node.m_v.length2() / node.m_im;
    }
    const btScalar calm_mps = options_.soft.calm_mps;
    return energy <= calm_mps * calm_mps * mass;
}

// Brings slow objects to rest. Otherwise they would roll and sway for minutes.
void SoftBody::calm_down(btScalar seconds) {
    if (!is_calm()) return;
    const btScalar kept = std::exp(-options_.soft.calm_damping_hz * seconds);
    for (int i = 0; i < body_->m_nodes.size(); ++i) body_->m_nodes[i].m_v *= kept;
}

void SoftBody::limit_speeds() {
    const btScalar most = btScalar(options_.max_speed_mps);
    for (int i = 0; i < body_->m_nodes.size(); ++i)
        body_->m_nodes[i].m_v = slowed(body_->m_nodes[i].m_v, most);
}

void SoftBody::reset_to_start() {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_x = node.m_q = start_[static_cast<std::size_t>(i)];
        node.m_v.setZero();
    }
    num_torn_ticks_ = 0;
    contacts_.forget_places();
    find_bounds();
}

Eigen::Vector3d SoftBody::centre() const { return centre_of(*body_); }

bool SoftBody::is_finite() const {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        // a sum with a non-finite term is not finite
        const btScalar sum = node.m_x.dot(node.m_x) + node.m_v.dot(node.m_v);
        if (!std::isfinite(sum)) return false;
    }
    return true;
}

void SoftBody::get_positions(std::vector<Eigen::Vector3f>& positions) const {
    positions.resize(start_.size());
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btVector3& x = body_->m_nodes[i].m_x;
        positions[static_cast<std::size_t>(i)] = {x.x(), x.y(), x.z()};
    }
}

void SoftBody::save(SoftState& state) const {
    state.id = object_.id;
    state.num_torn_ticks = num_torn_ticks_;
    get_positions(state.positions);
    state.velocities.resize(start_.size());
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btVector3& v = body_->m_nodes[i].m_v;
        state.velocities[static_cast<std::size_t>(i)] = {v.x(), v.y(), v.z()};
    }
}

bool SoftBody::restore(const SoftState& state) {
    if (state.positions.size() != start_.size()) return false;
    if (state.velocities.size() != start_.size()) return false;
    for (std::size_t i = 0; i < start_.size(); ++i) {
        if (!state.positions[i].allFinite() || !state.velocities[i].allFinite()) return false;
    }
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        const Eigen::Vector3f& x = state.positions[static_cast<std::size_t>(i)];
        const Eigen::Vector3f& v = state.velocities[static_cast<std::size_t>(i)];
        node.m_x = node.m_q = btVector3(x.x(), x.y(), x.z());
        node.m_v = btVector3(v.x(), v.y(), v.z());
    }
    num_torn_ticks_ = state.num_torn_ticks;
    contacts_.forget_places();
    find_bounds();
    return true;
}

}  // namespace atrium::physics
