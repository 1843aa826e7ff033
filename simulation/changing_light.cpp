#include "simulation/changing_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>

namespace atrium::simulation {
namespace {

using Table = std::array<std::uint8_t, 256>;

// Distances from `zero` grow by the gain.
Table table_of(double zero, double gain) {
    Table table{};
    for (std::size_t value = 0; value < table.size(); ++value)
        table[value] = static_cast<std::uint8_t>(
            std::lround(std::clamp(zero + gain * (static_cast<double>(value) - zero), 0.0, 255.0)));
    return table;
}

image::Plane mapped(const image::PlaneView& plane, const Table& table) {
    image::Plane out(plane.width, plane.height);
    for (int y = 0; y < plane.height; ++y)
        std::transform(plane.row(y), plane.row(y) + plane.width, out.row(y), [&](std::uint8_t v) {
            return table[v];
        });
    return out;
}

}  // namespace

double ChangingLight::gain(double time_s) const {
    return 1.0 + share_ * std::sin(2.0 * std::numbers::pi * time_s / period_s_);
}

Picture ChangingLight::lit(const Picture& picture, double time_s) const {
    if (stays()) return picture;
    const image::YuvView view = view_of(picture);
    const Table luma = table_of(0.0, gain(time_s)), chroma = table_of(128.0, gain(time_s));
    auto out = std::make_shared<image::YuvImage>();
    out->y = mapped(view.y, luma);
    out->u = mapped(view.u, chroma);
    out->v = mapped(view.v, chroma);
    return Picture(std::move(out));
}

void ChangingLight::light(std::span<std::uint8_t> samples, double time_s) const {
    if (stays()) return;
    const Table table = table_of(0.0, gain(time_s));
    for (std::uint8_t& sample : samples) sample = table[sample];
}

}  // namespace atrium::simulation
