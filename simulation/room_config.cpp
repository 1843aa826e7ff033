#include "simulation/room_config.hpp"

#include "simulation/choreography.hpp"
#include "simulation/look.hpp"

#include <numbers>

namespace atrium::simulation {

void declare(RoomConfig& room, config::OptionSet& set) {
    set.add("simulation.shows",
            room.shows,
            "what the simulated room shows: a person, a dark room in which the default wand of "
            "`calibrate wand` is swept, or the board of `calibrate print-board` that is carried "
            "around",
            {"person", "wand", "board"});
    set.add("simulation.board_square_mm",
            room.board_square_mm,
            "board: side of a square [mm]; 160 as on `--paper a0`",
            {5, 1000});
    set.add("simulation.lies",
            room.lies,
            "wand, board: lies on the floor, as for `calibrate floor`: first at the site's origin "
            "along "
            "its +X, the wand then at two more places, for four seconds each");
    set.add("simulation.exposure_ms",
            room.exposure_ms,
            "wand: exposure, in which its lights move [ms]",
            {0.01, 1000});
    set.add("simulation.lost_percent",
            room.lost_percent,
            "wand: share of the pictures that are lost [%]",
            {0, 90});
    set.add("simulation.people",
            room.people,
            "number of people in the simulated room, 1.2 m apart; each has another look",
            {1, kMaxPeople});
    set.add("simulation.look", room.look, "person in the simulated room", look_names());
    set.add("simulation.motion", room.motion, "motion of the person", motion_names());
    set.add("simulation.model",
            room.model,
            "file of a rigged, animated model that replaces the person, in any format that Assimp "
            "reads; its first animation is repeated");
    set.add("simulation.motion_file",
            room.motion_file,
            "file with an animation for the model (BVH, FBX, glTF, ...); its bones are matched by "
            "name; empty: that of the model's file");
    set.add("simulation.model_height_m",
            room.model_height_m,
            "height of the model when it stands [m]; 0: as in its file, in another unit or 1.75 if "
            "that is not 0.5 to 2.5",
            {0, 10});
    set.add("simulation.model_turn_deg",
            room.model_turn_deg,
            "rotation of the model about the vertical, if it does not face the heading [deg]",
            {-360, 360});
    set.add(
        "simulation.loop_s",
        room.loop_s,
        "length of the loop that is rendered once and replayed [s]; the animation of a model is "
        "repeated as often as fits best, at an adapted speed",
        {0.1, 60});
    set.add("simulation.heading_deg",
            room.heading_deg,
            "direction in which the person looks [deg]: 0 is +Y of the site, -90 is +X",
            {-360, 360});
    set.add("simulation.noise_lsb",
            room.noise_lsb,
            "camera noise, standard deviation [grey levels]",
            {0, 20});
    set.add("simulation.seed", room.seed, "seed of the noise");
    set.add("simulation.bumped_camera",
            room.bumped_camera,
            "name of a camera that is not where the rig says, as if somebody had bumped into it; "
            "empty: none");
    set.add("simulation.bumped_turn_deg",
            room.bumped_turn_deg,
            "by how much it turned to its right [deg]",
            {-30, 30});
    set.add("simulation.bumped_move_mm",
            room.bumped_move_mm,
            "by how much it moved to its right [mm]",
            {-500, 500});
    set.add("simulation.bumped_after_s",
            room.bumped_after_s,
            "how long it is in its place before that, after the empty room was learned; in "
            "simulated_cameras, after the first picture [s]; 0: it was bumped before the start",
            {0, 1e6});
    set.add("simulation.light_percent",
            room.light_percent,
            "person: by how much the light grows and fades, as when clouds pass [%]",
            {0, 90});
    set.add("simulation.light_period_s",
            room.light_period_s,
            "how long the light takes to grow, fade and come back [s]",
            {1, 1e5});
    set.add("simulation.late_camera",
            room.late_camera,
            "name of a camera whose pictures belong to another instant; empty: none");
    set.add("simulation.late_instants",
            room.late_instants,
            "how many instants before theirs its pictures show; below 0: after theirs",
            {-100, 100});
    set.add(
        "simulation.cache", room.cache, "folder of rendered loops; empty: render at every start");
}

RoomOptions room_options(const RoomConfig& config, double rate_hz) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    RoomOptions room;
    room.num_people = config.people;
    room.look = config.look;
    room.motion = config.motion;
    room.model = config.model;
    room.motion_file = config.motion_file;
    room.model_height_m = config.model_height_m;
    room.model_turn_rad = config.model_turn_deg * kRadians;
    room.loop_s = config.loop_s;
    room.rate_hz = rate_hz;
    room.heading_rad = config.heading_deg * kRadians;
    room.noise_lsb = config.noise_lsb;
    room.seed = config.seed;
    return room;
}

ChangingLight changing_light(const RoomConfig& config) {
    return {0.01 * config.light_percent, config.light_period_s};
}

WandRoomOptions wand_room_options(const RoomConfig& config) {
    return {config.exposure_ms, config.lost_percent, config.noise_lsb, config.seed, config.lies};
}

}  // namespace atrium::simulation
