#pragma once

#include "core/config/option_set.hpp"
#include "simulation/changing_light.hpp"
#include "simulation/person.hpp"
#include "simulation/wand_room.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace atrium::simulation {

/// Options `simulation.*` of programs with a simulated room.
struct RoomConfig {
    std::string shows = "person";  // or "wand", "board": rooms for `calibrate`
    double board_square_mm = 160.0;
    bool lies = false;
    double exposure_ms = 2.0;   // of the wand
    double lost_percent = 0.0;  // of the wand's pictures
    int people = 1;
    std::string look = "ada";
    std::string motion = "walk";
    std::filesystem::path model;
    std::filesystem::path motion_file{};
    double model_height_m = 0.0;
    double model_turn_deg = 0.0;
    double loop_s = 3.0;
    double heading_deg = -90.0;  // -90 faces +X of the site
    double noise_lsb = 2.0;
    std::uint64_t seed = 1;
    std::string bumped_camera;  // empty: none
    double bumped_turn_deg = 1.0;
    double bumped_move_mm = 0.0;
    double bumped_after_s = 0.0;
    double light_percent = 0.0;  // by which the light of the room grows and fades
    double light_period_s = 600.0;
    std::string late_camera;  // empty: none
    int late_instants = 1;
    std::filesystem::path cache = ".cache/simulation";  // folder of rendered loops; empty: no cache
};

/// Declares every option with its default; `config` must outlive `set`.
void declare(RoomConfig& config, config::OptionSet& set);

/// Returns the room options for cameras of `rate_hz`. Not yet checked: see `check(RoomOptions)`.
RoomOptions room_options(const RoomConfig& config, double rate_hz);

/// How the light of the room changes.
ChangingLight changing_light(const RoomConfig& config);

/// Returns the options of the room that shows a wand. Not yet checked: see
/// `check(WandRoomOptions)`.
WandRoomOptions wand_room_options(const RoomConfig& config);

}  // namespace atrium::simulation
