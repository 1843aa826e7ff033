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

/// Writes what the world has to say to the bus, and counts it. Of the publishing thread, but for
/// the counter.
class Publisher {
public:
    explicit Publisher(Endpoints& endpoints) : endpoints_(endpoints) {}

    void send(const Outbox::Content& content);
    /// Whether anybody reads what people are to the physics; if not, those whom it told of are
    /// forgotten.
    bool has_proxy_readers();
    void send(const bus::WorldStatus& status) { write(endpoints_.statuses, status); }
    /// Of payload, since the start.
    std::uint64_t num_bytes() const { return num_bytes_; }

private:
    void send(const SceneChange& change);
    void send(std::span<const physics::PersonNow> people);
    template <typename Message>
    void write(bus::Writer<Message>& writer, const Message& message) {
        note(writer.write(message));
    }
    template <typename Message>
    void dispose(bus::Writer<Message>& writer, const Message& key) {
        if (const auto gone = writer.dispose(key); !gone)
            log_.warn("publish_failed " + gone.error().message);
    }
    void forget_all_but(std::span<const physics::PersonNow> people);
    void note(const Expected<std::size_t>& written);

    Endpoints& endpoints_;
    std::set<std::string> proxied_;  // sites whose people readers know as proxies
    bus::PersonProxy proxy_;         // scratch, as is the next one
    std::vector<Eigen::Vector3f> places_;
    app::log::OncePerSecond log_;
    std::atomic<std::uint64_t> num_bytes_{0};
};

}  // namespace atrium::world_server
