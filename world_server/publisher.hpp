#pragma once

#include "core/app/log.hpp"
#include "world_server/endpoints.hpp"
#include "world_server/outbox.hpp"

#include <atomic>
#include <cstdint>

namespace atrium::world_server {

/// Writes what the world has to say to the bus, and counts it. Of the publishing thread, but for
/// the counter.
class Publisher {
public:
    explicit Publisher(Endpoints& endpoints) : endpoints_(endpoints) {}

    void send(const Outbox::Content& content);
    void send(const bus::WorldStatus& status) { write(endpoints_.statuses, status); }
    /// Of payload, since the start.
    std::uint64_t num_bytes() const { return num_bytes_; }

private:
    void send(const SceneChange& change);
    template <typename Message>
    void write(bus::Writer<Message>& writer, const Message& message) {
        note(writer.write(message));
    }
    void note(const Expected<std::size_t>& written);

    Endpoints& endpoints_;
    app::log::OncePerSecond log_;
    std::atomic<std::uint64_t> num_bytes_{0};
};

}  // namespace atrium::world_server
