#include "site_node/hull/clean_views.hpp"

#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/input_limits.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace atrium::hull {
namespace {

constexpr double kMaxCoordinate_px =
    1e6;  // larger than any silhouette; doubles hold no useful fraction of a pixel beyond it
constexpr double kMaxDistance_m = 1e6;         // of a camera from the origin
constexpr std::size_t kMaxFieldPoints = 1000;  // self-contact is tested for all pairs of edges
constexpr double kBoundsMargin_px = 1.0;       // far more than any jitter
constexpr double kMinBounds_m = 1e-3;          // a thinner box holds no person

bool is_valid(const SilhouetteView& view) {
    const geometry::PinholeCamera& c = view.intrinsics;
    const auto& pose = view.camera_from_site;
    const bool finite = std::isfinite(c.fx) && std::isfinite(c.fy) && std::isfinite(c.cx) &&
                        std::isfinite(c.cy) && std::isfinite(c.skew) &&
                        pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
    if (!finite) return false;
    if (std::min(c.fx, c.fy) < kMinFocal_px || std::max(c.fx, c.fy) > kMaxFocal_px) return false;
    if (std::max({std::abs(c.cx), std::abs(c.cy), std::abs(c.skew)}) > kMaxCoordinate_px)
        return false;
    if (std::abs(pose.rotation.squaredNorm() - 1.0) > 1e-6) return false;
    if (pose.translation.cwiseAbs().maxCoeff() > kMaxDistance_m) return false;
    if (!view.field.empty() && !is_usable_field(view.field)) return false;
    for (const Eigen::Vector2d& p : view.field) {
        if (p.cwiseAbs().maxCoeff() > kMaxCoordinate_px) return false;
    }
    for (const auto& contour : view.contours) {
        for (const Eigen::Vector2d& p : contour) {
            if (!(std::abs(p.x()) <= kMaxCoordinate_px && std::abs(p.y()) <= kMaxCoordinate_px))
                return false;
        }
    }
    return true;
}

bool is_valid(const geometry::Aabb& bounds) {
    return bounds.min.allFinite() && bounds.max.allFinite() &&
           bounds.min.cwiseAbs().maxCoeff() <= kMaxDistance_m &&
           bounds.max.cwiseAbs().maxCoeff() <= kMaxDistance_m &&
           (bounds.size().array() >= kMinBounds_m).all();
}

std::uint64_t combine(std::uint64_t h, double value) {
    h ^= std::bit_cast<std::uint64_t>(value + 0.0);  // -0 and 0 are one value
    h *= 0x9e3779b97f4a7c15ULL;
    return h ^ (h >> 29);
}

std::uint64_t content_hash(const SilhouetteView& view, const Outlines& outlines) {
    const geometry::PinholeCamera& c = view.intrinsics;
    std::uint64_t h = 0x243f6a8885a308d3ULL;
    for (const double v : {c.fx, c.fy, c.cx, c.cy, c.skew}) h = combine(h, v);
    for (int i = 0; i < 4; ++i) h = combine(h, view.camera_from_site.rotation.coeffs()[i]);
    for (int i = 0; i < 3; ++i) h = combine(h, view.camera_from_site.translation[i]);
    for (const Eigen::Vector2d& p : outlines.points) h = combine(combine(h, p.x()), p.y());
    for (const std::uint32_t end : outlines.ends) h = combine(h, end);
    for (const Eigen::Vector2d& p : view.field) h = combine(combine(h, p.x()), p.y());
    return h;
}

// Bounding box of the projected bounds [px], enlarged by kBoundsMargin_px to leave room for the
// jitter. nullopt if a corner lies behind the camera.
std::optional<Eigen::AlignedBox2d> project(const geometry::Aabb& bounds,
                                           const SilhouetteView& view) {
    Eigen::AlignedBox2d box;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d p_site((corner & 1) != 0 ? bounds.max.x() : bounds.min.x(),
                                     (corner & 2) != 0 ? bounds.max.y() : bounds.min.y(),
                                     (corner & 4) != 0 ? bounds.max.z() : bounds.min.z());
        const Eigen::Vector3d p_camera = view.camera_from_site * p_site;
        if (p_camera.z() < 1e-3) return std::nullopt;
        box.extend(view.intrinsics.project(p_camera));
    }
    box.min().array() -= kBoundsMargin_px;
    box.max().array() += kBoundsMargin_px;
    return box;
}

void clean_view(const HullOptions& options,
                OutlineScratch& scratch,
                Outlines& outlines,
                CleanViews::View& view) {
    const SilhouetteView& source = *view.source;
    if (!is_valid(source)) {
        view.status = HullStatus::kInvalidInput;
        return;
    }
    copy_canonical(source.contours, options.min_contour_area_px2, scratch, outlines, view.counts);
    if (options.bounds) {
        if (const auto box = project(*options.bounds, source)) drop_outside(outlines, *box);
    }
    if (outlines.num_contours() > kMaxContours) {
        view.status = HullStatus::kTooComplex;
        return;
    }
    view.hash = content_hash(source, outlines);
}

}  // namespace

HullStatus clean_views(std::span<const SilhouetteView* const> views,
                       const HullOptions& options,
                       Executor& executor,
                       CleanViews& clean,
                       VisualHull& hull) {
    if (views.size() + (options.bounds ? kViewsOfBounds : 0) > kMaxViews)
        return HullStatus::kInvalidInput;
    if (options.bounds && !is_valid(*options.bounds)) return HullStatus::kInvalidInput;
    std::size_t num_points = 0;
    for (const SilhouetteView* view : views) {
        for (const auto& contour : view->contours) num_points += contour.size();
        if (view->field.size() > kMaxFieldPoints) return HullStatus::kTooComplex;
        num_points += view->field.size();
    }
    if (num_points > options.max_segments || num_points * views.size() > kMaxPointsTimesViews) {
        return HullStatus::kTooComplex;
    }
    clean.views.resize(views.size());
    if (clean.outlines.size() < views.size()) clean.outlines.resize(views.size());
    if (clean.scratch.size() < executor.num_workers()) clean.scratch.resize(executor.num_workers());
    const auto clean_one = [&](std::size_t v, std::size_t worker) {
        clean.views[v] = {views[v], 0, v, {}, HullStatus::kOk};
        clean_view(options, clean.scratch[worker], clean.outlines[v], clean.views[v]);
    };
    executor.parallel_for(views.size(), clean_one);
    clean.counts = {};
    for (const CleanViews::View& view : clean.views) clean.counts.dropped += view.counts.dropped;
    for (const HullStatus wrong : {HullStatus::kInvalidInput, HullStatus::kTooComplex}) {
        const auto is_wrong = [&](const auto& view) { return view.status == wrong; };
        if (std::any_of(clean.views.begin(), clean.views.end(), is_wrong)) return wrong;
    }
    std::sort(clean.views.begin(), clean.views.end(), [](const auto& l, const auto& r) {
        return l.hash < r.hash;
    });
    const auto same = [](const auto& l, const auto& r) { return l.hash == r.hash; };
    const auto last = std::unique(clean.views.begin(), clean.views.end(), same);
    hull.num_views_merged = static_cast<std::uint32_t>(clean.views.end() - last);
    clean.views.erase(last, clean.views.end());
    return clean.views.size() < (options.bounds ? 1u : 2u) ? HullStatus::kTooFewViews
                                                           : HullStatus::kOk;
}

}  // namespace atrium::hull
