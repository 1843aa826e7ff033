#include "site_node/hull/cones.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace atrium::hull {
namespace {

constexpr double kMaxCoordinate_px =
    1e6;  // no silhouette is larger; beyond, pixels lose their meaning in double
constexpr double kMaxDistance_m = 1e6;             // of a camera from the origin
constexpr std::size_t kMaxPencilRays = 4'000'000;  // each is kept for each other view: 250 MB
constexpr std::size_t kMaxContours = 2000;         // of one view; nesting is tested pairwise
constexpr double kFirstJitter_px = 1e-6;           // moves a surface 3 m away by 3 nm
constexpr double kJitterGrowth = 10.0;             // per attempt
constexpr double kSameCentre_m = 1e-6;  // two centres nearer than this span no usable baseline
constexpr std::uint64_t kTestsPerSegment =
    2000;  // of the search for crossings: reached only by scribbles

bool is_valid(const SilhouetteView& view) {
    const geometry::PinholeCamera& c = view.intrinsics;
    const auto& pose = view.camera_from_site;
    const bool finite = std::isfinite(c.fx) && std::isfinite(c.fy) && std::isfinite(c.cx) &&
                        std::isfinite(c.cy) && std::isfinite(c.skew) &&
                        pose.translation.allFinite() && pose.rotation.coeffs().allFinite();
    if (!finite || c.fx <= 0.0 || c.fy <= 0.0) return false;
    if (std::abs(pose.rotation.squaredNorm() - 1.0) > 1e-6) return false;
    if (pose.translation.cwiseAbs().maxCoeff() > kMaxDistance_m) return false;
    for (const auto& contour : view.contours) {
        for (const Eigen::Vector2d& p : contour) {
            if (!(std::abs(p.x()) <= kMaxCoordinate_px && std::abs(p.y()) <= kMaxCoordinate_px))
                return false;
        }
    }
    return true;
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
    return h;
}

// Coinciding centres (one camera's two silhouettes) leave the pencil without an axis: move one of
// them a little.
void separate_centres(std::vector<Cones::View>& views) {
    for (std::size_t i = 1; i < views.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if ((views[i].centre - views[k].centre).norm() >= kSameCentre_m) continue;
            const auto n = static_cast<double>(i);
            views[i].centre +=
                3.0 * kSameCentre_m *
                Eigen::Vector3d(std::sin(n), std::cos(2.0 * n), std::sin(3.0 * n + 1.0));
            k = static_cast<std::size_t>(-1);  // again, against all
        }
    }
}

void append_rays(Cones& cones, std::size_t v) {
    Cones::View& view = cones.views[v];
    const Outlines& outlines = cones.outlines[v];
    const Eigen::Matrix3d site_from_camera = view.camera_from_site.transpose();
    const auto first_contour = cones.contour.empty() ? 0u : cones.contour.back() + 1;
    view.first = static_cast<std::uint32_t>(cones.ray.size());
    for (std::uint32_t c = 0; c < outlines.num_contours(); ++c) {
        const std::span<const Eigen::Vector2d> loop = outlines.contour(c);
        const auto begin = static_cast<std::uint32_t>(cones.ray.size());
        const auto n = static_cast<std::uint32_t>(loop.size());
        for (std::uint32_t i = 0; i < n; ++i) {
            const Eigen::Vector2d& p = loop[i];
            const Eigen::Vector2d& q = loop[(i + 1) % n];
            const Eigen::Vector3d ray = site_from_camera * view.intrinsics.ray_camera(p);
            // the difference of the two rays is exact to the last bit of the pixels, a product of
            // the rays is not
            const geometry::PinholeCamera& k = view.intrinsics;
            const double dy = (q.y() - p.y()) / k.fy;
            const Eigen::Vector3d along =
                site_from_camera * Eigen::Vector3d((q.x() - p.x() - k.skew * dy) / k.fx, dy, 0.0);
            cones.ray.push_back(ray);
            cones.normal.push_back(along.cross(ray));
            cones.next.push_back(begin + (i + 1) % n);
            cones.prev.push_back(begin + (i + n - 1) % n);
            cones.contour.push_back(first_contour + c);
            cones.view_of.push_back(static_cast<std::uint8_t>(v));
        }
    }
    view.last = static_cast<std::uint32_t>(cones.ray.size());
}

void clear_rays(Cones& cones) {
    cones.ray.clear();
    cones.normal.clear();
    cones.next.clear();
    cones.prev.clear();
    cones.contour.clear();
    cones.view_of.clear();
}

void place_cameras(const CleanViews& clean, Cones& cones) {
    cones.views.resize(clean.views.size());
    cones.origin.setZero();
    for (std::size_t v = 0; v < clean.views.size(); ++v) {
        const SilhouetteView& source = *clean.views[v].source;
        Cones::View& view = cones.views[v];
        view.intrinsics = source.intrinsics;
        view.camera_from_site = source.camera_from_site.rotation.normalized().toRotationMatrix();
        view.axis = view.camera_from_site.row(2).transpose();
        view.centre = -(view.camera_from_site.transpose() * source.camera_from_site.translation);
        cones.origin += view.centre / static_cast<double>(clean.views.size());
    }
    for (Cones::View& view : cones.views) view.centre -= cones.origin;
    separate_centres(cones.views);
}

}  // namespace

std::uint64_t Cones::views_around_centre(std::size_t i) const {
    std::uint64_t mask = std::uint64_t{1} << i;
    for (std::size_t k = 0; k < views.size(); ++k) {
        if (k == i) continue;
        const Eigen::Vector3d p = views[k].camera_from_site * (views[i].centre - views[k].centre);
        if (p.z() > 0.0 && contains(outlines[k], views[k].intrinsics.project(p)))
            mask |= std::uint64_t{1} << k;
    }
    return mask;
}

HullStatus clean_views(std::span<const SilhouetteView> views,
                       const HullOptions& options,
                       ConeScratch& scratch,
                       VisualHull& hull) {
    if (views.size() > kMaxViews) return HullStatus::kInvalidInput;
    std::size_t num_points = 0;
    for (const SilhouetteView& view : views) {
        for (const auto& contour : view.contours) num_points += contour.size();
    }
    if (num_points > options.max_segments || num_points * views.size() > kMaxPencilRays) {
        return HullStatus::kTooComplex;
    }
    if (!std::all_of(views.begin(), views.end(), is_valid)) return HullStatus::kInvalidInput;

    CleanViews& clean = scratch.clean;
    clean.views.clear();
    if (clean.outlines.size() < views.size()) clean.outlines.resize(views.size());
    scratch.clean_counts = {};
    for (std::size_t v = 0; v < views.size(); ++v) {
        copy_canonical(views[v].contours,
                       options.min_contour_area_px2,
                       scratch.outline,
                       clean.outlines[v],
                       scratch.clean_counts);
        if (clean.outlines[v].num_contours() > kMaxContours) return HullStatus::kTooComplex;
        clean.views.push_back({&views[v], content_hash(views[v], clean.outlines[v]), v});
    }
    std::sort(clean.views.begin(), clean.views.end(), [](const auto& l, const auto& r) {
        return l.hash < r.hash;
    });
    const auto same = [](const auto& l, const auto& r) { return l.hash == r.hash; };
    const auto last = std::unique(clean.views.begin(), clean.views.end(), same);
    hull.num_views_merged = static_cast<std::uint32_t>(clean.views.end() - last);
    clean.views.erase(last, clean.views.end());
    return clean.views.size() < 2 ? HullStatus::kTooFewViews : HullStatus::kOk;
}

HullStatus build_cones(const HullOptions& options,
                       std::uint32_t attempt,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull) {
    const CleanViews& clean = scratch.clean;
    const std::size_t n = clean.views.size();
    place_cameras(clean, cones);
    if (cones.outlines.size() < n) cones.outlines.resize(n);
    clear_rays(cones);
    OutlineCounts counts = scratch.clean_counts;
    bool sees_nobody = false;
    for (std::size_t v = 0; v < n; ++v) {
        Outlines& outlines = cones.outlines[v];
        outlines = clean.outlines[clean.views[v].outlines_index];
        jitter(outlines,
               kFirstJitter_px * std::pow(kJitterGrowth, attempt),
               clean.views[v].hash + attempt);
        const std::uint64_t max_tests = 100'000 + kTestsPerSegment * outlines.points.size();
        if (!make_simple(
                outlines, options.min_contour_area_px2, max_tests, scratch.outline, counts)) {
            return HullStatus::kTooComplex;
        }
        orient_by_nesting(outlines);
        append_rays(cones, v);
        sees_nobody |= outlines.num_contours() == 0;
    }
    hull.num_contours_dropped = counts.dropped;
    hull.num_contours_repaired = counts.repaired;
    return sees_nobody ? HullStatus::kEmptyIntersection : HullStatus::kOk;
}

}  // namespace atrium::hull
