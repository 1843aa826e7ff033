#include "simulation/room_config.hpp"

#include "simulation/choreography.hpp"
#include "simulation/look.hpp"

#include <numbers>

namespace atrium::simulation {

void declare(RoomConfig& room, config::OptionSet& set) {
    set.add("simulation.look", room.look, "who stands in the simulated room", look_names());
    set.add("simulation.motion", room.motion, "what they do", motion_names());
    set.add("simulation.model",
            room.model,
            "file of a rigged, animated model that stands in the room instead, in any format that "
            "Assimp reads; its first animation is repeated");
    set.add("simulation.model_height_m",
            room.model_height_m,
            "height of the model at the start of its animation [m]; 0: as in its file, in metres",
            {0, 10});
    set.add("simulation.model_turn_deg",
            room.model_turn_deg,
            "turns the model about the vertical, where it does not look the way the heading says "
            "[deg]",
            {-360, 360});
    set.add("simulation.loop_s",
            room.loop_s,
            "length of the loop that is rendered once and replayed [s]; a model's animation is "
            "repeated as often as fits best, and its speed adapted to it",
            {0.1, 60});
    set.add("simulation.heading_deg",
            room.heading_deg,
            "where the person looks [deg]: 0 is +Y of the site, -90 is +X",
            {-360, 360});
    set.add("simulation.noise_lsb",
            room.noise_lsb,
            "camera noise, standard deviation [grey levels]",
            {0, 20});
    set.add("simulation.seed", room.seed, "of the noise");
    set.add("simulation.cache",
            room.cache,
            "folder that keeps rendered loops; empty: render at every start");
}

RoomOptions room_options(const RoomConfig& config, double rate_hz) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    RoomOptions room;
    room.look = config.look;
    room.motion = config.motion;
    room.model = config.model;
    room.model_height_m = config.model_height_m;
    room.model_turn_rad = config.model_turn_deg * kRadians;
    room.loop_s = config.loop_s;
    room.rate_hz = rate_hz;
    room.heading_rad = config.heading_deg * kRadians;
    room.noise_lsb = config.noise_lsb;
    room.seed = config.seed;
    return room;
}

}  // namespace atrium::simulation
