#pragma once

#include "core/base/expected.hpp"
#include "tests/support/world/acts.hpp"
#include "tests/support/world/people_trial.hpp"

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

/// Trials of acts with objects, with hulls from the cameras of a rig.
namespace atrium::test {

enum class Thing : std::uint8_t { kBall, kBox };

struct TrialSetting {
    std::vector<geometry::CalibratedCamera> cameras;
    std::filesystem::path cache;  // of films; empty: none
    physics::WorldOptions world;
    double rate_hz = 30.0;
    std::ostream* trace = nullptr;  // receives the place of the object 30 times a second
};

struct TrialResult {
    bool succeeded = false;
    std::string reason;    // of a failure
    double measure = 0.0;  // see the trials
};

/// The object stays on palm or tray. At the end its middle is above the palm and within 12 cm
/// sideways of the palm's (on a tray: within half the tray's size), and it was never 5 cm lower.
/// measure: sideways offset at the end [m].
Expected<TrialResult> try_carry(const TrialSetting& setting,
                                const CarryAct& act,
                                Thing thing,
                                std::uint64_t seed);

/// The object stays within 8 cm of the middle between the palms from the lift on, and turns with
/// them by 90 degrees, up to an error of 25. measure: largest distance from the middle [m].
Expected<TrialResult> try_clasp(const TrialSetting& setting, const ClaspAct& act, Thing thing);

/// At the end the object is within 8 cm of the middle between the taker's palms. measure: that
/// distance [m].
Expected<TrialResult> try_hand_over(const TrialSetting& setting,
                                    const HandOverAct& act,
                                    Thing thing);

/// The object flies forwards, within 35 degrees of level and of straight, at 0.6 to 2.2 times the
/// palms' speed. measure: its speed over theirs.
Expected<TrialResult> try_throw(const TrialSetting& setting, const ThrowAct& act);

/// The ball rolls or flies forwards at 0.8 to 2.2 times the ankle's speed. measure: its speed over
/// the ankle's.
Expected<TrialResult> try_kick(const TrialSetting& setting, const KickAct& act);

struct StrikeResult : TrialResult {
    double deepest_m = 0.0;  // depth of the ball in the moving hull
    int num_deep_ticks = 0;  // consecutive, deeper than 2 cm
};

/// A ball of 5 cm rests without gravity and is hit. It leaves with 0.97 to 2.2 times the hull's
/// velocity along the hull's normal at the contact, and is never more than 2 cm inside the hull for
/// more than 3 ticks. measure: the ratio of velocities.
Expected<StrikeResult> try_strike(const TrialSetting& setting, const StrikeAct& act);

}  // namespace atrium::test
