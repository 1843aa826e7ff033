#include "simulation/sensor_noise.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace atrium::simulation {
namespace {

constexpr std::size_t kTableSize = std::size_t{1} << 20;
constexpr std::size_t kMaxRowBytes = std::size_t{1} << 16;

std::uint64_t mix(std::uint64_t v) {  // splitmix64
    v += 0x9e3779b97f4a7c15ull;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
    return v ^ (v >> 31);
}

}  // namespace

SensorNoise::SensorNoise(double sigma_lsb, std::uint64_t seed)
    : table_(kTableSize + kMaxRowBytes), seed_(seed) {
    std::mt19937_64 engine(mix(seed));
    std::normal_distribution<double> normal(0.0, 1.0);
    for (std::int8_t& value : table_) {
        value = static_cast<std::int8_t>(
            std::clamp(std::lround(sigma_lsb * normal(engine)), -127l, 127l));
    }
}

void SensorNoise::add(std::uint64_t picture, int row, std::span<std::uint8_t> bytes) const {
    assert(bytes.size() <= kMaxRowBytes);
    const std::uint64_t place = mix(mix(seed_ ^ (picture << 16)) + static_cast<std::uint64_t>(row));
    const std::int8_t* noise = table_.data() + place % kTableSize;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const int value = bytes[i] + noise[i];
        bytes[i] = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
    }
}

}  // namespace atrium::simulation
