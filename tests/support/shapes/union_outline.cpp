#include "tests/support/shapes/union_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace atrium::test {
namespace {

constexpr int kMinSegments = 4;  // per outline

// The half-planes of a convex polygon. All are positive inside.
struct HalfPlane {
    Eigen::Vector2d inwards;  // unit
    double offset = 0.0;
    double depth(const Eigen::Vector2d& p) const { return inwards.dot(p) - offset; }
};
using ConvexShape = std::vector<HalfPlane>;

ConvexShape half_planes(const Contour& polygon) {
    ConvexShape shape;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Eigen::Vector2d along = (polygon[i] - polygon[j]).normalized();
        const Eigen::Vector2d inwards(-along.y(), along.x());
        shape.push_back({inwards, inwards.dot(polygon[j])});
    }
    return shape;
}

struct Depth {
    double depth_px = -std::numeric_limits<double>::infinity();
    Eigen::Vector2d inwards = Eigen::Vector2d::Zero();
};

Depth depth_in(const ConvexShape& shape, const Eigen::Vector2d& p) {
    Depth least{std::numeric_limits<double>::infinity(), {}};
    for (const HalfPlane& side : shape) {
        const double depth = side.depth(p);
        if (depth < least.depth_px) least = {depth, side.inwards};
    }
    return least;
}

// Pixel (column, row) of the raster has its centre at origin + cell * (column, row).
class Raster {
public:
    Raster(const PixelBox& window, int num_cells) {
        const Eigen::Vector2d size = window.max - window.min;
        cell_ = size.maxCoeff() / num_cells;
        width_ = static_cast<int>(std::ceil(size.x() / cell_)) + 2;
        height_ = static_cast<int>(std::ceil(size.y() / cell_)) + 2;
        origin_ = window.min - 0.5 * Eigen::Vector2d(cell_, cell_);
        pixels_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0);
    }

    void fill(const Contour& convex) {
        double low = std::numeric_limits<double>::infinity();
        double high = -low;
        for (const Eigen::Vector2d& p : convex) {
            low = std::min(low, to_raster(p).y());
            high = std::max(high, to_raster(p).y());
        }
        const int first = std::max(static_cast<int>(std::ceil(low)), 1);
        const int last = std::min(static_cast<int>(std::floor(high)), height_ - 2);
        for (int row = first; row <= last; ++row) fill_row(convex, row);
    }

    bool at(int column, int row) const {
        return column >= 0 && row >= 0 && column < width_ && row < height_ &&
               pixels_[index(column, row)] != 0;
    }
    int width() const { return width_; }
    int height() const { return height_; }
    double cell_px() const { return cell_; }
    Eigen::Vector2d to_pixels(const Eigen::Vector2d& p) const { return origin_ + cell_ * p; }

private:
    Eigen::Vector2d to_raster(const Eigen::Vector2d& p_px) const {
        return (p_px - origin_) / cell_;
    }
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(column);
    }
    void fill_row(const Contour& convex, int row) {
        double left = std::numeric_limits<double>::infinity();
        double right = -left;
        for (std::size_t i = 0, j = convex.size() - 1; i < convex.size(); j = i++) {
            const Eigen::Vector2d a = to_raster(convex[j]);
            const Eigen::Vector2d b = to_raster(convex[i]);
            if ((a.y() > row) == (b.y() > row)) continue;
            const double x = a.x() + (row - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
            left = std::min(left, x);
            right = std::max(right, x);
        }
        // a frame of one pixel stays empty, which closes every outline
        const int first = static_cast<int>(std::clamp(std::ceil(left), 1.0, width_ - 1.0));
        const int last = static_cast<int>(std::clamp(std::floor(right), 0.0, width_ - 2.0));
        for (int column = first; column <= last; ++column) pixels_[index(column, row)] = 1;
    }

    Eigen::Vector2d origin_;
    double cell_ = 1.0;
    int width_ = 0;
    int height_ = 0;
    std::vector<std::uint8_t> pixels_;
};

// Steps along the cracks between pixels: right, down, left, up. Corner (x, y) is the upper left
// corner of pixel (x, y).
constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

// Outlines and holes of the raster along its cracks, in raster coordinates.
class CrackTracer {
public:
    explicit CrackTracer(const Raster& raster)
        : width_(raster.width() + 1),
          leaving_(static_cast<std::size_t>(width_) *
                   (static_cast<std::size_t>(raster.height()) + 1)) {
        for (int y = 0; y < raster.height(); ++y) {
            for (int x = 0; x < raster.width(); ++x) {
                if (!raster.at(x, y)) continue;
                if (!raster.at(x, y - 1)) leaving(x, y) |= 1u << 0;
                if (!raster.at(x + 1, y)) leaving(x + 1, y) |= 1u << 1;
                if (!raster.at(x, y + 1)) leaving(x + 1, y + 1) |= 1u << 2;
                if (!raster.at(x - 1, y)) leaving(x, y + 1) |= 1u << 3;
            }
        }
    }

    std::vector<Contour> loops() {
        std::vector<Contour> result;
        for (std::size_t start = 0; start < leaving_.size(); ++start) {
            const int x = static_cast<int>(start) % width_;
            const int y = static_cast<int>(start) / width_;
            while (leaving_[start] != 0) result.push_back(follow(x, y));
        }
        return result;
    }

private:
    std::uint8_t& leaving(int x, int y) {
        return leaving_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                        static_cast<std::size_t>(x)];
    }

    Contour follow(int x, int y) {
        Contour loop;
        unsigned direction = 0;
        while (leaving(x, y) != 0) {
            // where two pixels touch at a corner: the sharper turn, which separates them
            for (const unsigned turn : {1u, 0u, 3u, 2u}) {
                const unsigned next = (direction + turn) % 4;
                if ((leaving(x, y) & (1u << next)) == 0) continue;
                direction = next;
                break;
            }
            leaving(x, y) &= static_cast<std::uint8_t>(~(1u << direction));
            loop.emplace_back(x - 0.5 + 0.5 * kSteps[direction][0],
                              y - 0.5 + 0.5 * kSteps[direction][1]);
            x += kSteps[direction][0];
            y += kSteps[direction][1];
        }
        return loop;
    }

    int width_;
    std::vector<std::uint8_t> leaving_;  // one bit per step that starts in a corner
};

PixelBox bounds_of(std::span<const Contour> shapes, const PixelBox& picture) {
    PixelBox box{Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()),
                 Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity())};
    for (const Contour& shape : shapes) {
        for (const Eigen::Vector2d& p : shape) {
            box.min = box.min.cwiseMin(p);
            box.max = box.max.cwiseMax(p);
        }
    }
    return {box.min.cwiseMax(picture.min), box.max.cwiseMin(picture.max)};
}

// Moves a point to the border of the union, or of the picture if that is nearer. Keeps it if the
// border is farther away than the raster can have moved it.
Eigen::Vector2d snapped(Eigen::Vector2d p,
                        std::span<const ConvexShape> shapes,
                        const ConvexShape& picture,
                        double reach_px) {
    for (int step = 0; step < 2; ++step) {
        Depth nearest;
        for (const ConvexShape& shape : shapes) {
            const Depth depth = depth_in(shape, p);
            if (depth.depth_px > nearest.depth_px) nearest = depth;
        }
        const Depth inside_picture = depth_in(picture, p);
        if (inside_picture.depth_px < nearest.depth_px) nearest = inside_picture;
        if (std::abs(nearest.depth_px) > reach_px) break;
        p -= nearest.depth_px * nearest.inwards;
    }
    return p;
}

}  // namespace

std::vector<Contour> outline_of_union(std::span<const Contour> shapes,
                                      const PixelBox& picture,
                                      const UnionOutlineOptions& options) {
    const PixelBox window = bounds_of(shapes, picture);
    if (!((window.max - window.min).minCoeff() > 0.0)) return {};
    Raster raster(window, options.num_cells);
    std::vector<ConvexShape> convex;
    for (const Contour& shape : shapes) {
        raster.fill(shape);
        convex.push_back(half_planes(shape));
    }
    const ConvexShape picture_sides{{{1.0, 0.0}, picture.min.x()},
                                    {{0.0, 1.0}, picture.min.y()},
                                    {{-1.0, 0.0}, -picture.max.x()},
                                    {{0.0, -1.0}, -picture.max.y()}};
    const std::vector<Contour> loops = CrackTracer(raster).loops();
    std::size_t length = 0;
    for (const Contour& loop : loops) length += loop.size();

    std::vector<Contour> outlines;
    for (const Contour& loop : loops) {
        if (loop.size() < 2 * kMinSegments) continue;  // single pixels
        const std::size_t share = static_cast<std::size_t>(options.num_segments) * loop.size();
        const std::size_t n = std::clamp<std::size_t>(share / length, kMinSegments, loop.size());
        Contour outline;
        for (std::size_t i = 0; i < n; ++i) {
            const Eigen::Vector2d coarse = raster.to_pixels(loop[i * loop.size() / n]);
            outline.push_back(snapped(coarse, convex, picture_sides, 1.5 * raster.cell_px()));
        }
        outlines.push_back(outline);
    }
    return outlines;
}

}  // namespace atrium::test
