#include "viewer/overlay/label_layout.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

namespace atrium::viewer {
namespace {

using renderer::EyeView;
using renderer::Label;

constexpr double kNearest_m = 0.1;
constexpr int kMaxRaises = 4;
constexpr double kRaise = 0.8;  // in heights: the pictures of texts have empty borders
constexpr double kBody = 0.8;   // part of the picture's height and width that has letters

double depth_m(const Label& label, const EyeView& eye) {
    return -(eye.view_from_world * label.at_world.homogeneous()).z();
}

// The part of the picture that the label covers, in heights of the picture. Empty: out of sight.
std::optional<Eigen::AlignedBox2d> area_of(const Label& label, const EyeView& eye) {
    const double depth = depth_m(label, eye);
    if (depth < kNearest_m || label.opacity <= 0.0 || eye.part_px.height <= 0) return std::nullopt;
    const Eigen::Vector4d clip = eye.clip_from_world() * label.at_world.homogeneous();
    const double shape = static_cast<double>(eye.part_px.width) / eye.part_px.height;
    const Eigen::Vector2d foot(0.5 * shape * clip.x() / clip.w(), 0.5 * clip.y() / clip.w());
    const double width = label.height * label.picture->width / label.picture->height;
    const double low = foot.y() + label.raised * label.height;
    const double border = 0.5 * (1.0 - kBody) * label.height;
    return Eigen::AlignedBox2d(
        Eigen::Vector2d(foot.x() - 0.5 * width + border, low + border),
        Eigen::Vector2d(foot.x() + 0.5 * width - border, low + label.height - border));
}

bool covers_any(const Eigen::AlignedBox2d& area, const std::vector<Eigen::AlignedBox2d>& taken) {
    return std::ranges::any_of(
        taken, [&](const Eigen::AlignedBox2d& other) { return area.intersects(other); });
}

}  // namespace

std::vector<Eigen::AlignedBox2f> label_boxes(const std::vector<Label>& labels, const EyeView& eye) {
    std::vector<Eigen::AlignedBox2f> boxes;
    for (const Label& label : labels) {
        auto area = area_of(label, eye);
        if (!area) continue;
        const double border = 0.5 * (1.0 - kBody) * label.height;
        area->min().array() -= border;
        area->max().array() += border;
        const double shape = static_cast<double>(eye.part_px.width) / eye.part_px.height;
        boxes.emplace_back(
            Eigen::Vector2d(0.5 + area->min().x() / shape, 0.5 - area->max().y()).cast<float>(),
            Eigen::Vector2d(0.5 + area->max().x() / shape, 0.5 - area->min().y()).cast<float>());
    }
    return boxes;
}

void keep_in_picture(Label& label, const EyeView& eye) {
    const auto area = area_of(label, eye);
    if (!area) return;
    // as area_of: x to the right and y up from the middle, in heights of the picture
    const Eigen::Vector2d edge(0.5 * eye.part_px.width / eye.part_px.height, 0.5);
    Eigen::Vector2d way = (-edge - area->min()).cwiseMax(0.0);
    way -= (area->max() - edge).cwiseMax(0.0);
    const double metres = 2.0 * depth_m(label, eye) / eye.clip_from_view(1, 1);
    label.at_world += metres * (way.x() * eye.view_from_world.row(0).head<3>().transpose() +
                                way.y() * eye.view_from_world.row(1).head<3>().transpose());
}

void separate_labels(std::vector<Label>& labels, std::size_t num_kept, const EyeView& eye) {
    std::vector<std::size_t> order(labels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto others =
        order.begin() + static_cast<std::ptrdiff_t>(std::min(num_kept, order.size()));
    std::stable_sort(others, order.end(), [&](std::size_t a, std::size_t b) {
        return depth_m(labels[a], eye) < depth_m(labels[b], eye);
    });
    std::vector<Eigen::AlignedBox2d> taken;
    for (const std::size_t i : order) {
        Label& label = labels[i];
        std::optional<Eigen::AlignedBox2d> area = area_of(label, eye);
        for (int raise = 1; area && covers_any(*area, taken) && raise <= kMaxRaises; ++raise) {
            label.raised = kRaise * raise;
            area = area_of(label, eye);
        }
        if (!area) continue;
        const bool is_free = !covers_any(*area, taken);
        if (is_free || i < num_kept)
            taken.push_back(*area);
        else
            label.opacity = 0.0;
    }
    std::size_t at = 0;
    std::erase_if(labels,
                  [&](const Label& label) { return at++ >= num_kept && label.opacity <= 0.0; });
}

}  // namespace atrium::viewer
