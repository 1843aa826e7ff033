#include "world_server/publisher.hpp"

namespace atrium::world_server {

void Publisher::note(const Expected<std::size_t>& written) {
    if (written)
        num_bytes_ += *written;
    else
        log_.warn("publish_failed " + written.error().message);
}

void Publisher::send(const SceneChange& change) {
    if (!change.is_gone) {
        write(endpoints_.objects, change.object);
        if (change.soft) write(endpoints_.soft_bodies, *change.soft);
        return;
    }
    const auto dispose = [&](auto& writer, const auto& key) {
        if (const auto gone = writer.dispose(key); !gone) {
            log_.warn("publish_failed " + gone.error().message);
        }
    };
    dispose(endpoints_.objects, change.object);
    if (change.object.shape != bus::Shape::kSoft) return;
    bus::SoftBody body;
    body.object = change.object.object;
    dispose(endpoints_.soft_bodies, body);
    bus::SoftBodyState state;
    state.object = change.object.object;
    dispose(endpoints_.soft_states, state);
}

void Publisher::send(const Outbox::Content& content) {
    for (const SceneChange& change : content.changes) send(change);
    for (const auto& placement : content.placements) write(endpoints_.placements, placement);
    for (const auto& scenery : content.scenery) write(endpoints_.scenery, scenery);
    if (!content.has_state) return;
    write(endpoints_.states, content.state.rigid);
    for (const auto& state : content.state.soft) write(endpoints_.soft_states, state);
}

}  // namespace atrium::world_server
