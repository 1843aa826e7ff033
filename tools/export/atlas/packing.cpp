#include "tools/export/atlas/packing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

namespace atrium::exporting {
namespace {

constexpr int kGranularity = 16;     // JPEG's blocks with halved chroma
constexpr double kUsualFill = 0.85;  // of the skyline method

struct Step {
    int x = 0;
    int y = 0;  // free from here on
    int width = 0;
};

int round_up(int size) { return (size + kGranularity - 1) / kGranularity * kGranularity; }

class Skyline {
public:
    explicit Skyline(int width) : width_(width), steps_{{0, 0, width}} {}

    Eigen::Vector2i add(const Eigen::Vector2i& size) {
        std::size_t best = 0;
        int best_y = std::numeric_limits<int>::max();
        for (std::size_t i = 0; i < steps_.size() && steps_[i].x + size.x() <= width_; ++i) {
            if (const int y = height_over(i, size.x()); y < best_y) {
                best_y = y;
                best = i;
            }
        }
        const Eigen::Vector2i place(steps_[best].x, best_y);
        cover(best, {place.x(), best_y + size.y(), size.x()});
        return place;
    }
    int height() const { return std::ranges::max_element(steps_, {}, &Step::y)->y; }

private:
    int height_over(std::size_t first, int width) const {
        int y = 0;
        const int end = steps_[first].x + width;
        for (std::size_t i = first; i < steps_.size() && steps_[i].x < end; ++i)
            y = std::max(y, steps_[i].y);
        return y;
    }
    void cover(std::size_t first, const Step& step) {
        const int end = step.x + step.width;
        std::size_t last = first;
        while (last < steps_.size() && steps_[last].x + steps_[last].width <= end) ++last;
        if (last < steps_.size() && steps_[last].x < end) {
            steps_[last].width -= end - steps_[last].x;
            steps_[last].x = end;
        }
        const auto at = steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(first),
                                     steps_.begin() + static_cast<std::ptrdiff_t>(last));
        steps_.insert(at, step);
    }

    int width_;
    std::vector<Step> steps_;  // by x, without gaps
};

}  // namespace

Packing pack(std::span<const Eigen::Vector2i> rectangles) {
    double area = 0.0;
    int widest = 1;
    for (const Eigen::Vector2i& size : rectangles) {
        area += static_cast<double>(size.x()) * size.y();
        widest = std::max(widest, size.x());
    }
    Packing result;
    const int width =
        round_up(std::max(widest, static_cast<int>(std::ceil(std::sqrt(area / kUsualFill)))));
    std::vector<std::size_t> order(rectangles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return rectangles[a].y() != rectangles[b].y() ? rectangles[a].y() > rectangles[b].y()
                                                      : rectangles[a].x() > rectangles[b].x();
    });
    Skyline skyline(width);
    result.places.resize(rectangles.size());
    for (const std::size_t i : order) result.places[i] = skyline.add(rectangles[i]);
    result.size = {width, round_up(std::max(1, skyline.height()))};
    return result;
}

}  // namespace atrium::exporting
