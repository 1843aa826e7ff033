#include "tools/visual_hull/limits.hpp"

#include "site_node/hull/input_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace atrium::hull_tool {
namespace {

tl::unexpected<Error> beyond(std::string text) {
    return make_error(ErrorKind::kConfiguration, std::move(text));
}

std::size_t num_points(const views::NamedView& view) {
    std::size_t sum = view.view.field.size();
    for (const auto& contour : view.view.contours) sum += contour.size();
    return sum;
}

}  // namespace

Expected<void> check_limits(std::span<const views::NamedView> views, bool has_bounds) {
    const std::size_t most_views = hull::kMaxViews - (has_bounds ? hull::kViewsOfBounds : 0);
    if (views.size() > most_views) {
        return beyond(fmt::format("{} views; at most {} are possible{}",
                                  views.size(),
                                  most_views,
                                  has_bounds ? " with --bounds, which count as two" : ""));
    }
    std::size_t sum = 0;
    const views::NamedView* largest = nullptr;
    for (const views::NamedView& view : views) {
        const geometry::PinholeCamera& camera = view.view.intrinsics;
        for (const auto& [key, focal_px] : {std::pair{"fx", camera.fx}, {"fy", camera.fy}}) {
            if (focal_px >= hull::kMinFocal_px && focal_px <= hull::kMaxFocal_px) continue;
            return beyond(fmt::format("view \"{}\".{}: must be in [{}, {}] px, got {}",
                                      view.name,
                                      key,
                                      hull::kMinFocal_px,
                                      hull::kMaxFocal_px,
                                      focal_px));
        }
        sum += num_points(view);
        if (largest == nullptr || num_points(view) > num_points(*largest)) largest = &view;
    }
    const std::size_t most_points =
        std::min(hull::HullOptions{}.max_segments,
                 hull::kMaxPointsTimesViews / std::max<std::size_t>(views.size(), 1));
    if (sum <= most_points) return {};
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("too complex: {} points of contours; {} views may have at most {} ({}, and {} "
                    "divided by the number of views); most are of view \"{}\": {}",
                    sum,
                    views.size(),
                    most_points,
                    hull::HullOptions{}.max_segments,
                    hull::kMaxPointsTimesViews,
                    largest->name,
                    num_points(*largest)));
}

std::string explain_too_complex(std::span<const views::NamedView> views) {
    for (const views::NamedView& view : views) {
        if (view.view.contours.size() <= hull::kMaxContours) continue;
        return fmt::format("; view \"{}\" has {} contours, at most {} are possible",
                           view.name,
                           view.view.contours.size(),
                           hull::kMaxContours);
    }
    return fmt::format("; the outlines cross each other in more than {} steps",
                       hull::HullOptions{}.max_steps);
}

}  // namespace atrium::hull_tool
