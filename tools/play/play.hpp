#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"
#include "core/recording/player.hpp"

#include <filesystem>
#include <stop_token>
#include <string>

/// Plays a recording into a world.
namespace atrium::play {

struct PlayConfig {
    bus::BusOptions bus;
    std::filesystem::path file;
    std::string sites;   // "a,b"; empty: everything
    std::string topics;  // likewise
    std::string rename;  // "alice=anna,bob=ben"
    std::string place;   // "anna=1,0,90;ben=...": x, y [m], yaw [degrees]
    double speed = 1.0;
    double from_s = 0.0;
    double to_s = 0.0;  // 0: the end
    bool loop = false;
    bool paused = false;
    bool info = false;
    bool json = false;
    bool repair = false;
};

void declare(PlayConfig& config, config::OptionSet& options);
Expected<void> check(const PlayConfig& config);
/// From `sites`, `topics`, `rename` and `place`. kConfiguration names the mistake, and what the
/// recording has.
Expected<recording::PlaySelection> selection_of(const PlayConfig& config,
                                                const recording::WorldFile& world);

Expected<void> run_play(const PlayConfig& config, std::stop_token stop);

}  // namespace atrium::play
