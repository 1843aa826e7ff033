#include "site_node/refine/phantom_parts.hpp"

#include <algorithm>

namespace atrium::refine {

// The normals at the edge of a thin part point along it, where it is not thin.
void PhantomParts::find_thickness(const Surfels& surfels) {
    thickness_m_.clear();
    for (std::size_t i = 0; i < surfels.size(); ++i) thickness_m_.push_back(surfels[i].thickness_m);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        if (surfels[i].thickness_m >= options_.thin_m.front()) continue;
        surfels.near(surfels[i].position_site, options_.edge_m, near_);
        for (const NearSurfel& there : near_.found) {
            float& thickness_m = thickness_m_[there.surfel];
            thickness_m = std::min(thickness_m, surfels[i].thickness_m);
        }
    }
}

// Pieces are as large in all views.
void PhantomParts::find_pieces(const Surfels& surfels, std::span<const PictureView> views) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < surfels.size(); ++i)
        middle += surfels[i].position_site.cast<double>() / static_cast<double>(surfels.size());
    pieces_px_.clear();
    for (const PictureView& view : views) {
        const double distance_m = (view.camera->centre_site() - middle).norm();
        const double px_per_m = view.camera->intrinsics.fx / std::max(distance_m, kNearest_m);
        pieces_px_.push_back(double{options_.outline_piece_m} * px_per_m);
    }
    find_on_outlines(surfels, views, pieces_px_, on_outlines_);
}

// Without a thicker surfel behind the same piece of an outline, the thin ones there are needed.
void PhantomParts::mark_needed(float thin_m) {
    std::ranges::fill(is_needed_, std::uint8_t{0});
    for (auto first = on_outlines_.begin(); first != on_outlines_.end();) {
        const auto end = std::find_if(first, on_outlines_.end(), [&](const OutlinePoint& point) {
            return point.bin != first->bin;
        });
        const bool is_explained = std::any_of(first, end, [&](const OutlinePoint& point) {
            return thickness_m_[point.index] >= thin_m;
        });
        for (; first != end; ++first) is_needed_[first->index] = is_explained ? 0 : 1;
    }
}

std::span<const std::uint32_t> PhantomParts::find_unneeded(const Surfels& surfels,
                                                           std::span<const PictureView> views) {
    find_thickness(surfels);
    find_pieces(surfels, views);
    is_needed_.resize(surfels.size());
    unneeded_.clear();
    for (const float thin_m : options_.thin_m) {
        mark_needed(thin_m);
        for (std::size_t i = 0; i < surfels.size(); ++i) {
            if (thickness_m_[i] >= thin_m || is_needed_[i] != 0) continue;
            surfels.near(surfels[i].position_site, options_.beside_m, near_);
            if (std::ranges::none_of(near_.found, [&](const NearSurfel& there) {
                    return is_needed_[there.surfel] != 0;
                }))
                unneeded_.push_back(static_cast<std::uint32_t>(i));
        }
    }
    std::ranges::sort(unneeded_);
    unneeded_.erase(std::ranges::unique(unneeded_).begin(), unneeded_.end());
    return unneeded_;
}

std::span<const std::uint32_t> PhantomParts::find_clashing(const Surfels& surfels,
                                                           std::span<const float> clashes) {
    clashes_.assign(surfels.size(), -1.0F);
    for (std::size_t k = 0; k < unneeded_.size(); ++k) clashes_[unneeded_[k]] = clashes[k];
    clashing_.clear();
    for (const std::uint32_t i : unneeded_) {
        surfels.near(surfels[i].position_site, options_.beside_m, near_);
        float above = 0.0F;
        bool is_seen = false;
        for (const NearSurfel& there : near_.found) {
            if (clashes_[there.surfel] < 0.0F) continue;
            is_seen = true;
            above += clashes_[there.surfel] - options_.least_clash;
        }
        if (is_seen && above > 0.0F) clashing_.push_back(i);
    }
    return clashing_;
}

}  // namespace atrium::refine
