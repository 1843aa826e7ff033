#pragma once

#include "simulation/simulated_loop.hpp"

#include <cstdint>
#include <span>

namespace atrium::simulation {

/// Light that grows and fades by a share, as a sine of a period, as when clouds pass. Cameras of
/// one room see it alike.
class ChangingLight {
public:
    ChangingLight() = default;
    /// `share`: 0 for light that stays, below 1. `period_s` above 0.
    ChangingLight(double share, double period_s) : share_(share), period_s_(period_s) {}

    bool stays() const { return share_ == 0.0; }

    /// How many times as bright as at first the room is `time_s` from the beginning.
    double gain(double time_s) const;

    /// The picture as it looks then: luma and chroma grow alike, and what is too bright saturates.
    /// The picture itself if the light stays.
    Picture lit(const Picture& picture, double time_s) const;

    /// The same for samples of a sensor, whose zero is dark.
    void light(std::span<std::uint8_t> samples, double time_s) const;

private:
    double share_ = 0.0, period_s_ = 600.0;
};

}  // namespace atrium::simulation
