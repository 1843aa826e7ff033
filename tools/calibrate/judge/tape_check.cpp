#include "tools/calibrate/judge/tape_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::calibrate {

std::string tape_check(std::span<const geometry::CalibratedCamera> cameras,
                       const Measured& measured,
                       bool has_floor) {
    std::vector<bool> has_height(cameras.size(), false);
    std::vector<bool> is_measured(cameras.size(), false);
    for (const std::size_t i : measured.heights) has_height[i] = is_measured[i] = true;
    if (measured.distance) {
        for (const std::size_t i : *measured.distance) is_measured[i] = true;
    }
    const auto apart = [&](std::size_t i, std::size_t j) {
        return (cameras[i].centre_site() - cameras[j].centre_site()).norm();
    };
    const auto is_the_distance = [&](std::size_t i, std::size_t j) {
        return measured.distance &&
               (*measured.distance == std::array{i, j} || *measured.distance == std::array{j, i});
    };
    // cameras that were not measured first, then the longest distance
    std::optional<std::array<std::size_t, 2>> best;
    const auto is_better = [&](std::size_t i, std::size_t j) {
        const auto num_new = [&](std::size_t a, std::size_t b) {
            return (is_measured[a] ? 0 : 1) + (is_measured[b] ? 0 : 1);
        };
        const int more = best ? num_new(i, j) - num_new((*best)[0], (*best)[1]) : 1;
        return more > 0 || (more == 0 && apart(i, j) > apart((*best)[0], (*best)[1]));
    };
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        for (std::size_t j = i + 1; j < cameras.size(); ++j)
            if (!is_the_distance(i, j) && is_better(i, j)) best = {i, j};
    }
    if (!best) return {};
    const auto& [first, second] = *best;
    const std::string distance = fmt::format("{:.2f} m", apart(first, second));
    std::string heights;
    for (const std::size_t i : {first, second}) {
        if (!has_floor || has_height[i]) continue;
        heights += fmt::format("{}{} {}{:.2f} m{}",
                               heights.empty() ? "" : ", ",
                               cameras[i].name,
                               heights.empty() ? "is " : "",
                               cameras[i].centre_site().z(),
                               heights.empty() ? " above the floor" : "");
    }
    const bool has_both = measured.distance && !measured.heights.empty();
    return fmt::format(
        "lengths: so {}{} is {} from {}: measure {} from the lens. If it differs, a camera "
        "or a number of {} is wrong",
        heights.empty() ? "" : heights + ", and ",
        cameras[first].name,
        distance,
        cameras[second].name,
        heights.empty() ? "that" : "one of them",
        has_both            ? "--distance or --camera-height"
        : measured.distance ? "--distance"
                            : "--camera-height");
}

}  // namespace atrium::calibrate
