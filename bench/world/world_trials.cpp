// Trials of acts with objects of a world, with hulls from the cameras of a simulated room. Writes
// rows of comma-separated values, one per trial. world_trials.sh keeps them and makes the table.
#include "tests/support/world/world_trials.hpp"

#include "bench/value_of.hpp"
#include "bench/world/trial_options.hpp"
#include "core/config/rig.hpp"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace atrium::bench {
namespace {

using test::Thing;
using test::TrialResult;
using test::TrialSetting;

using Trial = std::function<TrialResult(const TrialSetting&, std::uint64_t)>;

// Directions spread evenly over the sphere.
Eigen::Vector3d direction(std::uint64_t i, int num) {
    const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / num;
    const double angle = static_cast<double>(i) * 2.39996323;  // the golden angle
    const double level = std::sqrt(1.0 - z * z);
    return {level * std::cos(angle), level * std::sin(angle), z};
}

std::map<std::string, Trial> all_trials() {
    std::map<std::string, Trial> trials;
    for (const auto& [name, thing] :
         {std::pair{"ball", Thing::kBall}, std::pair{"box", Thing::kBox}}) {
        const std::string with = name;
        const Thing kind = thing;
        trials["palm-" + with] = [kind](const TrialSetting& setting, std::uint64_t seed) {
            return value_of(try_carry(setting, test::carry_on_palm(seed), kind, seed));
        };
        trials["tray-" + with] = [kind](const TrialSetting& setting, std::uint64_t seed) {
            return value_of(try_carry(setting, test::carry_on_tray(seed), kind, seed));
        };
        trials["clasp-" + with] = [kind](const TrialSetting& setting, std::uint64_t seed) {
            return value_of(try_clasp(setting, test::clasp_move_turn(seed), kind));
        };
        trials["level-" + with] = [kind](const TrialSetting& setting, std::uint64_t seed) {
            return value_of(try_clasp(setting, test::clasp_move_turn(seed, true), kind));
        };
        trials["handover-" + with] = [kind](const TrialSetting& setting, std::uint64_t seed) {
            return value_of(try_hand_over(setting, test::hand_over(seed), kind));
        };
    }
    trials["throw"] = [](const TrialSetting& setting, std::uint64_t seed) {
        return value_of(try_throw(setting, test::throw_forwards(seed)));
    };
    trials["kick"] = [](const TrialSetting& setting, std::uint64_t seed) {
        return value_of(try_kick(setting, test::kick(seed)));
    };
    for (int speed = 1; speed <= 8; ++speed) {
        for (const int rate : {20, 30}) {
            trials[fmt::format("strike-{}mps-{}hz", speed, rate)] =
                [=](const TrialSetting& given, std::uint64_t seed) -> TrialResult {
                TrialSetting setting = given;
                setting.rate_hz = rate;
                const auto act = test::strike({0.0, 0.0, 1.1}, direction(seed, 20), speed, seed);
                return value_of(try_strike(setting, act));
            };
        }
    }
    return trials;
}

int run(int argc, char** argv) {
    TrialOptions options;
    const app::Start started =
        start({"world_trials",
               "Tries what people can do to the things of a world, with hulls from the cameras of "
               "a simulated room: rows of "
               "comma-separated values, one per trial. Hulls are kept in .cache/world_trials.",
               "  world_trials --trials 4 --only palm,tray-ball\n  world_trials --first 7 --trials "
               "1 --only clasp-box --trace\n"},
              options,
              argc,
              argv);
    if (!started.go_on) return started.exit_code;
    TrialSetting setting;
    setting.cache = ATRIUM_SOURCE_DIR "/.cache/world_trials";
    setting.cameras = value_of(config::load_rig(options.rig)).cameras;
    if (options.traces) setting.trace = &std::cerr;
    fmt::print("trial,seed,succeeded,measure,reason\n");
    for (const auto& [name, trial] : all_trials()) {
        if (!options.wants(name)) continue;
        std::uint64_t num_succeeded = 0;
        for (std::uint64_t i = 0; i < options.num_trials; ++i) {
            const std::uint64_t seed = options.first + i;
            const TrialResult result = trial(setting, seed);
            num_succeeded += result.succeeded ? 1 : 0;
            fmt::print("{},{},{},{:.3f},\"{}\"\n",
                       name,
                       seed,
                       result.succeeded ? 1 : 0,
                       result.measure,
                       result.reason);
            std::fflush(stdout);
        }
        fmt::print(stderr, "{}: {} of {}\n", name, num_succeeded, options.num_trials);
    }
    return 0;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) { return atrium::bench::run(argc, argv); }
