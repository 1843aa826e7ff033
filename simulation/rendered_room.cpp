#include "simulation/rendered_room.hpp"

#include "simulation/board_room.hpp"
#include "simulation/room_config.hpp"
#include "simulation/wand_room.hpp"

namespace atrium::simulation {

std::unique_ptr<const RenderedRoom> rendered_room(const config::Rig& rig,
                                                  const RoomConfig& config) {
    if (config.shows == "wand") return std::make_unique<WandRoom>(rig, wand_room_options(config));
    if (config.shows == "board")
        return std::make_unique<BoardRoom>(
            rig,
            BoardRoomOptions{
                1e-3 * config.board_square_mm, config.noise_lsb, config.seed, config.lies});
    return nullptr;
}

}  // namespace atrium::simulation
