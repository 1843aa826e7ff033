#include "site_node/hull/cones.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::hull {
namespace {

constexpr double kFirstJitter_px = 1e-6;   // 3 nm on a surface 3 m away
constexpr double kFirstJitter_rad = 1e-8;  // for the edges of the bounds
constexpr double kJitterGrowth = 10.0;     // per attempt
constexpr double kMinExtent_m = 1e-3;      // extent assumed for a rig with all cameras in one place
constexpr double kSameCentre_m = 1e-6;     // centres nearer than this have no usable baseline
constexpr std::uint64_t kTestsPerSegment =
    2000;  // limit of the search for crossings; only scribbles reach it

// Jitter of silhouette points [px]: at least four steps of the grid of the rays.
double jitter_px(const SilhouetteView& view, std::uint32_t attempt) {
    const double grid_px = 2.0 / exact::kMaxRay * std::max(view.intrinsics.fx, view.intrinsics.fy);
    return std::max(kFirstJitter_px, 4.0 * grid_px) * std::pow(kJitterGrowth, attempt);
}

// Moves coinciding centres (two silhouettes of one camera) slightly apart: their pencil would have
// no axis.
void separate_centres(double distance_m, std::vector<Cones::View>& views) {
    for (std::size_t i = 1; i < views.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if ((views[i].centre - views[k].centre).norm() >= distance_m) continue;
            const auto n = static_cast<double>(i);
            views[i].centre +=
                3.0 * distance_m *
                Eigen::Vector3d(std::sin(n), std::cos(2.0 * n), std::sin(3.0 * n + 1.0));
            k = static_cast<std::size_t>(-1);  // restart: compare with all others again
        }
    }
}

// Returns the largest power of two p with p * largest <= limit.
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

// A fixed rotation far from all alignments of rooms and rigs.
Eigen::Matrix3d skew_rotation() {
    return Eigen::Quaterniond(0.7346, 0.3181, -0.2367, 0.5502).normalized().toRotationMatrix();
}

// A box is the intersection of two cones, the octants at two opposite corners. Signs of their
// directions, in the order of the views.
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
    // the other half of the range is for centres that have to be moved apart
    const double scale = grid_scale(largest, 0.5 * exact::kMaxCentre);
    cones.centre_unit_m = 1.0 / scale;
    separate_centres(std::max(kSameCentre_m, 64.0 * cones.centre_unit_m), cones.views);
    for (Cones::View& view : cones.views) {
        view.exact_centre = to_grid(view.centre, scale);
        view.centre = from_grid(view.exact_centre, scale);
    }
}

// Rounds the rays of view v to their grid; all rays of a view share its scale.
void place_rays(std::span<const Eigen::Vector3d> rays, std::size_t v, Cones& cones) {
    Cones::View& view = cones.views[v];
    double largest = 0.0;
    for (const Eigen::Vector3d& ray : rays) largest = std::max(largest, ray.cwiseAbs().maxCoeff());
    const double scale = grid_scale(largest, exact::kMaxRay);
    view.ray_unit = 1.0 / scale;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::size_t id = view.first_ray + i;
        cones.exact_ray[id] = to_grid(rays[i], scale);
        cones.ray[id] = from_grid(cones.exact_ray[id], scale);
        cones.ray_length[id] = cones.ray[id].norm();
        cones.incidence[id] = {};
    }
}

Cones::Strip make_strip(const Cones& cones, std::size_t v, SegmentKind kind) {
    Cones::Strip strip;
    strip.view = static_cast<std::uint8_t>(v);
    strip.kind = kind;
    const bool counts = cones.views[v].is_partial && cones.min_seen > 0;
    strip.min_seen = cones.min_seen;
    if (counts && kind != SegmentKind::kOutside) strip.min_seen -= 1;  // the view sees on one side
    // the view carves on neither side, so only the number of views that see decides
    if (kind == SegmentKind::kUnseen) strip.max_seen = strip.min_seen;
    return strip;
}

Cones::Toggles toggles_of(const Cones& cones, std::size_t v, SegmentKind kind) {
    const bool counts = cones.views[v].is_partial && cones.min_seen > 0;
    const unsigned carved = kind != SegmentKind::kUnseen ? 1 : 0;
    const unsigned seen = counts && kind != SegmentKind::kOutside ? 2 : 0;
    return {static_cast<std::uint8_t>(carved | seen)};
}

void place_strips(const ConeScratch::View& prepared, std::size_t v, Cones& cones) {
    const Cones::View& view = cones.views[v];
    std::uint32_t id = view.first_strip;
    for (const LabelledOutlines::Segment& segment : prepared.labelled.segments) {
        Cones::Strip strip = make_strip(cones, v, segment.kind);
        strip.from = view.first_ray + segment.from;
        strip.to = view.first_ray + segment.to;
        // kNoLoop wraps around; that number is never read
        strip.foreground_loop = prepared.first_loop + segment.foreground_loop;
        strip.background_loop = prepared.first_loop + segment.background_loop;
        for (const std::uint32_t ray : {strip.from, strip.to}) {
            Cones::Incidence& at = cones.incidence[ray];
            if (at.count < at.strips.size()) at.strips[at.count] = id;
            ++at.count;
        }
        // the difference of two rays is exact, their product would not be
        const Eigen::Vector3d along = cones.ray[strip.to] - cones.ray[strip.from];
        cones.normal[id] = along.cross(cones.ray[strip.from]);
        cones.normal_bound[id] = along.norm() * cones.ray_length[strip.from];
        cones.toggles[id] = toggles_of(cones, v, segment.kind);
        cones.strips[id++] = strip;
    }
}

// Numbers rays, strips and loops through all views, and sizes their arrays.
void number(ConeScratch& scratch, Cones& cones) {
    std::uint32_t num_rays = 0;
    std::uint32_t num_strips = 0;
    cones.num_loops = 0;
    cones.chains.clear();
    for (std::size_t v = 0; v < cones.num_views(); ++v) {
        Cones::View& view = cones.views[v];
        const LabelledOutlines& labelled = scratch.views[v].labelled;
        view.first_ray = num_rays;
        view.last_ray = num_rays += static_cast<std::uint32_t>(scratch.views[v].rays.size());
        view.first_strip = num_strips;
        view.last_strip = num_strips += static_cast<std::uint32_t>(labelled.segments.size());
        scratch.views[v].first_loop = cones.num_loops;
        cones.num_loops += std::max(labelled.num_foreground_loops, labelled.num_background_loops);
        std::uint32_t first = view.first_strip;
        for (const std::uint32_t end : labelled.chain_ends) {
            cones.chains.push_back({first, view.first_strip + end});
            first = view.first_strip + end;
        }
    }
    cones.ray.resize(num_rays);
    cones.ray_length.resize(num_rays);
    cones.exact_ray.resize(num_rays);
    cones.incidence.resize(num_rays);
    cones.strips.resize(num_strips);
    cones.toggles.resize(num_strips);
    cones.normal.resize(num_strips);
    cones.normal_bound.resize(num_strips);
}

// Labels the segments of one view. False if its outlines and field contradict each other.
bool label(const SilhouetteView& source,
           std::uint32_t attempt,
           std::uint64_t hash,
           bool keep_unseen,
           ConeScratch::Worker& scratch,
           LabelledOutlines& labelled) {
    if (source.field.empty()) {
        label_without_field(scratch.outlines, labelled);
        return true;
    }
    scratch.field.clear();
    scratch.field.append(source.field);
    jitter(scratch.field, jitter_px(source, attempt), ~hash + attempt);
    return cut_by_field(
        scratch.outlines, scratch.field.points, keep_unseen, scratch.field_scratch, labelled);
}

void prepare_camera(const CleanViews& clean,
                    const HullOptions& options,
                    std::uint32_t attempt,
                    std::size_t v,
                    const Cones& cones,
                    ConeScratch::Worker& scratch,
                    ConeScratch::View& out) {
    const SilhouetteView& source = *clean.views[v].source;
    Outlines& outlines = scratch.outlines;
    outlines = clean.outlines[clean.views[v].outlines_index];
    jitter(outlines, jitter_px(source, attempt), clean.views[v].hash + attempt);
    const std::uint64_t max_tests = 100'000 + kTestsPerSegment * outlines.points.size();
    if (!make_simple(
            outlines, options.min_contour_area_px2, max_tests, scratch.outline, out.counts)) {
        out.status = HullStatus::kTooComplex;
        return;
    }
    orient_by_nesting(outlines);
    if (!label(source, attempt, clean.views[v].hash, cones.min_seen > 0, scratch, out.labelled)) {
        out.status = HullStatus::kNumericFailure;
        return;
    }
    const Eigen::Matrix3d grid_from_camera = cones.views[v].camera_from_grid.transpose();
    for (const Eigen::Vector2d& p : out.labelled.points)
        out.rays.emplace_back(grid_from_camera * source.intrinsics.ray_camera(p));
    out.sees_nobody = outlines.num_contours() == 0 && !cones.views[v].is_partial;
}

// The view of one corner of the bounds: three rays along the edges that leave the corner.
void prepare_bounds(double sign,
                    std::uint32_t attempt,
                    const Cones& cones,
                    ConeScratch::Worker& scratch,
                    ConeScratch::View& out) {
    Outlines& nudges = scratch.outlines;
    nudges.clear();
    const std::array<Eigen::Vector2d, 3> zeros{
        Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.0, sign), Eigen::Vector2d(sign, 0.0)};
    nudges.append(zeros);
    jitter(nudges, kFirstJitter_rad * std::pow(kJitterGrowth, attempt), attempt);
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const Eigen::Vector2d nudge = nudges.points[a] - zeros[a];
        Eigen::Vector3d ray = Eigen::Vector3d::Zero();
        ray[axis] = sign;
        ray[(axis + 1) % 3] = nudge.x();
        ray[(axis + 2) % 3] = nudge.y();
        out.rays.push_back(cones.grid_from_site * ray);
    }
    // the opposite corner sees its edges in mirrored order
    if (sign < 0.0) std::swap(out.rays[1], out.rays[2]);
    scratch.outlines.clear();
    scratch.outlines.append(zeros);
    label_without_field(scratch.outlines, out.labelled);
}

}  // namespace

HullStatus build_cones(const CleanViews& clean,
                       const HullOptions& options,
                       std::uint32_t attempt,
                       Executor& executor,
                       ConeScratch& scratch,
                       Cones& cones,
                       VisualHull& hull) {
    cones.only_exact = options.only_exact;
    place_views(clean, options, cones);
    const auto num_partial = static_cast<std::uint32_t>(std::count_if(
        cones.views.begin(), cones.views.end(), [](const auto& view) { return view.is_partial; }));
    const std::size_t num_cameras = clean.views.size();
    const auto num_whole = static_cast<std::uint32_t>(num_cameras) - num_partial;
    cones.min_seen = options.min_views > num_whole ? options.min_views - num_whole : 0;
    if (scratch.views.size() < cones.num_views()) scratch.views.resize(cones.num_views());
    if (scratch.workers.size() < executor.num_workers())
        scratch.workers.resize(executor.num_workers());
    const auto prepare = [&](std::size_t v, std::size_t worker) {
        ConeScratch::View& out = scratch.views[v];
        out.status = HullStatus::kOk;
        out.counts = {};
        out.sees_nobody = false;
        out.rays.clear();
        if (v < num_cameras) {
            prepare_camera(clean, options, attempt, v, cones, scratch.workers[worker], out);
        } else {
            prepare_bounds(kOctants[v - num_cameras], attempt, cones, scratch.workers[worker], out);
        }
    };
    executor.parallel_for(cones.num_views(), prepare);
    OutlineCounts counts = clean.counts;
    bool sees_nobody = cones.min_seen > num_partial;
    for (std::size_t v = 0; v < cones.num_views(); ++v) {
        const ConeScratch::View& view = scratch.views[v];
        if (view.status != HullStatus::kOk) return view.status;
        counts.dropped += view.counts.dropped;
        counts.repaired += view.counts.repaired;
        sees_nobody |= view.sees_nobody;
    }
    number(scratch, cones);
    const auto place = [&](std::size_t v, std::size_t) {
        place_rays(scratch.views[v].rays, v, cones);
        place_strips(scratch.views[v], v, cones);
    };
    executor.parallel_for(cones.num_views(), place);
    hull.num_contours_dropped = counts.dropped;
    hull.num_contours_repaired = counts.repaired;
    if (sees_nobody) return HullStatus::kEmptyIntersection;
    const bool fits = std::max(cones.strips.size(), cones.ray.size()) <= kMaxStrips;
    return fits ? HullStatus::kOk : HullStatus::kTooComplex;
}

}  // namespace atrium::hull
