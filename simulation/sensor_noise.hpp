#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::simulation {

/// Gaussian sensor noise from a table drawn once. Each picture row reads it from a different place.
class SensorNoise {
public:
    SensorNoise(double sigma_lsb, std::uint64_t seed);

    /// Adds noise to the bytes of one picture row, clamped to 0..255. `picture` distinguishes
    /// pictures, `row` the rows of one.
    void add(std::uint64_t picture, int row, std::span<std::uint8_t> bytes) const;

private:
    std::vector<std::int8_t> table_;
    std::uint64_t seed_;
};

}  // namespace atrium::simulation
