#include "site_node/hull_stage.hpp"

#include "core/base/fnv1a.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/limits.hpp"
#include "core/config/rig.hpp"
#include "core/config/spelling.hpp"
#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/input_limits.hpp"
#include "site_node/silhouette/picture_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace atrium::site_node {
namespace {

constexpr std::uint32_t kFewestViews = 2;  // the cone of one camera is unbounded
static_assert(config::kMinFocal_px == hull::kMinFocal_px &&
              config::kMaxFocal_px == hull::kMaxFocal_px);  // what rigs allow, the hull computes

// `value`: current value of an option that the command line may have changed.
tl::unexpected<Error> wrong(const HullStageOptions& options,
                            const std::string& key,
                            const std::string& text,
                            const std::string& value = "") {
    const auto place = options.places.find(value.empty() ? key : key + " = " + value);
    return make_error(
        ErrorKind::kConfiguration,
        (place == options.places.end() ? "" : place->second + ": ") + key + ": " + text);
}

Expected<std::uint32_t> find_camera(std::span<const geometry::CalibratedCamera> cameras,
                                    const std::string& name,
                                    const HullStageOptions& options,
                                    const std::string& key) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (cameras[i].name == name) return static_cast<std::uint32_t>(i);
        names.push_back(cameras[i].name);
    }
    const std::string meant = config::ask_which(config::names_meant_by(name, names));
    return wrong(options,
                 key,
                 fmt::format("no camera is named '{}'; this rig has {}{}",
                             name,
                             fmt::join(names, ", "),
                             meant.empty() ? "" : " (" + meant + ")"));
}

Expected<void> check_count(std::size_t num_cameras, const HullStageOptions& options) {
    const std::size_t most = hull::kMaxViews - (options.bounds ? hull::kViewsOfBounds : 0);
    if (num_cameras > most) {
        return wrong(
            options,
            "hull.bounds",
            fmt::format("at most {} cameras are possible with bounds, got {}", most, num_cameras));
    }
    if (options.min_views > num_cameras) {
        return wrong(options,
                     "hull.min_views",
                     fmt::format("must not exceed the number of cameras, {}, got {}",
                                 num_cameras,
                                 options.min_views),
                     std::to_string(options.min_views));
    }
    return {};
}

bool overlap(const geometry::Aabb& a, const geometry::Aabb& b) {
    return (a.min.array() < b.max.array()).all() && (b.min.array() < a.max.array()).all();
}

}  // namespace

Expected<void> check(const HullStageOptions& options) {
    if (options.regions.size() > bus::kMaxRegions)
        return wrong(options,
                     fmt::format("hull.region[{}].bounds", bus::kMaxRegions),
                     fmt::format("at most {} regions are possible", bus::kMaxRegions));
    if (options.bounds && !options.regions.empty()) {
        return wrong(options,
                     "hull.bounds",
                     "cannot be combined with [[hull.region]], which has its own bounds; remove "
                     "one of them");
    }
    if (!options.partial_views && !options.whole_cameras.empty()) {
        return wrong(options, "hull.whole_cameras", "is used only with hull.partial_views = true");
    }
    return {};
}

std::uint64_t fingerprint(const HullStageOptions& options) {
    Fnv1a hash;
    const auto add_box = [&](const geometry::Aabb& box) {
        for (const double value : box.min) hash.add_rounded(value);
        for (const double value : box.max) hash.add_rounded(value);
    };
    if (options.bounds) add_box(*options.bounds);
    hash.add(std::uint64_t{options.min_views});
    hash.add(std::uint64_t{options.keep_phantoms ? 1U : 0U});
    hash.add_rounded(options.min_component_l);
    hash.add(options.refine);
    hash.add(std::uint64_t{options.partial_views ? 1U : 0U});
    for (const std::string& name : options.whole_cameras) hash.add(name);
    for (const RegionOptions& region : options.regions) {
        hash.add(region.name);
        add_box(region.bounds);
        for (const std::string& name : region.cameras) hash.add(name);
        hash.add(std::uint64_t{0x101});
    }
    return hash.value();
}

bool needs_pictures(const HullStageOptions& options) {
    return options.refine == "photo" || options.refine == "round_photo";
}

std::vector<std::string> overlapping_regions(std::span<const RegionOptions> regions) {
    std::vector<std::string> pairs;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        for (std::size_t k = i + 1; k < regions.size(); ++k) {
            if (overlap(regions[i].bounds, regions[k].bounds))
                pairs.push_back(fmt::format("{} and {}", regions[i].name, regions[k].name));
        }
    }
    return pairs;
}

Expected<HullStage> HullStage::create(std::span<const geometry::CalibratedCamera> cameras,
                                      const HullStageOptions& options,
                                      double tolerance_px) {
    if (auto checked = check(options); !checked) return tl::unexpected(checked.error());
    if (options.partial_views && !options.bounds && options.regions.empty()) {
        return wrong(options,
                     "hull.partial_views",
                     "needs hull.bounds, because no camera limits the space outside the pictures: "
                     "write [hull] bounds = { min = [x, y, z], max = [x, y, z] } into the site "
                     "file, [bounds] into the rig, or --hull.bounds X0,Y0,Z0,X1,Y1,Z1",
                     "true");
    }
    if (auto counted = check_count(cameras.size(), options); !counted)
        return tl::unexpected(counted.error());
    HullStage stage;
    stage.options_.bounds = options.bounds;
    stage.are_bounds_optional_ = options.bounds && !options.partial_views;
    stage.options_.min_views = options.min_views;
    stage.options_.keep_phantoms = options.keep_phantoms;
    stage.rounds_corners_ = options.refine == "round" || options.refine == "round_photo";
    stage.moves_to_pictures_ = needs_pictures(options);
    stage.options_.min_component_volume_m3 = options.min_component_l / kLitresPerM3;
    stage.min_delivered_ = std::max(kFewestViews, options.min_views);
    stage.views_.resize(cameras.size());
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        stage.views_[i].intrinsics = cameras[i].intrinsics;
        stage.views_[i].camera_from_site = cameras[i].camera_from_site;
    }
    if (auto added = stage.add_regions(cameras, options); !added)
        return tl::unexpected(added.error());
    if (auto added = stage.add_fields(cameras, options, tolerance_px); !added)
        return tl::unexpected(added.error());
    stage.photo_.resize(std::max<std::size_t>(1, stage.regions_.size()));
    return stage;
}

Expected<void> HullStage::add_regions(std::span<const geometry::CalibratedCamera> cameras,
                                      const HullStageOptions& options) {
    for (const RegionOptions& region : options.regions) {
        const std::string key = fmt::format("hull.region[{}].cameras", regions_.size());
        std::vector<std::uint32_t> indices;
        for (const std::string& name : region.cameras) {
            const auto index = find_camera(cameras, name, options, key);
            if (!index) return tl::unexpected(index.error());
            if (std::find(indices.begin(), indices.end(), *index) != indices.end())
                return wrong(options, key, fmt::format("'{}' is named twice", name));
            indices.push_back(*index);
        }
        if (region.cameras.empty()) {
            for (std::uint32_t i = 0; i < cameras.size(); ++i) indices.push_back(i);
        }
        constexpr std::size_t kMost = hull::kMaxViews - hull::kViewsOfBounds;
        if (indices.size() > kMost) {
            return wrong(
                options,
                key,
                fmt::format("a region has at most {} cameras, got {}", kMost, indices.size()));
        }
        if (indices.size() < min_delivered_) {
            return wrong(
                options,
                key,
                fmt::format("needs at least {} cameras, got {}", min_delivered_, indices.size()));
        }
        regions_.push_back(
            {region.name, region.bounds, std::move(indices), min_delivered_, region.is_elsewhere});
    }
    return {};
}

Expected<void> HullStage::add_fields(std::span<const geometry::CalibratedCamera> cameras,
                                     const HullStageOptions& options,
                                     double tolerance_px) {
    std::vector<std::uint8_t> whole(cameras.size(), options.partial_views ? 0 : 1);
    for (const std::string& name : options.whole_cameras) {
        const auto index = find_camera(cameras, name, options, "hull.whole_cameras");
        if (!index) return tl::unexpected(index.error());
        if (whole[*index] != 0)
            return wrong(options, "hull.whole_cameras", fmt::format("'{}' is named twice", name));
        whole[*index] = 1;
    }
    const double inset_px = silhouette::field_inset_px(tolerance_px);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        if (whole[i] != 0) continue;
        auto field = silhouette::picture_field(cameras[i].intrinsics, inset_px);
        if (!field || !hull::is_usable_field(*field)) {
            return wrong(
                options,
                "hull.partial_views",
                fmt::format(
                    "the lens distortion of camera '{}' cannot be inverted along the "
                    "border of its picture; add it to hull.whole_cameras if it sees everybody",
                    cameras[i].name),
                "true");
        }
        views_[i].field = std::move(*field);
    }
    return {};
}

// Bounds cost as much as two more cameras. Where they cut nothing, the hull is the same without
// them, so they are used only while they cut.
void HullStage::compute_within_bounds(Executor& executor, hull::VisualHull& hull) {
    constexpr int kBoundedMetaframes = 30;
    if (are_bounds_optional_ && num_bounded_left_-- <= 0) {
        hull::HullOptions without = options_;
        without.bounds.reset();
        hull::compute_visual_hull(pointers_, without, hull_scratch_, executor, hull);
        const geometry::Aabb box = geometry::bounds(hull.mesh);
        const bool is_same =
            hull.status == hull::HullStatus::kEmptyIntersection ||
            (hull.status == hull::HullStatus::kOk && options_.bounds->contains(box.min) &&
             options_.bounds->contains(box.max));
        if (is_same) {
            num_bounded_left_ = 0;
            return;
        }
        num_bounded_left_ = kBoundedMetaframes;
    }
    hull::compute_visual_hull(pointers_, options_, hull_scratch_, executor, hull);
}

void HullStage::refine(geometry::TriangleMesh& mesh,
                       refine::PhotoRefinement& photo,
                       Executor& executor) {
    if (rounds_corners_) rounding_.round(mesh, refined_views_);
    if (moves_to_pictures_ && !is_paused_) photo.refine(mesh, refined_pictures_, executor);
}

// What comes after an instant without a hull is somebody else, or somewhere else.
void HullStage::forget_surfaces() {
    std::ranges::for_each(photo_, &refine::PhotoRefinement::forget);
}

// Each mesh with the views of its hull. Those of `pointers_` are views of `views_`.
void HullStage::refine(hull::VisualHull& hull,
                       std::span<const refine::PictureView> pictures,
                       Executor& executor) {
    const auto add = [&](const hull::SilhouetteView* view) {
        if (view == nullptr) return;
        refined_views_.push_back(view);
        if (!pictures.empty())
            refined_pictures_.push_back(pictures[static_cast<std::size_t>(view - views_.data())]);
    };
    const auto forget = [&] {
        refined_views_.clear();
        refined_pictures_.clear();
    };
    if (regions_.empty()) {
        forget();
        std::ranges::for_each(pointers_, add);
        refine(hull.mesh, photo_.front(), executor);
        return;
    }
    hull.mesh.clear();
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        forget();
        for (const std::uint32_t view : regions_[i].views) add(pointers_[view]);
        if (regions_[i].views.empty()) std::ranges::for_each(pointers_, add);
        geometry::TriangleMesh& part = region_scratch_.parts[i].mesh;
        refine(part, photo_[i], executor);
        geometry::append(hull.mesh, part);
    }
}

void HullStage::compute(std::span<const std::uint8_t> delivered,
                        std::span<const refine::PictureView> pictures,
                        Executor& executor,
                        hull::VisualHull& hull) {
    refinement_ms_ = 0.0;
    const auto num_delivered = static_cast<std::size_t>(
        std::count_if(delivered.begin(), delivered.end(), [](std::uint8_t d) { return d != 0; }));
    if (regions_.empty() && num_delivered < min_delivered_) {
        clear(hull);
        hull.status = hull::HullStatus::kTooFewViews;
        forget_surfaces();
        return;
    }
    pointers_.clear();
    for (std::size_t i = 0; i < views_.size(); ++i) {
        if (delivered[i] != 0) {
            pointers_.push_back(&views_[i]);
        } else if (!regions_.empty()) {
            pointers_.push_back(nullptr);  // regions refer to cameras by index
        }
    }
    if (regions_.empty()) {
        compute_within_bounds(executor, hull);
    } else {
        hull::compute_region_hulls(pointers_, regions_, options_, region_scratch_, executor, hull);
    }
    if (hull.status != hull::HullStatus::kOk || is_paused_) forget_surfaces();
    if (hull.status == hull::HullStatus::kOk && (rounds_corners_ || moves_to_pictures_)) {
        const auto begin = std::chrono::steady_clock::now();
        refine(hull, pictures, executor);
        refinement_ms_ = milliseconds(std::chrono::steady_clock::now() - begin);
    }
}

}  // namespace atrium::site_node
