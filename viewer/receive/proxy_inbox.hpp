#pragma once

#include "core/app/log.hpp"
#include "core/bus/bus.hpp"

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Changes of proxies since the last call of `take`.
struct ProxyChanges {
    std::map<std::string, std::optional<bus::PersonProxy>> people;     // nullopt: gone
    std::map<std::uint32_t, std::optional<bus::ObjectProxy>> objects;  // nullopt: gone
};

/// Receives the physics proxies: surfels of people and convex parts of models. Readers exist only
/// while they are wanted, so the world server publishes the proxies only then. The newest sample of
/// each key counts.
class ProxyInbox {
public:
    /// Any thread may call these.
    void want(bool is_wanted) { is_wanted_ = is_wanted; }
    ProxyChanges take();

    /// Receiving thread only; low priority.
    bus::TakeReport receive(const bus::Participant& participant);

private:
    struct Readers {
        bus::Reader<bus::PersonProxy> people;
        bus::Reader<bus::ObjectProxy> objects;
    };
    void open(const bus::Participant& participant);
    template <typename Map, typename Message>
    void keep(Map& map, const typename Map::key_type& key, std::optional<Message> message);

    std::atomic<bool> is_wanted_ = false;
    std::optional<Readers> readers_;  // receiving thread only, like `failures_`
    app::log::OncePerSecond failures_;
    std::mutex mutex_;  // guards `changes_`
    ProxyChanges changes_;
};

}  // namespace atrium::viewer
