#include "site_node/refine/inward_sweep.hpp"

#include "site_node/refine/colour_clash.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace atrium::refine {
namespace {

constexpr int kDepthPicturePx = 192;      // long side
constexpr float kHiddenBehind_m = 0.03F;  // behind a nearer surface

// Scores of all steps, for vector instructions that every x86-64 has.
using FourScores = float __attribute__((vector_size(16)));
using Scores = std::array<FourScores, InwardSweep::kNumSteps / 4>;

// Of a camera without distortion: homogeneous pixels from points in its frame.
Eigen::Matrix3d linear_part(const geometry::PinholeCamera& camera) {
    Eigen::Matrix3d px_from_camera;
    px_from_camera << camera.fx, camera.skew, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
    return px_from_camera;
}

}  // namespace

// Pixel, without distortion, and inverse depth; 0 behind the camera.
Eigen::Vector3f InwardSweep::Camera::place_of(const Eigen::Vector3f& point_site) const {
    Eigen::Vector3f at = px_from_site * point_site + offset;
    if (!(at.z() > static_cast<float>(kNearest_m))) return Eigen::Vector3f::Zero();
    const float per_depth = 1.0F / at.z();
    return {at.x() * per_depth, at.y() * per_depth, per_depth};
}

// Prepares the pictures, and for each camera which depth is in front.
void InwardSweep::look(const geometry::TriangleMesh& mesh,
                       std::span<const PictureView> views,
                       Executor& executor) {
    cameras_.resize(views.size());
    const auto prepare = [&](std::size_t index, std::size_t) {
        Camera& camera = cameras_[index];
        fill(views[index], camera.luma_scratch, camera.luma);
        if (camera.luma.width == 0) return;
        const geometry::CalibratedCamera& calibrated = *views[index].camera;
        const Eigen::Matrix3d lens = linear_part(calibrated.intrinsics);
        camera.px_from_site = (lens * rotations_[index]).cast<float>();
        camera.offset = (lens * calibrated.camera_from_site.translation).cast<float>();
        camera.points.resize(mesh.vertices.size());
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
            image::set(camera.points, i, camera.place_of(mesh.vertices[i].cast<float>()));
        image::fit_inverse_depth(
            camera.points, kDepthPicturePx, camera.corners, camera.inverse_depth);
        image::draw_inverse_depth(camera.corners, mesh.triangles, camera.inverse_depth);
    };
    executor.parallel_for(views.size(), prepare);
}

// The unoccluded cameras that face the surfel most; returns their number.
std::size_t InwardSweep::seers_of(std::size_t index,
                                  std::span<const PictureView> views,
                                  Seers& seers) const {
    const Surfel& surfel = surfels_[index];
    std::array<std::pair<float, std::size_t>, kMostPaths> best{};  // cosine, view; in falling order
    std::size_t num = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const Camera& camera = cameras_[i];
        if (camera.luma.width == 0) continue;
        const Eigen::Vector3f to = centres_site_[i].cast<float>() - surfel.position_site;
        const float cosine = to.dot(surfel.normal) / to.norm();
        if (cosine < options_.least_cosine) continue;
        if (num == kMostPaths && cosine <= best[num - 1].first) continue;
        const Eigen::Vector3f seen = camera.place_of(surfel.position_site);
        if (!(seen.z() > 0.0F)) continue;
        const image::InverseDepthPicture& drawn = camera.inverse_depth;
        const Eigen::Vector2f place = drawn.place_of(seen.head<2>()).array() + 0.5F;
        // beside it where a triangle reaches behind the camera
        if (!(place.x() >= 0.0F && place.y() >= 0.0F &&
              place.x() < static_cast<float>(drawn.width) &&
              place.y() < static_cast<float>(drawn.height)))
            continue;
        const float nearest = drawn.at(static_cast<int>(place.x()), static_cast<int>(place.y()));
        if (1.0F / seen.z() > 1.0F / std::max(nearest, seen.z()) + kHiddenBehind_m) continue;
        num = std::min(num + 1, kMostPaths);
        std::size_t at = num - 1;
        for (; at > 0 && best[at - 1].first < cosine; --at) best[at] = best[at - 1];
        best[at] = {cosine, i};
    }
    for (std::size_t k = 0; k < num; ++k) seers[k] = best[k].second;
    return num;
}

// The paths in these cameras; returns their number.
std::size_t InwardSweep::paths_of(std::size_t index,
                                  std::span<const PictureView> views,
                                  std::array<PatchPath, kMostPaths>& paths) const {
    const Surfel& surfel = surfels_[index];
    Seers seers;
    const std::size_t num = seers_of(index, views, seers);
    if (num < 2) return 0;
    const Eigen::Vector3d position = surfel.position_site.cast<double>();
    const Eigen::Vector3d normal = surfel.normal.cast<double>();
    const Eigen::Vector3d column = double{options_.sample_spacing_m} * normal.unitOrthogonal();
    const Eigen::Vector3d row = normal.cross(column);
    for (std::size_t k = 0; k < num; ++k) {
        const geometry::CalibratedCamera& camera = *views[seers[k]].camera;
        const LumaPicture& luma = cameras_[seers[k]].luma;
        const Eigen::Matrix3d& rotation = rotations_[seers[k]];
        const Eigen::Vector3d first = rotation * position + camera.camera_from_site.translation;
        const Eigen::Vector3d last = first - double{options_.most_depth_m} * (rotation * normal);
        if (!(last.z() > kNearest_m)) return 0;
        const auto place = [&](const Eigen::Vector3d& at) {
            return luma.place(camera.intrinsics.distort(camera.intrinsics.project(at)));
        };
        PatchPath& path = paths[k];
        path.picture = &luma;
        path.first_px = place(first);
        path.last_px = place(last);
        path.first_depth_m = static_cast<float>(first.z());
        path.last_depth_m = static_cast<float>(last.z());
        path.column_px = place(first + rotation * column) - path.first_px;
        path.row_px = place(first + rotation * row) - path.first_px;
    }
    return num;
}

// How far the colours that the cameras show at a surfel differ; negative if less than two see it.
float InwardSweep::clash_of(std::size_t index, std::span<const PictureView> views) const {
    Seers seers;
    const std::size_t num = seers_of(index, views, seers);
    std::array<Eigen::Vector3f, kMostPaths> colours;
    std::size_t num_colours = 0;
    for (std::size_t k = 0; k < num; ++k) {
        const PictureView& view = views[seers[k]];
        const LumaPicture& luma = cameras_[seers[k]].luma;
        const Eigen::Vector3d at =
            rotations_[seers[k]] * surfels_[index].position_site.cast<double>() +
            view.camera->camera_from_site.translation;
        const geometry::PinholeCamera& lens = view.camera->intrinsics;
        const auto colour = colour_at(view, luma, luma.place(lens.distort(lens.project(at))));
        if (colour) colours[num_colours++] = *colour;
    }
    if (num_colours < 2) return -1.0F;
    return colour_clash(std::span(colours).first(num_colours));
}

void InwardSweep::find_phantoms(std::span<const PictureView> views, Executor& executor) {
    const std::span<const std::uint32_t> unneeded = phantom_parts_.find_unneeded(surfels_, views);
    clashes_.resize(unneeded.size());
    const auto look = [&](std::size_t chunk, std::size_t) {
        for (std::size_t k = chunk * kChunk; k < std::min(unneeded.size(), (chunk + 1) * kChunk);
             ++k)
            clashes_[k] = clash_of(unneeded[k], views);
    };
    executor.parallel_for(num_chunks(unneeded.size()), look);
    std::swap(phantoms_, earlier_phantoms_);
    phantoms_.assign(surfels_.size(), 0.0F);
    for (const std::uint32_t i : phantom_parts_.find_clashing(surfels_, clashes_))
        phantoms_[i] = 1.0F;
}

// Of the surfels with a depth of before, every second one is swept, in turns.
void InwardSweep::sweep(std::span<const PictureView> views, Executor& executor) {
    const std::size_t size = surfels_.size();
    const std::size_t share = earlier_depths_m_.empty() ? 1 : 2;
    ++turn_;
    scores_.assign(size * kNumSteps, kUnknownScore);
    const auto work = [&](std::size_t chunk, std::size_t) {
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            if (smooth_.earlier_weights[i] > 0.0F && (i + turn_) % 2 != 0) continue;
            std::array<PatchPath, kMostPaths> paths;
            const std::size_t num = paths_of(i, views, paths);
            if (num == 0) continue;
            // beyond the middle it would be the surface of the other side
            constexpr float kMostOfThickness = 0.6F;
            const float step_m = options_.most_depth_m / static_cast<float>(kNumSteps - 1);
            const auto most =
                static_cast<std::size_t>(kMostOfThickness * surfels_[i].thickness_m / step_m);
            // neighbours follow each other in the list, and score the other half of the steps
            score_depths(std::span(paths).first(num),
                         {.num = kNumSteps, .first = i / share % 2, .stride = 2},
                         {scores(i), std::min(kNumSteps, most + 1)});
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

// Means with the neighbours: one patch alone is often ambiguous, and each knows half of the steps.
void InwardSweep::share_scores(Executor& executor) {
    const std::size_t size = surfels_.size();
    shared_scores_.resize(scores_.size());
    const auto work = [&](std::size_t chunk, std::size_t) {
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            Scores sums{};
            Scores weights{};
            const auto add = [&](std::size_t surfel, float weight) {
                Scores of;
                std::memcpy(of.data(), scores(surfel), sizeof(of));
                for (std::size_t k = 0; k < of.size(); ++k) {
                    const FourScores counted =
                        of[k] > kUnknownScore ? FourScores{} + weight : FourScores{};
                    sums[k] += counted * of[k];
                    weights[k] += counted;
                }
            };
            add(i, 1.0F);
            for (const Surfels::Neighbour& other : surfels_.neighbours(i))
                add(other.surfel, other.weight);
            constexpr float kLeastWeight = 0.5F;
            for (std::size_t k = 0; k < sums.size(); ++k)
                sums[k] =
                    weights[k] > kLeastWeight ? sums[k] / weights[k] : FourScores{} + kUnknownScore;
            std::memcpy(shared_scores_.data() + i * kNumSteps, sums.data(), sizeof(sums));
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

void InwardSweep::accept() {
    const float step_m = options_.most_depth_m / static_cast<float>(kNumSteps - 1);
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        const float* of = shared_scores_.data() + i * kNumSteps;
        const auto best = static_cast<std::size_t>(std::max_element(of, of + kNumSteps) - of);
        if (of[best] > kUnknownScore) ++counts_.num_swept;
        if (!(of[best] >= options_.least_score) || best + 1 == kNumSteps) continue;
        float rival = kUnknownScore;
        for (std::size_t step = 0; step < kNumSteps; ++step) {
            const std::size_t apart = step > best ? step - best : best - step;
            if (apart >= options_.least_steps_apart) rival = std::max(rival, of[step]);
        }
        if (of[best] - rival < options_.least_lead) continue;
        float between = 0.0F;  // the top of a parabola through three scores
        if (best > 0 && of[best - 1] > kUnknownScore && of[best + 1] > kUnknownScore) {
            const float bend = of[best - 1] - 2.0F * of[best] + of[best + 1];
            if (bend < -1e-6F)
                between = std::clamp(0.5F * (of[best - 1] - of[best + 1]) / bend, -0.5F, 0.5F);
        }
        // a mean over a slope is lower than the scores that it has been made of
        const float score = std::max(of[best], scores(i)[best]);
        constexpr float kLeastWeight = 0.1F;
        smooth_.found_m[i] = (static_cast<float>(best) + between) * step_m;
        smooth_.weights[i] =
            (score - options_.least_score) / (1.0F - options_.least_score) + kLeastWeight;
        ++counts_.num_accepted;
    }
}

// The depths that the surface had here in the metaframe before. Phantom parts come and go within
// some metaframes instead of at once; what is new, or moves fast, is real until then.
void InwardSweep::recall(Executor& executor) {
    constexpr float kNear_m = 0.03F;
    constexpr float kLeastCosine = 0.3F;  // between normals
    constexpr float kLeastWeight = 0.1F;
    constexpr float kEarlierPhantom = 0.7F;
    if (earlier_depths_m_.empty()) return;
    const std::size_t size = surfels_.size();
    near_.resize(std::max(near_.size(), executor.num_workers()));
    const auto work = [&](std::size_t chunk, std::size_t worker) {
        NearScratch& near = near_[worker];
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            earlier_surfels_.near(surfels_[i].position_site, kNear_m, near);
            float sum = 0.0F;
            float phantom = 0.0F;
            float weight = 0.0F;
            for (const NearSurfel& there : near.found) {
                const float cosine = earlier_surfels_[there.surfel].normal.dot(surfels_[i].normal);
                if (cosine < kLeastCosine) continue;
                const float own = cosine * falling_weight(there.distance_sq / (kNear_m * kNear_m));
                sum += own * earlier_depths_m_[there.surfel];
                phantom += own * earlier_phantoms_[there.surfel];
                weight += own;
            }
            const float earlier = weight < kLeastWeight ? 0.0F : phantom / weight;
            phantoms_[i] += kEarlierPhantom * (earlier - phantoms_[i]);
            if (weight < kLeastWeight) continue;
            smooth_.earlier_m[i] = sum / weight;
            smooth_.earlier_weights[i] = std::min(1.0F, weight);
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

void InwardSweep::forget() {
    earlier_depths_m_.clear();
    turn_ = 0;
}

// Of the surfels behind each part of an outline, holds the one that most likely touches it: it lies
// least deep, and the cameras agree there already.
void InwardSweep::hold() {
    constexpr float kDisagreement_m = 0.01F;  // a score of 0 costs as much as this depth
    constexpr float kPhantom_m = 1.0F;        // holds only if there is nothing else
    std::ranges::fill(smooth_.is_held, std::uint8_t{0});
    counts_.num_held = 0;
    for (auto first = on_outlines_.begin(); first != on_outlines_.end();) {
        std::uint32_t best = first->index;
        float least = std::numeric_limits<float>::infinity();
        const std::uint64_t bin = first->bin;
        for (; first != on_outlines_.end() && first->bin == bin; ++first) {
            const float score = std::max(shared_scores_[first->index * kNumSteps], 0.0F);
            const float cost = smooth_.depths_m[first->index] + kDisagreement_m * (1.0F - score) +
                               kPhantom_m * phantoms_[first->index];
            if (!(cost < least)) continue;
            least = cost;
            best = first->index;
        }
        smooth_.is_held[best] = 1;
        ++counts_.num_held;
    }
}

void InwardSweep::find(const geometry::TriangleMesh& mesh,
                       std::span<const PictureView> views,
                       Executor& executor) {
    constexpr int kNumRounds = 8;
    constexpr float kFirstOutlier_m = 0.08F;
    constexpr int kNumHolds = 3;
    constexpr int kNumRoundsHeld = 3;  // from the solution before
    counts_ = {};
    centres_site_.clear();
    rotations_.clear();
    for (const PictureView& view : views) {
        centres_site_.push_back(view.camera->centre_site());
        rotations_.push_back(view.camera->camera_from_site.rotation.toRotationMatrix());
    }
    std::swap(surfels_, earlier_surfels_);
    surfels_.sample(mesh, centres_site_, options_.surfels, executor);
    counts_.num_surfels = surfels_.size();
    look(mesh, views, executor);
    smooth_.assign(surfels_);
    find_phantoms(views, executor);
    recall(executor);
    sweep(views, executor);
    share_scores(executor);
    accept();
    for (std::size_t i = 0; i < surfels_.size(); ++i)
        smooth_.depths_m[i] = smooth_.weights[i] > 0.0F ? smooth_.found_m[i] : smooth_.earlier_m[i];
    smooth_.solve(options_.smooth, kNumRounds, kFirstOutlier_m);
    bins_px_.assign(views.size(), options_.outline_bin_px);
    find_on_outlines(surfels_, views, bins_px_, on_outlines_);
    for (int i = 0; i < kNumHolds; ++i) {
        hold();
        smooth_.solve(options_.smooth, kNumRoundsHeld, 2.0F * options_.smooth.outlier_m);
    }
    earlier_depths_m_ = smooth_.depths_m;
    for (const float depth : smooth_.depths_m)
        counts_.mean_depth_m += double{depth} / static_cast<double>(surfels_.size());
}

InwardSweep::Move InwardSweep::move_at(const Eigen::Vector3f& point_site,
                                       const Eigen::Vector3f& normal,
                                       NearScratch& scratch) const {
    const float radius = 1.4F * options_.surfels.spacing_m;
    const float radius_sq = radius * radius;
    Move sum;
    float weight = 0.0F;
    surfels_.near(point_site, radius, scratch);
    for (const NearSurfel& there : scratch.found) {
        const Surfel& surfel = surfels_[there.surfel];
        const float cosine = surfel.normal.dot(normal);
        if (cosine <= 0.0F) continue;
        const float near = falling_weight(there.distance_sq / radius_sq);
        const float own = (0.2F + cosine) * near * near;
        sum.by_m -= own * smooth_.depths_m[there.surfel] * surfel.normal;
        sum.phantom += own * phantoms_[there.surfel];
        weight += own;
    }
    if (!(weight > 0.0F)) return {};
    return {sum.by_m / weight, sum.phantom / weight};
}

}  // namespace atrium::refine
