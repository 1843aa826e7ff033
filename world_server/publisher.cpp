#include "world_server/publisher.hpp"

#include "world_server/proxies.hpp"

#include <algorithm>

namespace atrium::world_server {

void Publisher::note(const Expected<std::size_t>& written) {
    if (written)
        num_bytes_ += *written;
    else
        log_.warn("publish_failed " + written.error().message);
}

// A new object may have the number of a gone one that was soft or a model.
void Publisher::send(const SceneChange& change) {
    const std::uint32_t id = change.object.object;
    if (change.is_gone)
        dispose(endpoints_.objects, change.object);
    else
        write(endpoints_.objects, change.object);
    if (change.proxy && !change.is_gone) {
        models_.insert(id);
        write(endpoints_.object_proxies, *change.proxy);
    } else if (models_.erase(id) > 0) {
        bus::ObjectProxy proxy;
        proxy.object = id;
        dispose(endpoints_.object_proxies, proxy);
    }
    if (change.soft && !change.is_gone) {
        soft_.insert(id);
        write(endpoints_.soft_bodies, *change.soft);
    } else if (soft_.erase(id) > 0) {
        bus::SoftBody body;
        body.object = id;
        dispose(endpoints_.soft_bodies, body);
        bus::SoftBodyState state;
        state.object = id;
        dispose(endpoints_.soft_states, state);
    }
}

void Publisher::forget_all_but(std::span<const physics::PersonSnapshot> people) {
    std::erase_if(proxied_, [&](const std::string& site) {
        const bool is_there = std::any_of(
            people.begin(), people.end(), [&](const auto& person) { return person.name == site; });
        if (is_there) return false;
        bus::PersonProxy key;
        key.site = site;
        dispose(endpoints_.person_proxies, key);
        return true;
    });
}

bool Publisher::has_proxy_readers() {
    const bool has_some = endpoints_.person_proxies.num_readers() > 0;
    if (!has_some) forget_all_but({});
    return has_some;
}

void Publisher::send(std::span<const physics::PersonSnapshot> people) {
    forget_all_but(people);
    for (const physics::PersonSnapshot& person : people) {
        fill_proxy(person, places_, proxy_);
        proxied_.insert(person.name);
        write(endpoints_.person_proxies, proxy_);
    }
}

void Publisher::send(const Outbox::Content& content) {
    for (const SceneChange& change : content.changes) send(change);
    for (const auto& placement : content.placements) write(endpoints_.placements, placement);
    for (const auto& gone : content.gone_scenery) dispose(endpoints_.scenery, gone);
    for (const auto& scenery : content.scenery) write(endpoints_.scenery, scenery);
    for (const auto& result : content.results) {
        answered_.insert(result.sender);
        write(endpoints_.edit_results, result);
    }
    for (const std::string& sender : content.left) {
        bus::EditResult key;
        key.sender = sender;
        if (answered_.erase(sender) > 0) dispose(endpoints_.edit_results, key);
    }
    if (content.saved_worlds) write(endpoints_.saved_worlds, *content.saved_worlds);
    if (content.has_people && has_proxy_readers()) send(content.people);
    if (!content.has_state) return;
    write(endpoints_.states, content.state.rigid);
    for (const auto& state : content.state.soft) {
        // the state may be older than the changes
        if (soft_.contains(state.object)) write(endpoints_.soft_states, state);
    }
}

}  // namespace atrium::world_server
