#include "site_node/refine/inward_sweep.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::refine {
namespace {

constexpr int kDepthPicturePx = 192;      // long side
constexpr float kHiddenBehind_m = 0.03F;  // behind a nearer surface

}  // namespace

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
        const Eigen::Matrix3d& rotation = rotations_[index];
        const std::size_t num_vertices = mesh.vertices.size();
        camera.points.resize(num_vertices + surfels_.size());
        for (std::size_t i = 0; i < camera.points.size(); ++i) {
            const Eigen::Vector3d site =
                i < num_vertices ? mesh.vertices[i]
                                 : surfels_[i - num_vertices].position_site.cast<double>();
            const Eigen::Vector3d at = rotation * site + calibrated.camera_from_site.translation;
            Eigen::Vector3f point = Eigen::Vector3f::Zero();  // inverse depth 0: behind the camera
            if (at.z() > kNearest_m) {
                point.head<2>() = calibrated.intrinsics.project(at).cast<float>();
                point.z() = static_cast<float>(1.0 / at.z());
            }
            image::set(camera.points, i, point);
        }
        image::fit_inverse_depth(
            camera.points, kDepthPicturePx, camera.corners, camera.inverse_depth);
        image::draw_inverse_depth(camera.corners, mesh.triangles, camera.inverse_depth);
    };
    executor.parallel_for(views.size(), prepare);
}

// The paths in the unoccluded cameras that face the surfel most; returns their number.
std::size_t InwardSweep::paths_of(std::size_t index,
                                  std::span<const PictureView> views,
                                  std::array<PatchPath, kMostPaths>& paths) const {
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
        const Eigen::Vector4f& place =
            camera.corners[camera.corners.size() - surfels_.size() + index];
        if (!(place.z() > 0.0F)) continue;
        const float nearest = camera.inverse_depth.at(static_cast<int>(place.x() + 0.5F),
                                                      static_cast<int>(place.y() + 0.5F));
        if (1.0F / place.z() > 1.0F / std::max(nearest, place.z()) + kHiddenBehind_m) continue;
        num = std::min(num + 1, kMostPaths);
        std::size_t at = num - 1;
        for (; at > 0 && best[at - 1].first < cosine; --at) best[at] = best[at - 1];
        best[at] = {cosine, i};
    }
    if (num < 2) return 0;
    const Eigen::Vector3d position = surfel.position_site.cast<double>();
    const Eigen::Vector3d normal = surfel.normal.cast<double>();
    const Eigen::Vector3d column = double{options_.sample_spacing_m} * normal.unitOrthogonal();
    const Eigen::Vector3d row = normal.cross(column);
    for (std::size_t k = 0; k < num; ++k) {
        const geometry::CalibratedCamera& camera = *views[best[k].second].camera;
        const LumaPicture& luma = cameras_[best[k].second].luma;
        const Eigen::Matrix3d& rotation = rotations_[best[k].second];
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

void InwardSweep::sweep(std::span<const PictureView> views, Executor& executor) {
    const std::size_t size = surfels_.size();
    scores_.assign(size * options_.num_steps, kUnknownScore);
    const auto work = [&](std::size_t chunk, std::size_t) {
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            std::array<PatchPath, kMostPaths> paths;
            const std::size_t num = paths_of(i, views, paths);
            if (num == 0) continue;
            // beyond the middle it would be the surface of the other side
            constexpr float kMostOfThickness = 0.6F;
            const float step_m = options_.most_depth_m / static_cast<float>(options_.num_steps - 1);
            const auto most =
                static_cast<std::size_t>(kMostOfThickness * surfels_[i].thickness_m / step_m);
            score_depths(std::span(paths).first(num),
                         options_.num_steps,
                         {scores(i), std::min(options_.num_steps, most + 1)});
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

// Means with the neighbours: one patch alone is often ambiguous.
void InwardSweep::share_scores(Executor& executor) {
    const std::size_t size = surfels_.size();
    const std::size_t num_steps = options_.num_steps;
    shared_scores_.assign(scores_.size(), kUnknownScore);
    const auto work = [&](std::size_t chunk, std::size_t) {
        std::vector<float> sums(num_steps);
        std::vector<float> weights(num_steps);
        for (std::size_t i = chunk * kChunk; i < std::min(size, (chunk + 1) * kChunk); ++i) {
            std::ranges::fill(sums, 0.0F);
            std::ranges::fill(weights, 0.0F);
            const auto add = [&](std::size_t surfel, float weight) {
                const float* of = scores(surfel);
                for (std::size_t step = 0; step < num_steps; ++step) {
                    const float counted = of[step] > kUnknownScore ? weight : 0.0F;
                    sums[step] += counted * of[step];
                    weights[step] += counted;
                }
            };
            add(i, 1.0F);
            for (const Surfels::Neighbour& other : surfels_.neighbours(i))
                add(other.surfel, other.weight);
            constexpr float kLeastWeight = 0.5F;
            for (std::size_t step = 0; step < num_steps; ++step) {
                if (weights[step] > kLeastWeight)
                    shared_scores_[i * num_steps + step] = sums[step] / weights[step];
            }
        }
    };
    executor.parallel_for(num_chunks(size), work);
}

void InwardSweep::accept() {
    const std::size_t num_steps = options_.num_steps;
    const float step_m = options_.most_depth_m / static_cast<float>(num_steps - 1);
    found_m_.assign(surfels_.size(), 0.0F);
    weights_.assign(surfels_.size(), 0.0F);
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        const float* of = shared_scores_.data() + i * num_steps;
        const auto best = static_cast<std::size_t>(std::max_element(of, of + num_steps) - of);
        if (of[best] > kUnknownScore) ++counts_.num_swept;
        if (!(of[best] >= options_.least_score) || best + 1 == num_steps) continue;
        float rival = kUnknownScore;
        for (std::size_t step = 0; step < num_steps; ++step) {
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
        found_m_[i] = (static_cast<float>(best) + between) * step_m;
        weights_[i] = (score - options_.least_score) / (1.0F - options_.least_score) + kLeastWeight;
        ++counts_.num_accepted;
    }
}

// Minimises the weighted squares of differences to the accepted depths, to the hull and between
// neighbours (Gauss-Seidel). Weights of accepted depths fall with the difference that is left: at
// first only those that are far off, so that the many decide what is an outlier.
void InwardSweep::solve(int num_rounds, float first_outlier_m) {
    constexpr float kNarrowing = 0.8F;         // per round
    constexpr float kMostOfThickness = 0.45F;  // both sides may move
    float outlier_m = first_outlier_m;
    for (int round = 0; round < num_rounds; ++round) {
        outlier_m = std::max(options_.outlier_m, kNarrowing * outlier_m);
        for (std::size_t i = 0; i < surfels_.size(); ++i) {
            float sum = 0.0F;
            float weight = options_.hull_weight;
            if (is_held_[i] != 0) {
                weight += options_.held_weight;
            } else if (weights_[i] > 0.0F) {
                const float off = (depths_[i] - found_m_[i]) / outlier_m;
                const float doubt = 1.0F + off * off;
                const float own = weights_[i] / (doubt * doubt);
                sum += own * found_m_[i];
                weight += own;
            }
            float neighbours = 0.0F;
            float neighbour_weight = 0.0F;
            for (const Surfels::Neighbour& other : surfels_.neighbours(i)) {
                neighbours += other.weight * depths_[other.surfel];
                neighbour_weight += other.weight;
            }
            if (neighbour_weight > 0.0F) {
                sum += options_.smoothness * neighbours / neighbour_weight;
                weight += options_.smoothness;
            }
            depths_[i] = std::clamp(sum / weight, 0.0F, kMostOfThickness * surfels_[i].thickness_m);
        }
    }
}

// Of the surfels behind each small part of an outline, holds the one that most likely touches it:
// it lies least deep, and the cameras agree there already.
void InwardSweep::hold(std::span<const PictureView> views) {
    constexpr float kDisagreement_m = 0.01F;  // a score of 0 costs as much as this depth
    candidates_.clear();
    for (std::size_t i = 0; i < surfels_.size(); ++i) {
        is_held_[i] = 0;
        const std::int32_t owner = surfels_[i].owner;
        if (owner == hull::kNoOwner) continue;
        const auto view = static_cast<std::size_t>(owner);
        const auto bin = outline_bin(*views[view].camera,
                                     view,
                                     surfels_[i].position_site.cast<double>(),
                                     options_.outline_bin_px);
        if (!bin) continue;
        const float score = std::max(shared_scores_[i * options_.num_steps], 0.0F);
        candidates_.push_back(
            {*bin, depths_[i] + kDisagreement_m * (1.0F - score), static_cast<std::uint32_t>(i)});
    }
    keep_least(candidates_);
    counts_.num_held = candidates_.size();
    for (const OutlinePoint& point : candidates_) is_held_[point.index] = 1;
}

void InwardSweep::find(const geometry::TriangleMesh& mesh,
                       std::span<const PictureView> views,
                       Executor& executor) {
    constexpr int kNumRounds = 14;
    constexpr float kFirstOutlier_m = 0.08F;
    constexpr int kNumHolds = 3;
    constexpr int kNumRoundsHeld = 6;  // from the solution before
    counts_ = {};
    centres_site_.clear();
    rotations_.clear();
    for (const PictureView& view : views) {
        centres_site_.push_back(view.camera->centre_site());
        rotations_.push_back(view.camera->camera_from_site.rotation.toRotationMatrix());
    }
    surfels_.sample(mesh, centres_site_, options_.surfels, executor);
    counts_.num_surfels = surfels_.size();
    look(mesh, views, executor);
    sweep(views, executor);
    share_scores(executor);
    accept();
    depths_ = found_m_;
    is_held_.assign(surfels_.size(), 0);
    solve(kNumRounds, kFirstOutlier_m);
    for (int i = 0; i < kNumHolds; ++i) {
        hold(views);
        solve(kNumRoundsHeld, 2.0F * options_.outlier_m);
    }
    for (const float depth : depths_)
        counts_.mean_depth_m += double{depth} / static_cast<double>(surfels_.size());
}

Eigen::Vector3f InwardSweep::move_at(const Eigen::Vector3f& point_site,
                                     const Eigen::Vector3f& normal) const {
    const float radius = 1.4F * options_.surfels.spacing_m;
    const float radius_sq = radius * radius;
    Eigen::Vector3f move = Eigen::Vector3f::Zero();
    float weight = 0.0F;
    surfels_.grid().near(point_site, radius, [&](std::uint32_t i) {
        const Surfel& surfel = surfels_[i];
        const float cosine = surfel.normal.dot(normal);
        const float distance_sq = (surfel.position_site - point_site).squaredNorm();
        if (cosine <= 0.0F || distance_sq > radius_sq) return;
        const float near = falling_weight(distance_sq / radius_sq);
        const float own = (0.2F + cosine) * near * near;
        move -= own * depths_[i] * surfel.normal;
        weight += own;
    });
    return weight > 0.0F ? Eigen::Vector3f(move / weight)
                         : Eigen::Vector3f(Eigen::Vector3f::Zero());
}

}  // namespace atrium::refine
