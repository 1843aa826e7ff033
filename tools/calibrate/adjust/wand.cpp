#include "tools/calibrate/adjust/wand.hpp"

#include "core/config/table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMaxLights = 16;
constexpr double kMinApart_m = 0.01;
constexpr double kMaxApart_m = 5.0;
constexpr double kOffLine_m = 0.0005;

// Of two lights that are furthest apart.
std::pair<std::size_t, std::size_t> ends_of(const std::vector<Eigen::Vector3d>& lights) {
    std::pair<std::size_t, std::size_t> ends{0, 0};
    double most = -1.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (std::size_t j = i + 1; j < lights.size(); ++j) {
            const double apart = (lights[i] - lights[j]).norm();
            if (apart <= most) continue;
            most = apart;
            ends = {i, j};
        }
    }
    return ends;
}

}  // namespace

WandForm Wand::form() const {
    if (size() == 1) return WandForm::kPoint;
    const auto [a, b] = ends_of(lights_m);
    const Eigen::Vector3d along = (lights_m[b] - lights_m[a]).normalized();
    const auto is_on_line = [&, start = lights_m[a]](const Eigen::Vector3d& light) {
        return (light - start).cross(along).norm() <= kOffLine_m;
    };
    return std::ranges::all_of(lights_m, is_on_line) ? WandForm::kLine : WandForm::kBody;
}

double Wand::length_m() const {
    if (size() == 1) return 0.0;
    const auto [a, b] = ends_of(lights_m);
    return (lights_m[a] - lights_m[b]).norm();
}

std::vector<double> Wand::places_on_line_m() const {
    const auto [a, b] = ends_of(lights_m);
    const Eigen::Vector3d along = (lights_m[b] - lights_m[a]).normalized();
    std::vector<double> places;
    for (const Eigen::Vector3d& light : lights_m)
        places.push_back(along.dot(light - lights_m.front()));
    return places;
}

Wand default_wand() { return {{{0, 0, 0}, {0.1, 0, 0}, {0.3, 0, 0}, {0.6, 0, 0}}}; }

Expected<Wand> load_wand(const std::filesystem::path& file) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    reader->forbid("lights_m", "write a [[light]] with position_m = [x, y, z] for each light");
    Wand wand;
    for (config::TableReader& light : reader->tables("light")) {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();
        light.forbid("position_mm", "write position_m, in metres");
        light.require("position_m");
        light.read("position_m", position.data(), 3, {-kMaxApart_m, kMaxApart_m});
        for (std::size_t i = 0; i < wand.size(); ++i) {
            if ((wand.lights_m[i] - position).norm() < kMinApart_m)
                light.reject("position_m", fmt::format("must be at least 1 cm from light {}", i));
        }
        wand.lights_m.push_back(position);
    }
    if (const auto done = reader->finish(); !done) return tl::unexpected(done.error());
    if (wand.size() == 0 || wand.size() > kMaxLights)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format(
                "{}: has {} [[light]]; must have 1 to {}", file.string(), wand.size(), kMaxLights));
    if (wand.length_m() > kMaxApart_m)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: its lights are {:.2f} m apart; must be at most {:.0f} m",
                                      file.string(),
                                      wand.length_m(),
                                      kMaxApart_m));
    return wand;
}

}  // namespace atrium::calibrate
