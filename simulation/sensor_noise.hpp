#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::simulation {

/// Gaussian noise of a camera's sensor, from a table that is drawn once: each row of a picture
/// reads it from another place.
class SensorNoise {
public:
    SensorNoise(double sigma_lsb, std::uint64_t seed);

    /// Adds to the bytes of one picture row, clamped to 0..255. `picture` tells pictures apart,
    /// `row` the rows of one.
    void add(std::uint64_t picture, int row, std::span<std::uint8_t> bytes) const;

private:
    std::vector<std::int8_t> table_;
    std::uint64_t seed_;
};

}  // namespace atrium::simulation
