#include "site_node/camouflage_stage.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <utility>

namespace atrium::site_node {
namespace {

// Where people can be, if anybody knows.
std::optional<geometry::Aabb> bounds_of(const HullStageOptions& options) {
    if (options.regions.empty()) return options.bounds;
    geometry::Aabb all;
    for (const RegionOptions& region : options.regions) {
        all.add(region.bounds.min);
        all.add(region.bounds.max);
    }
    return all;
}

}  // namespace

std::optional<CamouflageStage> CamouflageStage::create(
    std::span<const geometry::CalibratedCamera> cameras, const HullStageOptions& options) {
    const camouflage::CamouflagedPartsOptions parts;
    const auto bounds = bounds_of(options);
    if (!options.find_camouflaged || !bounds || cameras.size() <= parts.search.fewest_others ||
        !camouflage::DissentSearch::can_search(*bounds, parts.search))
        return std::nullopt;
    return CamouflageStage(camouflage::CamouflagedParts(cameras, *bounds, parts));
}

void CamouflageStage::add(const capture::Metaframe& metaframe,
                          std::span<const Camera> cameras,
                          Executor& executor) {
    const auto begin = std::chrono::steady_clock::now();
    num_pixels_ = 0;
    milliseconds_ = 0.0;
    // all masks are a recording's, a worker's or those of camera nodes
    if (std::ranges::none_of(cameras, [](const Camera& c) { return c.stage != nullptr; })) return;
    views_.assign(cameras.size(), {});
    pixels_.assign(cameras.size(), 0);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const auto& [stage, silhouette] = cameras[i];
        if (stage == nullptr) continue;
        views_[i] = {silhouette->picture,
                     &silhouette->mask.mask,
                     silhouette->subject,
                     &stage->segmenter().model(),
                     stage->segmenter().inverse_gain()};
    }
    parts_.find(views_, executor);
    // Only now may masks change: the cameras decide together. Mostly none does.
    changed_.clear();
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (!parts_.found(i).empty()) changed_.push_back(i);
    const auto work = [&](std::size_t task, std::size_t worker) {
        const std::size_t i = changed_[task];
        pixels_[i] = cameras[i].stage->add(
            metaframe.frames[i], parts_.found(i), {&executor, worker}, *cameras[i].silhouette);
    };
    if (!changed_.empty()) executor.parallel_for(changed_.size(), work);
    num_pixels_ = std::accumulate(pixels_.begin(), pixels_.end(), std::uint64_t{0});
    milliseconds_ = atrium::milliseconds(std::chrono::steady_clock::now() - begin);
}

}  // namespace atrium::site_node
