#include "site_node/simulated_room/open_room.hpp"

namespace atrium::simulated_room {

Expected<std::unique_ptr<capture::FrameSource>> open_room(const config::Rig&,
                                                          const simulation::RoomConfig&,
                                                          std::stop_token) {
    return make_error(ErrorKind::kConfiguration,
                      "capture.source: this site_node has no simulated rooms, as it was built with "
                      "ATRIUM_SIMULATION=OFF; choose 'cameras' or 'recording'");
}

}  // namespace atrium::simulated_room
