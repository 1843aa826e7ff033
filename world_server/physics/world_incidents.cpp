// Resets or removes objects whose state is not plausible.
#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/world_impl.hpp"

namespace atrium::physics {
namespace {

constexpr std::size_t kMaxIncidents = 256;

}  // namespace

// Returns the problem of an object after a tick. Limits its speeds if there is none.
std::optional<IncidentKind> World::Impl::find_incident(ObjectBody& object) {
    if (!object.is_finite()) return IncidentKind::kNotFinite;
    const double speed = from_bullet(object.body().getLinearVelocity()).norm();
    if (speed > options.runaway_factor * options.max_speed_mps) return IncidentKind::kRunaway;
    if (object.body().isActive()) object.limit_speeds(options);
    geometry::Aabb box = box_of(options);
    if (options.leaving == LeavePolicy::kBounce) {
        box.min.array() -= options.behind_wall_m;
        box.max.array() += options.behind_wall_m;
    }
    if (!box.contains(object.centre())) return IncidentKind::kLeft;
    return std::nullopt;
}

void World::Impl::limit_depenetration() {
    for (auto& [id, object] : objects)
        if (object->moves() && object->body().isActive())
            object->limit_depenetration(centres_before[id], options);
}

void World::Impl::handle_incidents() {
    found.clear();
    handled.clear();
    for (auto& [id, object] : objects) {
        if (!object->moves()) continue;
        if (const auto kind = find_incident(*object)) found.push_back({id, *kind});
    }
    for (const auto& joint : joints.all()) {
        if (!(joint->gap_m() <= options.torn_m))
            found.push_back({joint->joint().a, IncidentKind::kTorn});
    }
    for (const Incident& incident : found) {
        // joined objects are reset together, once
        if (!handled.contains(incident.object)) act_on(incident);
    }
}

void World::Impl::act_on(const Incident& incident) {
    switch (incident.kind) {
        case IncidentKind::kNotFinite:
            ++counters.num_not_finite;
            break;
        case IncidentKind::kRunaway:
            ++counters.num_runaways;
            break;
        case IncidentKind::kTorn:
        case IncidentKind::kMisshapen:
            ++counters.num_torn;
            break;
        case IncidentKind::kLeft:
        case IncidentKind::kRemoved:
            ++counters.num_strays;
            break;
    }
    const bool removes =
        incident.kind == IncidentKind::kLeft && options.leaving == LeavePolicy::kRemove;
    if (!removes) record(incident);
    for (const std::uint32_t id : joints.group_of(incident.object)) {
        handled.insert(id);
        const auto member = objects.find(id);
        if (member == objects.end() || !member->second->moves()) continue;
        if (!removes) {
            member->second->reset_to_start();
            contacts.mark_teleported(id);
        } else if (remove(id)) {
            record({id, IncidentKind::kRemoved});
        }
    }
}

void World::Impl::record(const Incident& incident) {
    if (incidents.size() == kMaxIncidents) incidents.erase(incidents.begin());
    incidents.push_back(incident);
}

void World::take_incidents(std::vector<Incident>& incidents) {
    incidents.clear();
    incidents.swap(impl_->incidents);
}

}  // namespace atrium::physics
