#pragma once

#include "simulation/room_config.hpp"
#include "site_node/capture/frame_source.hpp"

#include <memory>
#include <stop_token>

namespace atrium::simulated_room {

/// Opens a simulated room with the cameras of `rig`, and logs the progress of rendering. Error
/// kConfiguration if this build has no simulated rooms (ATRIUM_SIMULATION=OFF).
Expected<std::unique_ptr<capture::FrameSource>> open_room(const config::Rig& rig,
                                                          const simulation::RoomConfig& config,
                                                          std::stop_token stop);

}  // namespace atrium::simulated_room
