#include "world_server/physics/soft/soft_scenery.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <array>
#include <optional>

namespace atrium::physics {
namespace {

constexpr btScalar kBesideEdge_m = 1e-4F;  // what passes between two faces, by rounding, meets one
constexpr btScalar kInFront_m = 1e-4F;

// Collects the triangles that Bullet's tree reports.
class FaceCollector final : public btTriangleCallback {
public:
    FaceCollector(const btRigidBody& body, const ContactLimits& limits, FaceIndex& faces)
        : body_(body), limits_(limits), faces_(faces) {}
    void processTriangle(btVector3* corners, int /*part*/, int /*triangle*/) override {
        MovingFace face;
        face.velocity.setZero();
        face.friction = body_.getFriction();
        for (int i = 0; i < 3; ++i) face.corners[i] = body_.getWorldTransform() * corners[i];
        faces_.add(face, limits_);
    }

private:
    const btRigidBody& body_;
    const ContactLimits& limits_;
    FaceIndex& faces_;
};

// Keeps the nearest contact for each direction, three at most.
class NearestContacts {
public:
    explicit NearestContacts(btScalar same_normal) : same_normal_(same_normal) {}
    void add(const SceneryContact& contact) {
        SceneryContact* const end = kept_.data() + num_kept_;
        SceneryContact* const same = std::find_if(kept_.data(), end, [&](const auto& kept) {
            return kept.normal.dot(contact.normal) > same_normal_;
        });
        if (same != end) {
            if (contact.way < same->way) *same = contact;
        } else if (num_kept_ < kept_.size()) {
            kept_[num_kept_++] = contact;
        }
    }
    std::span<const SceneryContact> all() const { return {kept_.data(), num_kept_}; }

private:
    btScalar same_normal_;  // cosine
    std::array<SceneryContact, 3> kept_{};
    std::size_t num_kept_ = 0;
};

Box box_around(const btVector3& a, const btVector3& b) {
    Box box{a, a};
    box.low.setMin(b);
    box.high.setMax(b);
    return box;
}

btVector3 middle_of(std::span<const SampleMotion> ways) {
    btVector3 sum(0, 0, 0);
    for (const SampleMotion& way : ways) sum += way.position;
    return sum / btScalar(ways.size());
}

}  // namespace

bool is_scenery(const btRigidBody& body) {
    return body.getCollisionShape()->getShapeType() == TRIANGLE_MESH_SHAPE_PROXYTYPE;
}

std::span<const SceneryContact> SoftScenery::find(const SoftSkin& skin,
                                                  std::span<const SampleMotion> ways,
                                                  std::span<btRigidBody* const> bodies,
                                                  const Box& bounds,
                                                  const ContactLimits& limits,
                                                  btScalar same_normal) {
    contacts_.clear();
    if (std::ranges::none_of(bodies, [](const auto* body) { return is_scenery(*body); })) return {};
    remember(skin, ways, limits.depth_m);
    collect(bodies, bounds, limits);
    for (std::size_t i = 0; i < ways.size(); ++i) {
        if (faces_.empty())
            free_[i] = ways[i].position;
        else
            find_of(i, ways[i], limits, same_normal);
    }
    return contacts_;
}

// Gives a place to samples without one: in the inside of a volume. So what overlaps a face at the
// start is pushed to one side of it.
void SoftScenery::remember(const SoftSkin& skin,
                           std::span<const SampleMotion> ways,
                           btScalar lost_m) {
    const bool has_none = free_.size() != ways.size();
    const btVector3 middle = middle_of(ways);
    free_.resize(ways.size());
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const btVector3& position = ways[i].position;
        if (!has_none && free_[i].distance2(position) <= lost_m * lost_m) continue;
        const auto outward = outward_at(skin, i);
        if (outward)
            free_[i] = skin.is_star_shaped ? middle : position - *outward * skin.depth_m;
        else
            free_[i] = position;
    }
}

void SoftScenery::collect(std::span<btRigidBody* const> bodies,
                          Box bounds,
                          const ContactLimits& limits) {
    for (const btVector3& place : free_) {
        bounds.low.setMin(place);
        bounds.high.setMax(place);
    }
    faces_.clear();
    for (const btRigidBody* body : bodies) {
        if (!is_scenery(*body)) continue;
        FaceCollector taker(*body, limits, faces_);
        const btTransform mesh_from_world = body->getWorldTransform().inverse();
        btVector3 low, high;
        btTransformAabb(bounds.low, bounds.high, 0, mesh_from_world, low, high);
        static_cast<const btBvhTriangleMeshShape&>(*body->getCollisionShape())
            .processAllTriangles(&taker, low, high);
    }
    faces_.sort();
}

void SoftScenery::find_of(std::size_t sample,
                          const SampleMotion& way,
                          const ContactLimits& limits,
                          btScalar same_normal) {
    btVector3& free = free_[sample];
    const btVector3& at = way.position;
    Box box = box_around(free, at);
    box.low.setMin(at + way.velocity * limits.tick_s);
    box.high.setMax(at + way.velocity * limits.tick_s);
    const btScalar pressed_m = free.distance(at);
    NearestContacts nearest(same_normal);
    std::optional<SceneryContact> first;  // of the faces that it was pressed through
    faces_.visit_box(box, [&](const MovingFace& face) {
        const auto crossing = find_crossing(free, at, face, kBesideEdge_m);
        if (!crossing) return;
        const SceneryContact contact{
            sample, crossing->normal, crossing->distance, crossing->way, face.friction};
        if (!first || contact.way < first->way) first = contact;
        nearest.add(contact);
    });
    faces_.visit_box(box, [&](const MovingFace& face) {
        const auto touch = find_contact(way, face, nullptr, limits);
        // the back of a face that it was pressed through, or of one beside that
        if (!touch || (first && first->normal.dot(touch->normal) < 0)) return;
        nearest.add(
            {sample, touch->normal, touch->distance, pressed_m + touch->way, face.friction});
    });
    if (way.inverse_mass > 0)
        contacts_.insert(contacts_.end(), nearest.all().begin(), nearest.all().end());
    if (!first) {
        free = at;
        return;
    }
    // follows the sample along the face
    const btVector3 beside = at + first->normal * (kInFront_m - first->distance);
    if (is_free(free, beside)) free = beside;
}

bool SoftScenery::is_free(const btVector3& from, const btVector3& to) const {
    bool is_free = true;
    faces_.visit_box(box_around(from, to), [&](const MovingFace& face) {
        if (find_crossing(from, to, face, kBesideEdge_m)) is_free = false;
    });
    return is_free;
}

}  // namespace atrium::physics
