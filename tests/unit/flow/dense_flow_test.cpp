#include "site_node/flow/dense_flow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace atrium::flow {
namespace {

// A smooth pattern, displaced by `moved_px`.
image::Plane pattern(int width, int height, const Eigen::Vector2d& moved_px) {
    image::Plane plane(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double u = x - moved_px.x();
            const double v = y - moved_px.y();
            const double value = 128.0 + 40.0 * std::sin(0.31 * u + 0.12 * v) +
                                 30.0 * std::sin(0.23 * v - 0.17 * u) +
                                 20.0 * std::sin(0.07 * u + 0.41 * v);
            plane.row(y)[x] = static_cast<std::uint8_t>(std::lround(value));
        }
    }
    return plane;
}

double median_error(const FlowField& flow, const Eigen::Vector2d& truth_px) {
    std::vector<double> errors;
    for (int y = 16; y < flow.height - 16; ++y) {
        for (int x = 16; x < flow.width - 16; ++x)
            errors.push_back((flow.at(x, y).cast<double>() - truth_px).norm());
    }
    std::ranges::nth_element(errors,
                             errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
    return errors[errors.size() / 2];
}

TEST(DenseFlow, FindsADisplacementOfFractionsOfAPixel) {
    for (const Eigen::Vector2d& moved_px :
         {Eigen::Vector2d(0.3, -0.6), {2.25, 1.5}, {-5.0, 3.75}}) {
        DenseFlow dense_flow;
        FlowField flow;
        dense_flow.compute(pattern(128, 160, {0.0, 0.0}), pattern(128, 160, moved_px), flow);
        EXPECT_LT(median_error(flow, moved_px), 0.1) << moved_px.transpose();
    }
}

TEST(DenseFlow, PicturesOfOtherSizesLeaveNoTrace) {
    const Eigen::Vector2d moved_px(1.5, -0.75);
    DenseFlow reused;
    FlowField flow;
    for (const auto& [width, height] :
         {std::pair{kMinFlowPx, kMinFlowPx}, {176, 240}, {112, 96}, {176, 240}, {400, 96}}) {
        const image::Plane from = pattern(width, height, {0.0, 0.0});
        const image::Plane to = pattern(width, height, moved_px);
        reused.compute(from, to, flow);
        FlowField fresh;
        DenseFlow().compute(from, to, fresh);
        EXPECT_EQ(flow.width, width);
        EXPECT_EQ(flow.height, height);
        EXPECT_EQ(flow.displacement_px, fresh.displacement_px);
    }
}

}  // namespace
}  // namespace atrium::flow
