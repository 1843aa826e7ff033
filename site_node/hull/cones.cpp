#include "site_node/hull/cones.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::hull {
namespace {

constexpr double kFirstJitter_px = 1e-6;   // moves a surface 3 m away by 3 nm
constexpr double kFirstJitter_rad = 1e-8;  // the same for the edges of the bounds
constexpr double kJitterGrowth = 10.0;     // per attempt
constexpr double kMinExtent_m = 1e-3;   // a rig of cameras in one place is spread to a part of this
constexpr double kSameCentre_m = 1e-6;  // two centres nearer than this span no usable baseline
constexpr std::uint64_t kTestsPerSegment =
    2000;  // of the search for crossings: reached only by scribbles

// Of silhouette points; never less than some steps of the grid on which rays end.
double jitter_px(const SilhouetteView& view, std::uint32_t attempt) {
    const double grid_px = 2.0 / exact::kMaxRay * std::max(view.intrinsics.fx, view.intrinsics.fy);
    return std::max(kFirstJitter_px, 4.0 * grid_px) * std::pow(kJitterGrowth, attempt);
}

// Coinciding centres (one camera's two silhouettes) leave the pencil without an axis: move one of
// them a little.
void separate_centres(double distance_m, std::vector<Cones::View>& views) {
    for (std::size_t i = 1; i < views.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if ((views[i].centre - views[k].centre).norm() >= distance_m) continue;
            const auto n = static_cast<double>(i);
            views[i].centre +=
                3.0 * distance_m *
                Eigen::Vector3d(std::sin(n), std::cos(2.0 * n), std::sin(3.0 * n + 1.0));
            k = static_cast<std::size_t>(-1);  // again, against all
        }
    }
}

// Largest power of two by which `largest` stays below `limit`.
double grid_scale(double largest, double limit) {
    return std::exp2(std::floor(std::log2(limit / std::max(largest, 1e-300))));
}

exact::Vector to_grid(const Eigen::Vector3d& v, double scale) {
    return {std::llround(v.x() * scale), std::llround(v.y() * scale), std::llround(v.z() * scale)};
}

Eigen::Vector3d from_grid(const exact::Vector& v, double scale) {
    return Eigen::Vector3d(
               static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])) /
           scale;
}

// Any rotation that is far from all that rooms and rigs are aligned to.
Eigen::Matrix3d skew_rotation() {
    return Eigen::Quaterniond(0.7346, 0.3181, -0.2367, 0.5502).normalized().toRotationMatrix();
}

// A box is the intersection of two cones: the octants at two opposite corners, in this order.
constexpr std::array<double, 2> kOctants{1.0, -1.0};

void add_bounds(const geometry::Aabb& bounds, Cones& cones) {
    for (const double sign : kOctants) {
        Cones::View view;
        view.centre = sign > 0.0 ? bounds.min : bounds.max;
        view.camera_from_grid = cones.grid_from_site.transpose();
        view.axis = cones.grid_from_site * Eigen::Vector3d::Constant(sign / std::sqrt(3.0));
        view.is_bounds = true;
        cones.views.push_back(view);
    }
}

void place_views(const CleanViews& clean, const HullOptions& options, Cones& cones) {
    static const Eigen::Matrix3d kGridFromSite = skew_rotation();
    cones.views.clear();
    cones.grid_from_site = kGridFromSite;
    cones.origin.setZero();
    for (const CleanViews::View& clean_view : clean.views) {
        const SilhouetteView& source = *clean_view.source;
        Cones::View view;
        const Eigen::Matrix3d camera_from_site =
            source.camera_from_site.rotation.normalized().toRotationMatrix();
        view.camera_from_grid = camera_from_site * cones.grid_from_site.transpose();
        view.axis = view.camera_from_grid.row(2).transpose();
        view.centre = -(camera_from_site.transpose() * source.camera_from_site.translation);
        view.is_partial = !source.field.empty();
        cones.origin += view.centre / static_cast<double>(clean.views.size());
        cones.views.push_back(view);
    }
    if (options.bounds) add_bounds(*options.bounds, cones);
    double largest = kMinExtent_m;
    for (Cones::View& view : cones.views) {
        view.centre = cones.grid_from_site * (view.centre - cones.origin);
        largest = std::max(largest, view.centre.cwiseAbs().maxCoeff());
    }
    // half of the range is left for centres that have to be separated
    const double scale = grid_scale(largest, 0.5 * exact::kMaxCentre);
    cones.centre_unit_m = 1.0 / scale;
    separate_centres(std::max(kSameCentre_m, 64.0 * cones.centre_unit_m), cones.views);
    for (Cones::View& view : cones.views) {
        view.exact_centre = to_grid(view.centre, scale);
        view.centre = from_grid(view.exact_centre, scale);
    }
}

// The rays of `view` onto their grid; rays of one view share the scale.
void append_rays(std::span<const Eigen::Vector3d> rays, Cones::View& view, Cones& cones) {
    double largest = 0.0;
    for (const Eigen::Vector3d& ray : rays) largest = std::max(largest, ray.cwiseAbs().maxCoeff());
    const double scale = grid_scale(largest, exact::kMaxRay);
    view.ray_unit = 1.0 / scale;
    view.first_ray = static_cast<std::uint32_t>(cones.ray.size());
    for (const Eigen::Vector3d& ray : rays) {
        const exact::Vector on_grid = to_grid(ray, scale);
        cones.exact_ray.push_back(on_grid);
        cones.ray.push_back(from_grid(on_grid, scale));
        cones.ray_length.push_back(cones.ray.back().norm());
        cones.incidence.emplace_back();
    }
    view.last_ray = static_cast<std::uint32_t>(cones.ray.size());
}

Cones::Strip make_strip(const Cones& cones, std::size_t v, SegmentKind kind) {
    Cones::Strip strip;
    strip.view = static_cast<std::uint8_t>(v);
    strip.kind = kind;
    const std::uint64_t bit = std::uint64_t{1} << v;
    const bool counts = cones.views[v].is_partial && cones.min_seen > 0;
    if (kind != SegmentKind::kUnseen) strip.toggles.carved = bit;
    if (counts && kind != SegmentKind::kOutside) strip.toggles.seen = bit;
    strip.min_seen = cones.min_seen;
    if (counts && kind != SegmentKind::kOutside) strip.min_seen -= 1;  // its own view sees
    // on both sides nobody carves: the view's own sight has to decide
    if (kind == SegmentKind::kUnseen) strip.max_seen = strip.min_seen;
    return strip;
}

void append_strips(const LabelledOutlines& labelled, std::size_t v, Cones& cones) {
    Cones::View& view = cones.views[v];
    view.first_strip = static_cast<std::uint32_t>(cones.strips.size());
    for (const LabelledOutlines::Segment& segment : labelled.segments) {
        Cones::Strip strip = make_strip(cones, v, segment.kind);
        strip.from = view.first_ray + segment.from;
        strip.to = view.first_ray + segment.to;
        // kNoLoop wraps to some number that nobody asks for
        strip.foreground_loop = cones.num_loops + segment.foreground_loop;
        strip.background_loop = cones.num_loops + segment.background_loop;
        const auto id = static_cast<std::uint32_t>(cones.strips.size());
        for (const std::uint32_t ray : {strip.from, strip.to}) {
            Cones::Incidence& at = cones.incidence[ray];
            if (at.count < at.strips.size()) at.strips[at.count] = id;
            ++at.count;
        }
        // the difference is exact, a product of the rays would not be
        const Eigen::Vector3d along = cones.ray[strip.to] - cones.ray[strip.from];
        cones.normal.push_back(along.cross(cones.ray[strip.from]));
        cones.normal_bound.push_back(along.norm() * cones.ray_length[strip.from]);
        cones.strips.push_back(strip);
    }
    cones.num_loops += std::max(labelled.num_foreground_loops, labelled.num_background_loops);
    std::uint32_t first = view.first_strip;
    for (const std::uint32_t end : labelled.chain_ends) {
        cones.chains.push_back({first, view.first_strip + end});
        first = view.first_strip + end;
    }
    view.last_strip = static_cast<std::uint32_t>(cones.strips.size());
}

void append_camera(const SilhouetteView& source,
                   std::size_t v,
                   ConeScratch& scratch,
                   Cones& cones) {
    const Eigen::Matrix3d grid_from_camera = cones.views[v].camera_from_grid.transpose();
    scratch.rays.clear();
    for (const Eigen::Vector2d& p : scratch.labelled.points)
        scratch.rays.emplace_back(grid_from_camera * source.intrinsics.ray_camera(p));
    append_rays(scratch.rays, cones.views[v], cones);
    append_strips(scratch.labelled, v, cones);
}

// What the outlines of a view and its field say about directions.
bool label(const SilhouetteView& source,
           std::uint32_t attempt,
           std::uint64_t hash,
           bool keep_unseen,
           ConeScratch& scratch) {
    if (source.field.empty()) {
        label_without_field(scratch.outlines, scratch.labelled);
        return true;
    }
    scratch.field.clear();
    scratch.field.append(source.field);
    jitter(scratch.field, jitter_px(source, attempt), ~hash + attempt);
    return cut_by_field(scratch.outlines,
                        scratch.field.points,
                        keep_unseen,
                        scratch.field_scratch,
                        scratch.labelled);
}

// Three rays along the edges that leave one corner of the bounds.
void append_bounds(
    std::size_t v, double sign, std::uint32_t attempt, ConeScratch& scratch, Cones& cones) {
    Outlines& nudges = scratch.outlines;
    nudges.clear();
    const std::array<Eigen::Vector2d, 3> zeros{
        Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.0, sign), Eigen::Vector2d(sign, 0.0)};
    nudges.append(zeros);
    jitter(nudges, kFirstJitter_rad * std::pow(kJitterGrowth, attempt), attempt);
    scratch.rays.clear();
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const Eigen::Vector2d nudge = nudges.points[a] - zeros[a];
        Eigen::Vector3d ray = Eigen::Vector3d::Zero();
        ray[axis] = sign;
        ray[(axis + 1) % 3] = nudge.x();
        ray[(axis + 2) % 3] = nudge.y();
        scratch.rays.push_back(cones.grid_from_site * ray);
    }
    // the mirrored corner sees its edges the other way round
    if (sign < 0.0) std::swap(scratch.rays[1], scratch.rays[2]);
    append_rays(scratch.rays, cones.views[v], cones);
    scratch.outlines.clear();
    scratch.outlines.append(zeros);
    label_without_field(scratch.outlines, scratch.labelled);
    append_strips(scratch.labelled, v, cones);
}

void clear_rays(Cones& cones) {
    cones.ray.clear();
    cones.ray_length.clear();
    cones.exact_ray.clear();
    cones.incidence.clear();
    cones.strips.clear();
    cones.normal.clear();
    cones.normal_bound.clear();
    cones.chains.clear();
    cones.num_loops = 0;
}

}  // namespace

HullStatus build_cones(const CleanViews& clean,
                       const HullOptions& options,
                       std::uint32_t attempt,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull) {
    cones.only_exact = options.only_exact;
    place_views(clean, options, cones);
    clear_rays(cones);
    const auto num_partial = static_cast<std::uint32_t>(std::count_if(
        cones.views.begin(), cones.views.end(), [](const auto& view) { return view.is_partial; }));
    const auto num_whole = static_cast<std::uint32_t>(clean.views.size()) - num_partial;
    cones.min_seen = options.min_views > num_whole ? options.min_views - num_whole : 0;
    OutlineCounts counts = clean.counts;
    bool sees_nobody = cones.min_seen > num_partial;
    for (std::size_t v = 0; v < clean.views.size(); ++v) {
        const SilhouetteView& source = *clean.views[v].source;
        Outlines& outlines = scratch.outlines;
        outlines = clean.outlines[clean.views[v].outlines_index];
        jitter(outlines, jitter_px(source, attempt), clean.views[v].hash + attempt);
        const std::uint64_t max_tests = 100'000 + kTestsPerSegment * outlines.points.size();
        if (!make_simple(
                outlines, options.min_contour_area_px2, max_tests, scratch.outline, counts)) {
            return HullStatus::kTooComplex;
        }
        orient_by_nesting(outlines);
        if (!label(source, attempt, clean.views[v].hash, cones.min_seen > 0, scratch))
            return HullStatus::kNumericFailure;
        append_camera(source, v, scratch, cones);
        sees_nobody |= outlines.num_contours() == 0 && !cones.views[v].is_partial;
    }
    for (std::size_t v = clean.views.size(); v < cones.num_views(); ++v)
        append_bounds(v, kOctants[v - clean.views.size()], attempt, scratch, cones);
    hull.num_contours_dropped = counts.dropped;
    hull.num_contours_repaired = counts.repaired;
    if (sees_nobody) return HullStatus::kEmptyIntersection;
    return cones.strips.size() <= kMaxStrips ? HullStatus::kOk : HullStatus::kTooComplex;
}

}  // namespace atrium::hull
