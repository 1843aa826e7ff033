#include "core/geometry/motion_field.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::geometry {
namespace {

constexpr float kReachCells = 2.0F;  // of a cell's motion from its centre
constexpr float kBlendCells = 0.6F;  // standard deviation of the weights
constexpr float kAlikeMps = 0.9F;    // at this difference two cells hardly blend

float lower(const MotionCell& cell) { return cell.centre.z(); }

}  // namespace

void MotionField::assign(std::span<const MotionCell> cells, float cell_m) {
    assert(cell_m > 0.0F);
    cells_.assign(cells.begin(), cells.end());
    cell_m_ = cell_m;
    std::ranges::stable_sort(cells_, {}, lower);
}

FoundMotion MotionField::at(const Eigen::Vector3f& position) const {
    const float reach_m = kReachCells * cell_m_;
    const auto first = std::ranges::lower_bound(cells_, position.z() - reach_m, {}, lower);
    const auto last =
        std::ranges::upper_bound(first, cells_.end(), position.z() + reach_m, {}, lower);
    const auto nearest = std::min_element(first, last, [&](const auto& a, const auto& b) {
        return (a.centre - position).squaredNorm() < (b.centre - position).squaredNorm();
    });
    if (nearest == last || (nearest->centre - position).squaredNorm() > reach_m * reach_m)
        return {};
    const Eigen::Vector3f own = nearest->velocity_at(position);
    const float per_sq = 0.5F / (kBlendCells * kBlendCells * cell_m_ * cell_m_);
    FoundMotion found;
    float weights = 0.0F;
    for (auto cell = first; cell != last; ++cell) {
        const float apart_sq = (cell->centre - position).squaredNorm();
        if (apart_sq > reach_m * reach_m) continue;
        const Eigen::Vector3f theirs = cell->velocity_at(position);
        const float unlike = (theirs - own).squaredNorm() / (kAlikeMps * kAlikeMps);
        const float weight = std::exp(-per_sq * apart_sq) / ((1.0F + unlike) * (1.0F + unlike));
        found.velocity += weight * theirs;
        found.confidence += weight * cell->confidence;
        weights += weight;
    }
    // far from every centre the weights may vanish
    if (weights < 1e-12F) return {own, nearest->confidence};
    found.velocity /= weights;
    found.confidence /= weights;
    return found;
}

}  // namespace atrium::geometry
