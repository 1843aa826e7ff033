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

/// What became of proxies since the last time that anybody asked.
struct ProxyChanges {
    std::map<std::string, std::optional<bus::PersonProxy>> people;     // nullopt: gone
    std::map<std::uint32_t, std::optional<bus::ObjectProxy>> objects;  // nullopt: gone
};

/// What people and models are to the physics, on its way from the bus. Readers are there only while
/// somebody wants it: so the world server sends it only then. The newest of each key counts.
class ProxyInbox {
public:
    /// Any thread.
    void want(bool is_wanted) { is_wanted_ = is_wanted; }
    ProxyChanges take();

    /// The receiving thread, now and then: nobody waits for these.
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
    std::optional<Readers> readers_;  // of the receiving thread, as is the next one
    app::log::OncePerSecond failures_;
    std::mutex mutex_;  // guards the rest
    ProxyChanges changes_;
};

}  // namespace atrium::viewer
