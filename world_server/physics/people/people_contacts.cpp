#include "world_server/physics/people/people_contacts.hpp"

#include "world_server/physics/people/grip_correction.hpp"
#include "world_server/physics/rigid/body_samples.hpp"
#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/rigid/shape_distance.hpp"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

// Carriers are in no world, but the solver and its sorting need a world index.
constexpr int kFirstCarrierIndex = 1 << 16;

ContactMotion motion_of(const btRigidBody& body) {
    ContactMotion motion;
    const btMatrix3x3& basis = body.getWorldTransform().getBasis();
    for (int row = 0; row < 3; ++row) {
        for (int col = 0; col < 3; ++col) motion.world_from_body(row, col) = basis[row][col];
    }
    motion.world_from_body.makeAffine();
    motion.world_from_body.translation() = floats_from_bullet(body.getWorldTransform().getOrigin());
    motion.linear_velocity = floats_from_bullet(body.getLinearVelocity());
    motion.angular_velocity = floats_from_bullet(body.getAngularVelocity());
    btVector3 low;
    btVector3 high;
    body.getAabb(low, high);
    motion.low = floats_from_bullet(low);
    motion.high = floats_from_bullet(high);
    return motion;
}

ContactBody surface_of(const btCollisionShape& shape, const BodySamplingOptions& options) {
    ContactBody body;
    btVector3 low;
    btVector3 high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    body.size_m = floats_from_bullet(high - low).maxCoeff();
    if (shape.getShapeType() != SPHERE_SHAPE_PROXYTYPE) {
        body.samples = sample_body(shape, options);
        return body;
    }
    body.is_sphere = true;
    body.radius_m = static_cast<const btSphereShape&>(shape).getRadius();
    const float area_m2 = 4.0F * std::numbers::pi_v<float> * body.radius_m * body.radius_m;
    const auto num =
        static_cast<std::size_t>(area_m2 / (options.sphere_spacing_m * options.sphere_spacing_m));
    for (const Eigen::Vector3f& outwards :
         even_directions(std::clamp(num, options.min_sphere_samples, options.max_sphere_samples))) {
        body.samples.push_back({body.radius_m * outwards, outwards});
    }
    return body;
}

}  // namespace

struct PeopleContacts::Carrier {
    BT_DECLARE_ALIGNED_ALLOCATOR();
    explicit Carrier(int index);

    btSphereShape shape{0.01F};
    btBroadphaseProxy proxy;
    btRigidBody body;
    btPersistentManifold* manifold = nullptr;
};

PeopleContacts::Carrier::Carrier(int index) : body(0.0F, nullptr, &shape) {
    body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    // an active kinematic body wakes all sleeping objects that it touches
    body.setActivationState(DISABLE_DEACTIVATION);
    body.setWorldArrayIndex(index);
    proxy.m_clientObject = &body;
    proxy.m_uniqueId = index;
    body.setBroadphaseHandle(&proxy);
}

struct PeopleContacts::Tracked {
    std::uint32_t id = 0;
    btRigidBody* body = nullptr;
    ContactBody surface;
    float inner_radius_m = 0.0F;  // half of the smallest extent
    std::string escaping_from;    // the person out of whom it is moved; empty: none
    bool is_teleported = false;   // teleported, and not yet apart from all people
    std::map<std::string, GripCorrection> grips;
};

// Shared data of the contacts of one object with one person.
struct PeopleContacts::Surface {
    Eigen::Vector3f turning;  // [rad/s]
    const GripCorrection& grip;
    float share = 1.0F;            // a contact's share of the object's mass
    bool resists_rolling = false;  // applies to the next contact
};

PeopleContacts::PeopleContacts(btDispatcher& dispatcher, const PeopleContactOptions& options)
    : dispatcher_(dispatcher), options_(options), finder_(options.search) {}

PeopleContacts::~PeopleContacts() { end_tick(); }

void PeopleContacts::add(std::uint32_t id, btRigidBody& body) {
    auto tracked = std::make_unique<Tracked>();
    tracked->id = id;
    tracked->body = &body;
    tracked->surface = surface_of(*body.getCollisionShape(), options_.sampling);
    btVector3 low;
    btVector3 high;
    body.getCollisionShape()->getAabb(btTransform::getIdentity(), low, high);
    tracked->inner_radius_m = 0.5F * floats_from_bullet(high - low).minCoeff();
    bodies_[id] = std::move(tracked);
}

void PeopleContacts::remove(std::uint32_t id) { bodies_.erase(id); }

void PeopleContacts::mark_teleported(std::uint32_t id) {
    const auto found = bodies_.find(id);
    if (found == bodies_.end()) return;
    found->second->is_teleported = true;
    found->second->escaping_from.clear();
    found->second->grips.clear();
}

void PeopleContacts::forget_person(const std::string& name) {
    for (auto& [id, tracked] : bodies_) {
        if (tracked->escaping_from == name) tracked->escaping_from.clear();
        tracked->grips.erase(name);
    }
}

void PeopleContacts::begin_tick(const PeopleField& people, double tick_s) {
    end_tick();
    is_touched_ = false;
    num_touches_ = 0;
    ++tick_;
    for (auto& [id, tracked] : bodies_) begin_body(*tracked, people, tick_s);
}

void PeopleContacts::end_tick() {
    for (std::size_t i = 0; i < num_used_; ++i) dispatcher_.releaseManifold(carriers_[i]->manifold);
    num_used_ = 0;
}

void PeopleContacts::begin_body(Tracked& tracked, const PeopleField& people, double tick_s) {
    if (!tracked.escaping_from.empty() && move_out(tracked, people)) return;
    const ContactMotion motion = motion_of(*tracked.body);
    if (!motion.world_from_body.matrix().allFinite()) return;
    if (tracked.is_teleported) {
        const auto is_around_one = [&](const auto& person) {
            return is_around(tracked, person.second) && !is_inside(tracked, person.second);
        };
        const auto& all = people.people();
        tracked.is_teleported = std::any_of(all.begin(), all.end(), is_around_one);
        if (tracked.is_teleported) return;
    }
    std::size_t num_resisting = 0;
    const std::size_t num_before = num_used_;
    const std::size_t num_touches_before = num_touches_;
    for (const auto& [name, person] : people.people()) {
        if (!person.surfels().is_near(motion.low, motion.high) && person.max_speed_mps() == 0.0F &&
            motion.linear_velocity.isZero()) {
            tracked.grips.erase(name);
            continue;
        }
        const auto contacts = finder_.find(tracked.surface, motion, person, tick_s);
        float deepest_m = 0.0F;
        for (const PersonContact& c : contacts) deepest_m = std::min(deepest_m, c.distance_m);
        const bool may_be_inside = finder_.num_near() == 0
                                       ? (tick_ + tracked.id) % options_.ticks_per_check == 0
                                       : deepest_m < -options_.deep_radii * tracked.inner_radius_m;
        if (may_be_inside && is_inside(tracked, person)) {
            tracked.escaping_from = name;
            ++num_escapes_;
            is_touched_ = true;
            // nobody holds it while it is moved out
            while (num_used_ > num_before) {
                dispatcher_.releaseManifold(carriers_[--num_used_]->manifold);
            }
            num_touches_ = num_touches_before;
            move_out(tracked, people);
            return;
        }
        if (contacts.empty()) {
            tracked.grips.erase(name);
            continue;
        }
        GripCorrection& grip = tracked.grips.try_emplace(name, options_.grip).first->second;
        grip.update(motion, person, contacts, finder_.turning());
        Surface surface{finder_.turning() + grip.turning(), grip};
        surface.share = 1.0F / static_cast<float>(contacts.size());
        for (const PersonContact& c : contacts) {
            surface.resists_rolling = num_resisting++ < options_.num_rolling;
            if (insert(tracked, c, surface, tick_s)) note_touch(name, tracked, c);
        }
    }
    if (num_used_ > num_before) tracked.body->activate();
}

bool PeopleContacts::is_inside(const Tracked& tracked, const PersonField& person) const {
    const Eigen::Vector3f centre =
        floats_from_bullet(tracked.body->getWorldTransform().getOrigin());
    if (!person.surfels().is_near(centre, centre)) return false;
    const PlacedSurfel* nearest =
        person.nearest(centre, options_.escape_search_m, [](const PlacedSurfel&) { return true; });
    if (nearest == nullptr) return false;
    // most surfels at about this distance must face away from the centre
    const float within_m = 1.3F * (nearest->position - centre).norm() + 0.01F;
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(within_m);
    int num = 0;
    int num_behind = 0;
    person.surfels().visit_box(centre - reach, centre + reach, [&](const PlacedSurfel& s) {
        const Eigen::Vector3f offset = centre - s.position;
        if (offset.squaredNorm() > within_m * within_m) return;
        ++num;
        num_behind += s.normal.dot(offset) < 0.0F ? 1 : 0;
    });
    return num >= 3 && 4 * num_behind >= 3 * num;
}

// True if part of a person's surface is deep in the object.
bool PeopleContacts::is_around(const Tracked& tracked, const PersonField& person) const {
    btVector3 low, high;
    tracked.body->getAabb(low, high);
    const btTransform body_from_world = tracked.body->getWorldTransform().inverse();
    const btCollisionShape& shape = *tracked.body->getCollisionShape();
    const float around_m = options_.around_m;
    bool is_around = false;
    person.surfels().visit_box(
        floats_from_bullet(low), floats_from_bullet(high), [&](const PlacedSurfel& s) {
            if (is_around) return;
            const auto at = distance_to_shape(shape, body_from_world * to_bullet(s.position), 0);
            is_around = at && at->distance < -around_m;
        });
    return is_around;
}

// Moves an object inside a person towards the nearest surface. Returns false when it is out.
bool PeopleContacts::move_out(Tracked& tracked, const PeopleField& people) {
    const auto person = people.people().find(tracked.escaping_from);
    const Eigen::Vector3f centre =
        floats_from_bullet(tracked.body->getWorldTransform().getOrigin());
    const PlacedSurfel* nearest = nullptr;
    if (person != people.people().end()) {
        nearest = person->second.nearest(
            centre, options_.escape_search_m, [](const PlacedSurfel& surfel) {
                return surfel.normal.z() > -0.5F;  // not down through the soles
            });
    }
    if (nearest == nullptr || nearest->normal.dot(centre - nearest->position) > 0.0F) {
        tracked.escaping_from.clear();
        return false;
    }
    const Eigen::Vector3f velocity = floats_from_bullet(tracked.body->getLinearVelocity());
    const float missing_mps =
        static_cast<float>(options_.escape_mps) - velocity.dot(nearest->normal);
    if (missing_mps > 0.0F) {
        tracked.body->setLinearVelocity(
            to_bullet((velocity + missing_mps * nearest->normal).eval()));
    }
    tracked.body->activate();
    return true;
}

void PeopleContacts::note_touch(const std::string& person,
                                const Tracked& tracked,
                                const PersonContact& at) {
    if (num_touches_ == kMaxPersonTouches) return;
    if (num_touches_ == touches_.size()) touches_.emplace_back();
    PersonTouch& touch = touches_[num_touches_++];
    touch.person = person;
    touch.object = tracked.id;
    touch.point = at.point - at.distance_m * at.normal;
}

bool PeopleContacts::insert(Tracked& tracked,
                            const PersonContact& contact,
                            const Surface& surface,
                            double tick_s) {
    if (num_used_ == carriers_.size()) {
        carriers_.push_back(
            std::make_unique<Carrier>(kFirstCarrierIndex + static_cast<int>(num_used_)));
    }
    Carrier& carrier = *carriers_[num_used_++];
    const btVector3 on_person =
        to_bullet((contact.point - contact.distance_m * contact.normal).eval());
    btTransform place = btTransform::getIdentity();
    place.setOrigin(on_person);
    carrier.body.setWorldTransform(place);
    // along the surface only: the spring handles the depth
    const Eigen::Vector3f centre =
        floats_from_bullet(tracked.body->getWorldTransform().getOrigin());
    Eigen::Vector3f behind = surface.grip.velocity_at(contact.point - centre);
    behind -= contact.normal * contact.normal.dot(behind);
    carrier.body.setLinearVelocity(to_bullet((contact.velocity + behind).eval()));
    carrier.body.setAngularVelocity(to_bullet(surface.turning));
    carrier.body.setCompanionId(-1);  // clears what the solver cached in the previous tick
    carrier.manifold = dispatcher_.getNewManifold(tracked.body, &carrier.body);

    const btVector3 on_object = to_bullet(contact.point);
    const float depth_m = -contact.distance_m;
    const float closing_mps = (contact.distance_m - contact.after_m) / static_cast<float>(tick_s);
    const bool is_hit = closing_mps > options_.hit_mps && contact.after_m < 0.0F;
    const float reported_m =
        std::clamp(contact.distance_m, -options_.reported_depth_m, is_hit ? 0.0F : 1.0F);
    btManifoldPoint point(tracked.body->getWorldTransform().invXform(on_object),
                          btVector3(0, 0, 0),
                          to_bullet(contact.normal),
                          reported_m);
    point.m_positionWorldOnA = on_object;
    point.m_positionWorldOnB = on_person;
    const auto friction = static_cast<float>(options_.friction);
    point.m_combinedFriction = std::sqrt(friction * tracked.body->getFriction());
    point.m_combinedRestitution =
        std::max(static_cast<float>(options_.restitution), 0.5F * tracked.body->getRestitution());
    if (surface.resists_rolling) {
        point.m_combinedRollingFriction = options_.rolling_lever * tracked.inner_radius_m;
        point.m_combinedSpinningFriction = options_.spinning_lever * tracked.inner_radius_m;
    }
    if (!is_hit) {
        const auto tick = static_cast<float>(tick_s);
        const float rate =
            options_.stiffness * tick + options_.damping;  // [1/s] of an implicit step
        const float mass_kg = surface.share / tracked.body->getInvMass();
        point.m_contactPointFlags |=
            BT_CONTACT_FLAG_HAS_CONTACT_CFM | BT_CONTACT_FLAG_HAS_CONTACT_ERP;
        point.m_contactCFM = 1.0F / (mass_kg * rate);
        point.m_contactERP =
            depth_m > 0.0F ? options_.stiffness / rate * depth_m * tick / -reported_m : 0.0F;
    }
    carrier.manifold->addManifoldPoint(point);
    // a contact that would penetrate within this tick is stopped or driven within it
    const bool is_touch = contact.distance_m <= options_.contact_m || contact.after_m < 0.0F;
    is_touched_ = is_touched_ || is_touch;
    return is_touch;
}

}  // namespace atrium::physics
