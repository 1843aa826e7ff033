#include "world_server/physics/state/world_events.hpp"

namespace atrium::physics {

std::string_view describe(IncidentKind kind) {
    switch (kind) {
        case IncidentKind::kNotFinite:
            return "had a state that was not finite and was reset";
        case IncidentKind::kRunaway:
            return "became far too fast and was reset";
        case IncidentKind::kTorn:
            return "was torn at a joint and was reset: what hangs there may be too heavy; make the "
                   "light links heavier or raise world.tick_hz";
        case IncidentKind::kMisshapen:
            return "was torn out of shape and was reset";
        case IncidentKind::kRemoved:
            return "left the world and was removed";
        case IncidentKind::kLeft:
            break;
    }
    return "left the world and was reset";
}

}  // namespace atrium::physics
