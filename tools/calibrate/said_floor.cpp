#include "tools/calibrate/said_floor.hpp"

#include "tools/calibrate/recording/floor_doubt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::calibrate {

std::string doubt_floor(const Material& material,
                        const std::vector<geometry::CalibratedCamera>& cameras,
                        const Said& said) {
    std::vector<std::string> texts;
    if (said.distance)
        texts.push_back(fmt::format(
            "{} to {} {:.4g} m", said.distance->from, said.distance->to, said.distance->metres));
    for (const auto& [camera, metres] : said.heights)
        texts.push_back(fmt::format("{} {:.4g} m high", camera, metres));
    const bool has_heights = !said.heights.empty();
    return doubt_of_floor(material,
                          cameras,
                          {fmt::format("{}", fmt::join(texts, "; ")), has_heights},
                          has_heights ? said.heights.front().camera : std::string());
}

}  // namespace atrium::calibrate
