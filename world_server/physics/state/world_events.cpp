#include "world_server/physics/state/world_events.hpp"

namespace atrium::physics {

std::string_view describe(IncidentKind kind) {
    switch (kind) {
        case IncidentKind::kNotFinite:
            return "had a state that was not finite and was reset";
        case IncidentKind::kRunaway:
            return "became far too fast and was reset";
        case IncidentKind::kTorn:
            return "was torn and was reset";
        case IncidentKind::kRemoved:
            return "left the world and was removed";
        case IncidentKind::kLeft:
            break;
    }
    return "left the world and was reset";
}

}  // namespace atrium::physics
