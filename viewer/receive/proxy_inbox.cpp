#include "viewer/receive/proxy_inbox.hpp"

#include "core/bus/limits.hpp"

#include <utility>

namespace atrium::viewer {

ProxyChanges ProxyInbox::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(changes_, {});
}

void ProxyInbox::open(const bus::Participant& participant) {
    auto people = bus::Reader<bus::PersonProxy>::create(participant);
    auto objects = bus::Reader<bus::ObjectProxy>::create(participant);
    if (people && objects)
        readers_.emplace(Readers{std::move(*people), std::move(*objects)});
    else
        failures_.warn("proxies_failed " + (people ? objects.error() : people.error()).message);
}

template <typename Map, typename Message>
void ProxyInbox::keep(Map& map, const typename Map::key_type& key, std::optional<Message> message) {
    const std::lock_guard lock(mutex_);
    if (map.size() < bus::kMaxObjects || map.contains(key))
        map.insert_or_assign(key, std::move(message));
}

bus::TakeReport ProxyInbox::receive(const bus::Participant& participant) {
    bus::TakeReport report;
    if (!is_wanted_) {
        if (readers_) {
            readers_.reset();
            take();
        }
        return report;
    }
    if (!readers_) open(participant);
    if (!readers_) return report;
    report = readers_->people.take(
        [this](bus::PersonProxy&& proxy) {
            const std::string site = proxy.site;
            keep(changes_.people, site, std::optional(std::move(proxy)));
        },
        [this](const bus::PersonProxy& gone) {
            keep(changes_.people, gone.site, std::optional<bus::PersonProxy>());
        });
    const bus::TakeReport objects = readers_->objects.take(
        [this](bus::ObjectProxy&& proxy) {
            const std::uint32_t object = proxy.object;
            keep(changes_.objects, object, std::optional(std::move(proxy)));
        },
        [this](const bus::ObjectProxy& gone) {
            keep(changes_.objects, gone.object, std::optional<bus::ObjectProxy>());
        });
    if (report.num_rejected == 0) report.first_rejection = objects.first_rejection;
    report.num_taken += objects.num_taken;
    report.num_rejected += objects.num_rejected;
    return report;
}

}  // namespace atrium::viewer
