#include "world_server/publisher.hpp"

#include "world_server/proxies.hpp"
#include "world_server/recorded_output.hpp"

#include <algorithm>

namespace atrium::world_server {

template <typename Outputs>
void BasicPublisher<Outputs>::note(const Expected<std::size_t>& written) {
    if (written)
        num_bytes_ += *written;
    else
        log_.warn("publish_failed " + written.error().message);
}

// A new object may have the number of a gone one that was soft or a model.
template <typename Outputs>
void BasicPublisher<Outputs>::send(const SceneChange& change) {
    const std::uint32_t id = change.object.object;
    if (change.is_gone)
        dispose(outputs_.objects, change.object);
    else
        write(outputs_.objects, change.object);
    if (change.proxy && !change.is_gone) {
        models_.insert(id);
        write(outputs_.object_proxies, *change.proxy);
    } else if (models_.erase(id) > 0) {
        bus::ObjectProxy proxy;
        proxy.object = id;
        dispose(outputs_.object_proxies, proxy);
    }
    if (change.soft && !change.is_gone) {
        soft_.insert(id);
        write(outputs_.soft_bodies, *change.soft);
    } else if (soft_.erase(id) > 0) {
        bus::SoftBody body;
        body.object = id;
        dispose(outputs_.soft_bodies, body);
        bus::SoftBodyState state;
        state.object = id;
        dispose(outputs_.soft_states, state);
    }
}

template <typename Outputs>
void BasicPublisher<Outputs>::forget_all_but(std::span<const physics::PersonSnapshot> people) {
    std::erase_if(proxied_, [&](const std::string& site) {
        const bool is_there = std::any_of(
            people.begin(), people.end(), [&](const auto& person) { return person.name == site; });
        if (is_there) return false;
        bus::PersonProxy key;
        key.site = site;
        dispose(outputs_.person_proxies, key);
        return true;
    });
}

template <typename Outputs>
bool BasicPublisher<Outputs>::has_proxy_readers() {
    const bool has_some = outputs_.person_proxies.num_readers() > 0;
    if (!has_some) forget_all_but({});
    return has_some;
}

template <typename Outputs>
void BasicPublisher<Outputs>::send(std::span<const physics::PersonSnapshot> people) {
    forget_all_but(people);
    for (const physics::PersonSnapshot& person : people) {
        fill_proxy(person, places_, proxy_);
        proxied_.insert(person.name);
        write(outputs_.person_proxies, proxy_);
    }
}

template <typename Outputs>
void BasicPublisher<Outputs>::send(const Outbox::Content& content) {
    for (const SceneChange& change : content.changes) send(change);
    for (const auto& placement : content.placements) write(outputs_.placements, placement);
    for (const auto& gone : content.gone_scenery) dispose(outputs_.scenery, gone);
    for (const auto& scenery : content.scenery) write(outputs_.scenery, scenery);
    for (const auto& result : content.results) {
        answered_.insert(result.sender);
        write(outputs_.edit_results, result);
    }
    for (const std::string& sender : content.left) {
        bus::EditResult key;
        key.sender = sender;
        if (answered_.erase(sender) > 0) dispose(outputs_.edit_results, key);
    }
    if (content.saved_worlds) write(outputs_.saved_worlds, *content.saved_worlds);
    if (content.has_people && has_proxy_readers()) send(content.people);
    if (!content.has_state) return;
    write(outputs_.states, content.state.rigid);
    for (const auto& state : content.state.soft) {
        // the state may be older than the changes
        if (soft_.contains(state.object)) write(outputs_.soft_states, state);
    }
}

template class BasicPublisher<Endpoints>;
template class BasicPublisher<RecordedOutputs>;

}  // namespace atrium::world_server
