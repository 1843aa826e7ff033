#include "world_server/physics/soft_body.hpp"

#include "world_server/physics/bullet_types.hpp"
#include "world_server/physics/people_field.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr double kPartS = 1.0 / 480.0;
constexpr int kMaxParts = 16;
constexpr int kPasses = 2;                // over links and contacts, in a part
constexpr int kRopePasses = 12;           // a rope has few links, and may carry much
constexpr btScalar kLooseStretch = 1.6F;  // times its length: a link that slips out of hands
constexpr btScalar kTornExtents = 2.5F;   // times its size at rest: what is no more to be believed
// Nodes further apart than about two fingers let them through: there the middles of faces count
// too.
constexpr double kFingersM = 0.025;
// Of people against what is soft. More jams a ball between hand and floor, where it ought to roll.
constexpr double kSkinFriction = 0.7;
constexpr btScalar kInnerDampingHz = 4;     // at which what moves against the whole is slowed
constexpr btScalar kMaxVolumeStep = 0.02F;  // share of the volume that is set right in one part
// How far from where its shape would have it, in radii, a node begins to be pulled back harder;
// over what range, and to what share of the way in each part.
constexpr btScalar kDentStart = 0.15F;
constexpr btScalar kDentRange = 0.35F;
constexpr btScalar kDentShare = 0.15F;
// A person's surface nearer to the middle of a volume than this, in radii, moves it as a whole.
constexpr float kKeepOffRadii = 0.7F;
constexpr btScalar kKeepOffMps = 0.5F;
constexpr float kLeavingMps = 0.5F;  // a surface that moves away faster is not one that pushes
constexpr float kBuriedSearchM = 0.5F;
constexpr btScalar kLinkDampingHz = 15;  // at which the ends of a link stop moving apart
constexpr btScalar kCalmMps = 0.02F;     // what moves slower, on average, is coming to rest
constexpr btScalar kCalmDampingHz = 4;

// From the 0..1 of a description to what a pass of the solver undoes of an error: the ear and the
// hand judge stiffness by its logarithm.
double between(double softest, double stiffest, double stiffness) {
    return softest * std::pow(stiffest / softest, stiffness);
}

btScalar limited(btScalar v, btScalar limit) { return std::clamp(v, -limit, limit); }

}  // namespace

SoftBody::SoftBody(const SoftObject& object, btSoftBodyWorldInfo& info, const WorldOptions& options)
    : object_(object), options_(options), mesh_(make_soft_mesh(object)) {
    assert(!find_problem(object));
    num_parts_ = std::clamp(static_cast<int>(std::lround(options.tick_s / kPartS)), 1, kMaxParts);
    contact_options_.tick_s = btScalar(options.tick_s);
    contact_options_.friction = btScalar(object.friction);
    contact_options_.person_friction = btScalar(kSkinFriction);
    contact_options_.thickness_m = btScalar(0.005);
    if (object.shape == SoftShape::kCloth) {
        contact_options_.thickness_m = btScalar(std::max(0.005, object.size_m.z() / 2.0));
    } else if (object.shape == SoftShape::kRope) {
        contact_options_.thickness_m = btScalar(object.size_m.y() / 2.0);
    }
    make_body(info);
    make_samples();
    find_bounds();
    rest_extent_ = (body_->m_bounds[1] - body_->m_bounds[0]).length();
    if (object.shape == SoftShape::kRope) rest_extent_ = btScalar(object.size_m.x());
}

SoftBody::~SoftBody() = default;

void SoftBody::make_body(btSoftBodyWorldInfo& info) {
    std::vector<btScalar> masses;
    for (std::size_t i = 0; i < mesh_.nodes.size(); ++i) {
        start_.push_back(to_bullet((object_.world_from_object * mesh_.nodes[i]).eval()));
        masses.push_back(btScalar(object_.mass_kg * mesh_.shares[i]));
    }
    const int num_nodes = static_cast<int>(start_.size());
    body_ = std::make_unique<btSoftBody>(&info, num_nodes, start_.data(), masses.data());
    body_->m_cfg.collisions = 0;
    body_->getCollisionShape()->setMargin(contact_options_.thickness_m);

    btSoftBody::Material& along = *body_->m_materials[0];
    btSoftBody::Material& across = *body_->appendMaterial();
    along.m_kLST = has_volume() ? btScalar(between(0.02, 0.5, object_.stiffness)) : 1;
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
    loose_.assign(start_.size(), 0);
    if (!has_volume()) return;
    body_->setPose(/*bvolume=*/false, /*bframe=*/true);
    match_share_ = btScalar(between(0.006, 0.12, object_.stiffness));
    gradients_.assign(start_.size(), btVector3(0, 0, 0));
    rest_volume_ = btScalar(volume_m3());
    // the gradient of the volume is along the normal
    find_gradients();
    rest_outward_ = gradients_;
    for (btVector3& out : rest_outward_) {
        if (out.length2() > 0) out.normalize();
    }
    outward_ = rest_outward_;
    find_bounds();
    const btVector3 extents = body_->m_bounds[1] - body_->m_bounds[0];
    inner_radius_ = btScalar(0.5) * extents[extents.minAxis()];
}

void SoftBody::make_samples() {
    for (std::uint32_t i = 0; i < start_.size(); ++i) samples_.push_back({{i, i, i}, {1, 0, 0}});
    btScalar longest = 0;
    for (int i = 0; i < body_->m_links.size(); ++i) {
        const btSoftBody::Link& link = body_->m_links[i];
        if (!mesh_.links[static_cast<std::size_t>(i)].bends) longest = std::max(longest, link.m_rl);
    }
    if (longest <= btScalar(kFingersM)) return;
    for (const auto& t : mesh_.topology.triangles) {
        const btScalar third = btScalar(1) / 3;
        samples_.push_back({{t[0], t[1], t[2]}, {third, third, third}});
    }
    for (const auto& s : mesh_.topology.segments) {
        samples_.push_back({{s[0], s[1], s[1]}, {btScalar(0.5), btScalar(0.5), 0}});
    }
}

bool SoftBody::tie(const std::function<btRigidBody*(std::uint32_t id)>& find) {
    std::vector<Tie> ties;
    for (const SoftPin& pin : object_.pins) {
        if (pin.object_id == 0) continue;
        btRigidBody* body = find(pin.object_id);
        if (body == nullptr) return false;
        for (const std::uint32_t node : nodes_at(mesh_, object_, pin)) {
            Tie tie;
            tie.node = node;
            tie.body = body;
            tie.place = body->getWorldTransform().invXform(start_[node]);
            ties.push_back(tie);
        }
    }
    ties_ = std::move(ties);
    return true;
}

void SoftBody::untie(const btRigidBody& body) {
    std::erase_if(ties_, [&](const Tie& tie) { return tie.body == &body; });
}

void SoftBody::step(const SoftSurroundings& surroundings) {
    find_loose();
    find_bounds();
    drives_.clear();
    if (has_volume()) {
        body_->updatePose();
        for (std::size_t i = 0; i < outward_.size(); ++i) {
            outward_[i] = body_->m_pose.m_rot * rest_outward_[i];
        }
    }
    const bool meets_people =
        surroundings.people != nullptr && (!has_volume() || keep_off(*surroundings.people));
    contacts_.find(*body_,
                   samples_,
                   loose_,
                   outward_,
                   meets_people ? surroundings.people : nullptr,
                   surroundings.bodies,
                   contact_options_);
    begin_ties();
    const int num_passes = object_.shape == SoftShape::kRope ? kRopePasses : kPasses;
    const btScalar part_s = contact_options_.tick_s / btScalar(num_parts_);
    for (int part = 1; part <= num_parts_; ++part) {
        const btScalar left_s = part_s * btScalar(num_parts_ - part);
        for (const Drive& d : drives_) drive(d);
        move_freely(part_s);
        contacts_.begin_part();
        if (has_volume()) match_shape();
        for (int pass = 0; pass < num_passes; ++pass) {
            btSoftBody::PSolve_Links(body_.get(), 1, 0);
            if (has_volume() && pass == 0) keep_volume();
            solve_ties(part_s, left_s);
            contacts_.solve(*body_, part_s, left_s, contact_options_);
        }
        end_part(part_s);
    }
    has_volume() ? damp_inside(contact_options_.tick_s) : damp_links(contact_options_.tick_s);
    calm_down(contact_options_.tick_s);
    const btScalar extent = (body_->m_bounds[1] - body_->m_bounds[0]).length();
    num_torn_ticks_ = extent > kTornExtents * rest_extent_ ? num_torn_ticks_ + 1 : 0;
}

void SoftBody::find_loose() {
    std::fill(loose_.begin(), loose_.end(), std::uint8_t{0});
    if (has_volume()) return;
    for (int i = 0; i < body_->m_links.size(); ++i) {
        const btSoftBody::Link& link = body_->m_links[i];
        if (mesh_.links[static_cast<std::size_t>(i)].bends) continue;
        const btScalar limit = kLooseStretch * link.m_rl;
        if ((link.m_n[0]->m_x - link.m_n[1]->m_x).length2() < limit * limit) continue;
        for (const std::uint32_t node : mesh_.links[static_cast<std::size_t>(i)].nodes) {
            loose_[node] = 1;
        }
    }
}

// Of the way through the coming tick, with what it may be in touch with.
void SoftBody::find_bounds() {
    const btScalar reach = contact_options_.thickness_m + contact_options_.margin_m;
    btVector3 low = start_[0], high = start_[0];
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        const btVector3 end = node.m_x + node.m_v * contact_options_.tick_s;
        if (i == 0) low = high = node.m_x;
        low.setMin(node.m_x);
        low.setMin(end);
        high.setMax(node.m_x);
        high.setMax(end);
    }
    body_->m_bounds[0] = low - btVector3(reach, reach, reach);
    body_->m_bounds[1] = high + btVector3(reach, reach, reach);
}

void SoftBody::move_freely(btScalar part_s) {
    const btVector3 fall = to_bullet(options_.gravity) * part_s;
    const btScalar kept = std::exp(-btScalar(object_.damping_hz) * part_s);
    const btScalar max_speed = btScalar(options_.max_speed_mps);
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_q = node.m_x;
        if (!(node.m_im > 0)) {
            node.m_v.setZero();
            continue;
        }
        node.m_v = (node.m_v + fall) * kept;
        const btScalar speed = node.m_v.length();
        if (speed > max_speed) node.m_v *= max_speed / speed;
        node.m_x += node.m_v * part_s;
    }
}

// Each node goes a part of its way to where it would be in the shape at rest, moved and turned to
// where the nodes now are (Müller et al., "Meshless Deformations Based on Shape Matching", 2005).
// The further a node is out of shape the larger the part: else a few nodes with a fist behind them
// would go through the whole body before they move it.
void SoftBody::match_shape() {
    body_->updatePose();
    const btSoftBody::Pose& pose = body_->m_pose;
    btVector3 moved(0, 0, 0);  // [kg m]
    btScalar mass = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        if (!(node.m_im > 0)) continue;
        const btVector3 way = pose.m_com + pose.m_rot * pose.m_pos[i] - node.m_x;
        const btScalar out = (way.length() / inner_radius_ - kDentStart) / kDentRange;
        const btScalar over = std::clamp(out, btScalar(0), btScalar(1));
        const btVector3 step = way * (match_share_ + (kDentShare - match_share_) * over * over);
        node.m_x += step;
        moved += step / node.m_im;
        mass += 1 / node.m_im;
    }
    // unequal parts would move the whole: what one side gives the other must take
    const btVector3 back = moved / mass;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        if (node.m_im > 0) node.m_x -= back;
    }
}

// Six times the volume, and six times its gradient by the place of each node.
btScalar SoftBody::find_gradients() {
    std::fill(gradients_.begin(), gradients_.end(), btVector3(0, 0, 0));
    const btVector3 origin = body_->m_pose.m_com;
    btScalar volume = 0;
    for (const auto& t : mesh_.topology.triangles) {
        const btVector3 a = body_->m_nodes[static_cast<int>(t[0])].m_x - origin;
        const btVector3 b = body_->m_nodes[static_cast<int>(t[1])].m_x - origin;
        const btVector3 c = body_->m_nodes[static_cast<int>(t[2])].m_x - origin;
        const btVector3 bc = b.cross(c);
        volume += a.dot(bc);
        gradients_[t[0]] += bc;
        gradients_[t[1]] += c.cross(a);
        gradients_[t[2]] += a.cross(b);
    }
    return volume;
}

// Moves the nodes along the gradient of the volume, the lighter the further.
void SoftBody::keep_volume() {
    const btScalar volume = find_gradients();
    btScalar weight = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        weight += body_->m_nodes[i].m_im * gradients_[static_cast<std::size_t>(i)].length2();
    }
    if (!(weight > 0)) return;
    const btScalar missing = limited(6 * rest_volume_ - volume, 6 * kMaxVolumeStep * rest_volume_);
    const btScalar push = missing / weight;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_x += gradients_[static_cast<std::size_t>(i)] * (push * node.m_im);
    }
}

void SoftBody::begin_ties() {
    for (Tie& tie : ties_) {
        const btVector3 arm = tie.body->getWorldTransform().getBasis() * tie.place;
        tie.velocity = tie.body->getVelocityInLocalPoint(arm);
        tie.shift.setZero();
    }
}

void SoftBody::solve_ties(btScalar part_s, btScalar left_s) {
    for (Tie& tie : ties_) {
        btSoftBody::Node& node = body_->m_nodes[static_cast<int>(tie.node)];
        const btTransform& pose = tie.body->getWorldTransform();
        const btVector3 arm = pose.getBasis() * tie.place;
        const btVector3 gained = tie.body->getVelocityInLocalPoint(arm) - tie.velocity;
        const btVector3 place =
            pose.getOrigin() + arm - tie.velocity * left_s + tie.shift + gained * part_s;
        // how far node and place move apart under an impulse
        const btScalar share = node.m_im + tie.body->getInvMass();
        btMatrix3x3 cross;
        arm.getSkewSymmetricMatrix(&cross[0], &cross[1], &cross[2]);
        btMatrix3x3 apart = cross * tie.body->getInvInertiaTensorWorld() * cross;
        apart = btMatrix3x3(share, 0, 0, 0, share, 0, 0, 0, share) - apart;
        const btScalar determinant = apart.determinant();
        if (!(determinant > 0)) continue;
        const btVector3 impulse = apart.inverse() * (place - node.m_x);
        node.m_x += impulse * node.m_im;
        if (tie.body->getInvMass() > 0) {
            tie.body->applyImpulse(-impulse / part_s, arm);
            tie.body->activate();
        }
    }
}

void SoftBody::end_part(btScalar part_s) {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_v = (node.m_x - node.m_q) / part_s;
    }
    contacts_.end_part(*body_, part_s, contact_options_);
    for (Tie& tie : ties_) {
        const btVector3 arm = tie.body->getWorldTransform().getBasis() * tie.place;
        tie.shift += (tie.body->getVelocityInLocalPoint(arm) - tie.velocity) * part_s;
    }
}

// Slows the ends of links against each other, along the links.
void SoftBody::damp_links(btScalar seconds) {
    const btScalar lost = 1 - std::exp(-kLinkDampingHz * seconds);
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

// What hardly moves comes to rest; else it would roll and sway for minutes.
void SoftBody::calm_down(btScalar seconds) {
    btScalar mass = 0, energy = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        if (!(node.m_im > 0)) continue;
        mass += 1 / node.m_im;
        energy += node.m_v.length2() / node.m_im;
    }
    if (energy > kCalmMps * kCalmMps * mass) return;
    const btScalar kept = std::exp(-kCalmDampingHz * seconds);
    for (int i = 0; i < body_->m_nodes.size(); ++i) body_->m_nodes[i].m_v *= kept;
}

// Slows what moves otherwise than a rigid body would; fall and spin stay.
void SoftBody::damp_inside(btScalar seconds) {
    if (!has_volume()) return;
    btVector3 centre(0, 0, 0), momentum(0, 0, 0), spin(0, 0, 0);
    btScalar mass = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        if (!(node.m_im > 0)) return;  // a pinned one neither falls nor spins freely
        mass += 1 / node.m_im;
        centre += node.m_x / node.m_im;
        momentum += node.m_v / node.m_im;
    }
    centre /= mass;
    const btVector3 velocity = momentum / mass;
    btMatrix3x3 inertia(0, 0, 0, 0, 0, 0, 0, 0, 0);
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        const btVector3 arm = node.m_x - centre;
        spin += arm.cross(node.m_v - velocity) / node.m_im;
        btMatrix3x3 cross;
        arm.getSkewSymmetricMatrix(&cross[0], &cross[1], &cross[2]);
        inertia -= (cross * cross) * (1 / node.m_im);
    }
    if (!(inertia.determinant() > 0)) return;
    const btVector3 turn = inertia.inverse() * spin;
    const btScalar lost = 1 - std::exp(-kInnerDampingHz * seconds);
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_v += lost * (velocity + turn.cross(node.m_x - centre) - node.m_v);
    }
}

void SoftBody::drive(const Drive& drive) {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        const btScalar missing = drive.speed - node.m_v.dot(drive.out);
        if (node.m_im > 0 && missing > 0) node.m_v += drive.out * missing;
    }
}

// A surface that has come near the middle of a volume drives all of it before itself, whatever its
// few nodes in touch achieve. A volume whose middle is inside a person has that person all around
// or through it, where no contact leads out: it goes to the nearest surface, without contacts.
bool SoftBody::keep_off(const PeopleField& people) {
    const Eigen::Vector3f at = centre().cast<float>();
    const Eigen::Vector3f velocity = mean_velocity();
    const float reach = kKeepOffRadii * inner_radius_;
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(reach);
    for (const auto& [name, person] : people.people()) {
        const PlacedSurfel* nearest = nullptr;
        float nearest_sq = reach * reach;
        person.surfels().visit_box(at - around, at + around, [&](const PlacedSurfel& s) {
            const float distance_sq = (at - s.position).squaredNorm();
            if (distance_sq >= nearest_sq) return;
            if (s.normal.dot(velocity - s.velocity) > kLeavingMps) return;
            nearest_sq = distance_sq;
            nearest = &s;
        });
        if (nearest != nullptr && nearest->normal.dot(at - nearest->position) >= 0.0F) {
            const btVector3 out(nearest->normal.x(), nearest->normal.y(), nearest->normal.z());
            const btScalar near = 1 - std::sqrt(nearest_sq) / reach;
            drives_.push_back({out, nearest->normal.dot(nearest->velocity) + kKeepOffMps * near});
            continue;
        }
        const PlacedSurfel* side = person.nearest(
            at, kBuriedSearchM, [](const PlacedSurfel& s) { return s.normal.z() > -0.5F; });
        if (side == nullptr || side->normal.dot(at - side->position) > 0.0F) continue;
        drives_.push_back({to_bullet(side->normal.cast<double>()), btScalar(options_.escape_mps)});
        return false;
    }
    return true;
}

void SoftBody::put_back() {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        btSoftBody::Node& node = body_->m_nodes[i];
        node.m_x = node.m_q = start_[static_cast<std::size_t>(i)];
        node.m_v.setZero();
    }
    num_torn_ticks_ = 0;
    find_bounds();
}

bool SoftBody::is_finite() const {
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        // a sum of what is not finite is not finite
        const btScalar sum = node.m_x.dot(node.m_x) + node.m_v.dot(node.m_v);
        if (!std::isfinite(sum)) return false;
    }
    return true;
}

Eigen::Vector3d SoftBody::centre() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < body_->m_nodes.size(); ++i) sum += from_bullet(body_->m_nodes[i].m_x);
    return sum / body_->m_nodes.size();
}

Eigen::Vector3f SoftBody::mean_velocity() const {
    btVector3 sum(0, 0, 0);
    for (int i = 0; i < body_->m_nodes.size(); ++i) sum += body_->m_nodes[i].m_v;
    sum /= btScalar(body_->m_nodes.size());
    return {sum.x(), sum.y(), sum.z()};
}

double SoftBody::kinetic_energy_j() const {
    double energy = 0.0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body_->m_nodes[i];
        if (node.m_im > 0) energy += 0.5 * double(node.m_v.length2()) / double(node.m_im);
    }
    return energy;
}

double SoftBody::volume_m3() const {
    const Eigen::Vector3d origin = centre();
    const auto at = [&](std::uint32_t i) {
        return (from_bullet(body_->m_nodes[static_cast<int>(i)].m_x) - origin).eval();
    };
    double volume = 0.0;
    if (!has_volume()) return volume;
    for (const auto& t : mesh_.topology.triangles) {
        volume += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0;
    }
    return volume;
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
    find_bounds();
    return true;
}

}  // namespace atrium::physics
