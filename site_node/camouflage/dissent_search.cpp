#include "site_node/camouflage/dissent_search.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>
#include <utility>

namespace atrium::camouflage {
namespace {

constexpr int kVoxels = 4;          // along an edge of a cell
constexpr int kTile = 16;           // [px]
constexpr std::size_t kChunk = 64;  // cells
constexpr std::size_t kMostCameras = 64;

Eigen::Array3d num_cells(const geometry::Aabb& bounds_site, float cell_m) {
    return (bounds_site.size() / double{cell_m}).array().ceil();
}

}  // namespace

bool DissentSearch::can_search(const geometry::Aabb& bounds_site,
                               const DissentSearchOptions& options) {
    constexpr double kMostCells = 50'000.0;
    return !bounds_site.empty() &&
           num_cells(bounds_site, options.voxel_m * kVoxels).prod() <= kMostCells;
}

DissentSearch::DissentSearch(const geometry::Aabb& bounds_site, const DissentSearchOptions& options)
    : options_(options) {
    assert(can_search(bounds_site, options));
    const float cell_m = options.voxel_m * kVoxels;
    const Eigen::Vector3f low = bounds_site.min.cast<float>();
    const Eigen::Array3i num = num_cells(bounds_site, cell_m).cast<int>();
    for (int z = 0; z < num.z(); ++z)
        for (int y = 0; y < num.y(); ++y)
            for (int x = 0; x < num.x(); ++x)
                cells_.push_back(low + cell_m * Eigen::Array3i(x, y, z).cast<float>().matrix());
    found_in_.resize((cells_.size() + kChunk - 1) / kChunk);
}

void DissentSearch::note_people(const CameraView& view, Tiles& tiles) {
    const image::Mask& mask = *view.mask;
    tiles.columns = (mask.width + kTile - 1) / kTile;
    tiles.has_person.assign(static_cast<std::size_t>(tiles.columns) *
                                static_cast<std::size_t>((mask.height + kTile - 1) / kTile),
                            0);
    const image::PixelRect& subject = view.subject;
    const int right = std::min(subject.x + subject.width, mask.width);
    const int bottom = std::min(subject.y + subject.height, mask.height);
    for (int y = std::max(subject.y, 0); y < bottom; y += 2) {
        const std::uint8_t* row = mask.row(y);
        std::uint8_t* has =
            tiles.has_person.data() + static_cast<std::ptrdiff_t>(y / kTile) * tiles.columns;
        for (int x = std::max(subject.x, 0); x < right;) {
            const int end = std::min((x / kTile + 1) * kTile, right);
            if (std::memchr(row + x, 255, static_cast<std::size_t>(end - x)) != nullptr)
                has[x / kTile] = 1;
            x = end;
        }
    }
}

// In a square around the pixel.
bool DissentSearch::shows_nobody(const Tiles& tiles,
                                 const CameraEye& eye,
                                 const Eigen::Vector2f& px,
                                 float radius_px) {
    const auto tile = [](float at, int size) {
        return std::clamp(static_cast<int>(at), 0, size - 1) / kTile;
    };
    const int left = tile(px.x() - radius_px, eye.width());
    const int right = tile(px.x() + radius_px, eye.width());
    const int last = tile(px.y() + radius_px, eye.height());
    for (int row = tile(px.y() - radius_px, eye.height()); row <= last; ++row) {
        const std::uint8_t* has =
            tiles.has_person.data() + static_cast<std::ptrdiff_t>(row) * tiles.columns;
        if (std::any_of(has + left, has + right + 1, [](std::uint8_t h) { return h != 0; }))
            return false;
    }
    return true;
}

void DissentSearch::search_cell(std::span<const CameraView> views,
                                std::span<const CameraEye> eyes,
                                const Eigen::Vector3f& low,
                                std::vector<Dissent>& found) const {
    // nothing to find where more than one camera shows nobody anywhere near the cell
    const float half_m = 0.5F * options_.voxel_m * kVoxels;
    const Eigen::Vector3f centre = low.array() + half_m;
    std::size_t num_without = 0;
    for (std::size_t i = 0; i < views.size() && num_without < 2; ++i) {
        if (!counts(views[i], eyes[i])) continue;
        const CameraEye::Place place = eyes[i].place_of(centre);
        if (!place.is_in_picture) continue;
        const float radius_px = std::sqrt(3.0F) * half_m * eyes[i].focal_px() / place.depth_m;
        if (shows_nobody(tiles_[i], eyes[i], place.px, radius_px)) ++num_without;
    }
    if (num_without > 1) return;
    // neighbours mostly end at the same two cameras: those come first
    std::array<std::size_t, kMostCameras> order{};
    std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(views.size()), 0U);
    for (int voxel = 0; voxel < kVoxels * kVoxels * kVoxels; ++voxel) {
        const Eigen::Array3i at(
            voxel % kVoxels, voxel / kVoxels % kVoxels, voxel / (kVoxels * kVoxels));
        const Eigen::Vector3f point = low.array() + options_.voxel_m * (at.cast<float>() + 0.5F);
        std::size_t num_with = 0;
        num_without = 0;
        for (std::size_t k = 0; k < views.size() && num_without < 2; ++k) {
            const std::size_t i = order[k];
            if (!counts(views[i], eyes[i])) continue;
            const CameraEye::Place place = eyes[i].place_of(point);
            if (!place.is_in_picture) continue;
            if (is_person(views[i], place.px))
                ++num_with;
            else
                std::swap(order[k], order[num_without++]);
        }
        if (num_without == 1 && num_with >= options_.fewest_others)
            found.push_back({point, order[0]});
    }
}

void DissentSearch::find(std::span<const CameraView> views,
                         std::span<const CameraEye> eyes,
                         Executor& executor) {
    assert(views.size() == eyes.size() && views.size() <= kMostCameras);
    tiles_.resize(views.size());
    // so little work that waiting for other workers would take longer
    for (std::size_t i = 0; i < views.size(); ++i)
        if (counts(views[i], eyes[i])) note_people(views[i], tiles_[i]);
    const std::size_t stride = turn_ == 0 ? 1 : options_.num_turns;
    const std::size_t first = turn_++ % stride;
    const auto work = [&](std::size_t task, std::size_t worker) {
        const std::size_t chunk = first + task * stride;
        found_in_[chunk].clear();
        const std::size_t end = std::min(cells_.size(), (chunk + 1) * kChunk);
        for (std::size_t cell = chunk * kChunk; cell < end; ++cell) {
            search_cell(views, eyes, cells_[cell], found_in_[chunk]);
            executor.give_way(worker);
        }
    };
    if (first < found_in_.size())
        executor.parallel_for((found_in_.size() - first + stride - 1) / stride, work);
    found_.clear();
    for (const auto& found : found_in_) found_.insert(found_.end(), found.begin(), found.end());
}

}  // namespace atrium::camouflage
