#include "world_server/physics/soft/soft_soft_contacts.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

MovingFace face_of(const btSoftBody& soft, const std::array<std::uint32_t, 3>& triangle) {
    MovingFace face;
    face.velocity.setZero();
    for (int i = 0; i < 3; ++i) {
        face.nodes[i] = triangle[static_cast<std::size_t>(i)];
        const btSoftBody::Node& node = soft.m_nodes[static_cast<int>(face.nodes[i])];
        face.corners[i] = node.m_x;
        face.velocity += node.m_v / 3;
    }
    return face;
}

// Position of a sample, now and before the substep.
struct Place {
    btVector3 now{0, 0, 0};
    btVector3 before{0, 0, 0};
};

Place place_of(const btSoftBody& soft, const SoftSample& sample) {
    Place place;
    for (int i = 0; i < 3; ++i) {
        const btSoftBody::Node& node = soft.m_nodes[static_cast<int>(sample.nodes[i])];
        place.now += sample.weights[i] * node.m_x;
        place.before += sample.weights[i] * node.m_q;
    }
    return place;
}

void push(btSoftBody& soft, const SoftSample& sample, const btVector3& impulse_ns) {
    for (int i = 0; i < 3; ++i) {
        btSoftBody::Node& node = soft.m_nodes[static_cast<int>(sample.nodes[i])];
        node.m_v += impulse_ns * (node.m_im * sample.weights[i]);
    }
}

}  // namespace

void SoftSoftContacts::find(std::span<const SoftSurface> surfaces, btScalar tick_s) {
    contacts_.clear();
    tick_s_ = tick_s;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const btSoftBody& a = *surfaces[i].body;
        for (std::size_t j = i + 1; j < surfaces.size(); ++j) {
            const btSoftBody& b = *surfaces[j].body;
            if (!TestAabbAgainstAabb2(a.m_bounds[0], a.m_bounds[1], b.m_bounds[0], b.m_bounds[1]))
                continue;
            find_with(surfaces[i], surfaces[j], tick_s);
            find_with(surfaces[j], surfaces[i], tick_s);
        }
    }
}

void SoftSoftContacts::find_with(const SoftSurface& sampled,
                                 const SoftSurface& faced,
                                 btScalar tick_s) {
    if (faced.topology->triangles.empty()) return;
    // only in the overlap of the bounds
    Box common{sampled.body->m_bounds[0], sampled.body->m_bounds[1]};
    common.low.setMax(faced.body->m_bounds[0]);
    common.high.setMin(faced.body->m_bounds[1]);
    ContactLimits limits;
    limits.tick_s = tick_s;
    limits.gap_m = sampled.thickness_m + faced.thickness_m;
    limits.margin_m = options_.margin_m;
    limits.from_inside = options_.from_inside;
    // a cloth or rope counts as behind a face only if the face belongs to a volume that can hold it
    limits.depth_m = faced.outward.empty() ? sampled.depth_m : faced.depth_m;

    faces_.clear();
    for (const auto& triangle : faced.topology->triangles) {
        MovingFace face = face_of(*faced.body, triangle);
        face.is_skin = !faced.outward.empty();
        if (touch(common, swept_bounds(face, limits))) faces_.add(face, limits);
    }
    if (faces_.empty()) return;
    faces_.sort();

    const btScalar friction = std::sqrt(sampled.friction * faced.friction);
    for (const SoftSample& sample : sampled.samples) {
        const SampleMotion motion = motion_of(*sampled.body, sample);
        const btVector3* outward =
            sampled.outward.empty() ? nullptr : &sampled.outward[sample.nodes[0]];
        const Box box = swept_bounds(motion, outward, limits);
        if (!touch(common, box)) continue;
        std::optional<FaceContact> first;
        const MovingFace* face = nullptr;
        faces_.visit_box(box, [&](const MovingFace& candidate) {
            const auto face_contact = find_contact(motion, candidate, outward, limits);
            if (!face_contact || (first && first->way <= face_contact->way)) return;
            first = face_contact;
            face = &candidate;
        });
        if (!first) continue;
        Contact contact;
        contact.body[0] = sampled.body;
        contact.body[1] = faced.body;
        contact.place[0] = sample;
        for (int i = 0; i < 3; ++i) {
            contact.place[1].nodes[i] = face->nodes[i];
            contact.place[1].weights[i] = first->weights[i];
        }
        contact.normal = first->normal;
        contact.gap_m = limits.gap_m;
        contact.depth_m = std::max(btScalar(0), limits.gap_m - first->distance);
        contact.friction = friction;
        contact.inverse_mass[0] = motion.inverse_mass;
        contact.inverse_mass[1] = motion_of(*faced.body, contact.place[1]).inverse_mass;
        if (contact.inverse_mass[0] + contact.inverse_mass[1] > 0) contacts_.push_back(contact);
    }
}

void SoftSoftContacts::begin_substep() {
    for (Contact& c : contacts_) {
        c.normal_correction = 0;
        c.friction_correction.setZero();
    }
}

void SoftSoftContacts::solve(btScalar left_s) {
    const btScalar done_s = tick_s_ - left_s;
    const btScalar recovery_mps = options_.recovery_mps;
    for (Contact& c : contacts_) {
        const Place a = place_of(*c.body[0], c.place[0]), b = place_of(*c.body[1], c.place[1]);
        const btScalar both = c.inverse_mass[0] + c.inverse_mass[1];
        const btScalar allowed = -std::max(btScalar(0), c.depth_m - recovery_mps * done_s);
        const btScalar height = c.normal.dot(a.now - b.now) - c.gap_m;
        btVector3 impulse(0, 0, 0);
        if (height < allowed) {
            const btScalar press = (allowed - height) / both;
            c.normal_correction += press;
            impulse = c.normal * press;
        }
        if (c.normal_correction <= 0) continue;
        btVector3 slip = a.now - a.before - (b.now - b.before);
        slip -= c.normal * c.normal.dot(slip);
        // bounds the friction of a substep by its total pressure
        const btVector3 wanted = c.friction_correction - slip / both;
        const btScalar most = c.friction * c.normal_correction;
        const btScalar size = wanted.length();
        const btVector3 held = size > most ? wanted * (most / size) : wanted;
        impulse += held - c.friction_correction;
        c.friction_correction = held;
        move(*c.body[0], c.place[0], impulse);
        move(*c.body[1], c.place[1], -impulse);
    }
}

void SoftSoftContacts::end_substep() {
    for (const Contact& c : contacts_) {
        if (c.normal_correction <= 0 || c.depth_m <= 0) continue;
        const btScalar out = c.normal.dot(motion_of(*c.body[0], c.place[0]).velocity -
                                          motion_of(*c.body[1], c.place[1]).velocity);
        if (!(out > 0)) continue;
        const btVector3 impulse_ns = c.normal * (std::min(out, options_.recovery_mps) /
                                                 (c.inverse_mass[0] + c.inverse_mass[1]));
        push(*c.body[0], c.place[0], -impulse_ns);
        push(*c.body[1], c.place[1], impulse_ns);
    }
}

}  // namespace atrium::physics
