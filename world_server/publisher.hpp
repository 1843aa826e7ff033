#pragma once

#include "core/app/log.hpp"
#include "world_server/endpoints.hpp"
#include "world_server/outbox.hpp"

#include <atomic>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace atrium::world_server {

/// Writes the world's messages to the writers of `Outputs`, those of the bus (Endpoints) or of a
/// recording, and counts their bytes. Used by the publishing thread only, except for the counter.
template <typename Outputs>
class BasicPublisher {
public:
    explicit BasicPublisher(Outputs& outputs) : outputs_(outputs) {}

    void send(const Outbox::Content& content);
    /// True if anybody reads person proxies. If not, disposes the proxies of all people.
    bool has_proxy_readers();
    void send(const bus::WorldStatus& status) { write(outputs_.statuses, status); }
    /// Payload bytes since the start. Thread-safe.
    std::uint64_t num_bytes() const { return num_bytes_; }

private:
    void send(const SceneChange& change);
    void send(std::span<const physics::PersonSnapshot> people);
    template <typename Writer, typename Message>
    void write(Writer& writer, const Message& message) {
        note(writer.write(message));
    }
    template <typename Writer, typename Message>
    void dispose(Writer& writer, const Message& key) {
        if (const auto gone = writer.dispose(key); !gone)
            log_.warn("publish_failed " + gone.error().message);
    }
    void forget_all_but(std::span<const physics::PersonSnapshot> people);
    void note(const Expected<std::size_t>& written);

    Outputs& outputs_;
    std::set<std::uint32_t> soft_;    // objects with a published SoftBody
    std::set<std::uint32_t> models_;  // objects with a published ObjectProxy
    std::set<std::string> proxied_;   // sites with a published person proxy
    std::set<std::string> answered_;  // senders with an edit result
    bus::PersonProxy proxy_;          // scratch, like places_
    std::vector<Eigen::Vector3f> places_;
    app::log::OncePerSecond log_;
    std::atomic<std::uint64_t> num_bytes_{0};
};

using Publisher = BasicPublisher<Endpoints>;

}  // namespace atrium::world_server
