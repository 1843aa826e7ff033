#include "site_node/occupied_room/space_carver.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace atrium::occupied_room {
namespace {

constexpr double kMinCell_m = 0.03;
constexpr double kMaxCells = 400'000.0;
constexpr int kMaxRadius = 32;

}  // namespace

SpaceCarver::SpaceCarver(std::span<const geometry::CalibratedCamera> cameras,
                         const geometry::Aabb& bounds_site) {
    const Eigen::Vector3d size = bounds_site.size();
    cell_m_ = std::max(kMinCell_m, std::cbrt(size.prod() / kMaxCells));
    Eigen::Array3i counts;
    for (int i = 0; i < 3; ++i)
        counts[i] = std::max(1, static_cast<int>(std::ceil(size[i] / cell_m_)));
    num_cells_ = static_cast<std::size_t>(counts.prod());
    for (const geometry::CalibratedCamera& camera : cameras) {
        View& view = views_.emplace_back();
        view.block.reserve(num_cells_);
        view.radius.reserve(num_cells_);
        const geometry::PinholeCamera& lens = camera.intrinsics;
        for (int z = 0; z < counts[2]; ++z) {
            for (int y = 0; y < counts[1]; ++y) {
                for (int x = 0; x < counts[0]; ++x) {
                    const Eigen::Vector3d centre =
                        bounds_site.min + cell_m_ * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5);
                    const Eigen::Vector3d p_camera = camera.camera_from_site * centre;
                    std::int32_t block = -1;
                    int radius = 0;
                    if (p_camera.z() > cell_m_) {
                        const Eigen::Vector2d px = lens.distort(lens.project(p_camera));
                        const int column = static_cast<int>(std::floor((px.x() + 0.5) / 2.0));
                        const int row = static_cast<int>(std::floor((px.y() + 0.5) / 2.0));
                        if (px.allFinite() && column >= 0 && row >= 0 && column < lens.width / 2 &&
                            row < lens.height / 2)
                            block = row * (lens.width / 2) + column;
                        radius = static_cast<int>(
                            std::ceil(0.5 * cell_m_ * lens.fx / p_camera.z() * 0.5));
                    }
                    view.block.push_back(block);
                    view.radius.push_back(
                        static_cast<std::uint8_t>(std::clamp(radius, 1, kMaxRadius)));
                }
            }
        }
    }
}

void SpaceCarver::mark(std::size_t camera, std::size_t cell, image::Mask& mask) const {
    const std::int32_t block = views_[camera].block[cell];
    const int radius = views_[camera].radius[cell];
    const int column = block % mask.width;
    const int row = block / mask.width;
    const int left = std::max(column - radius, 0);
    const int right = std::min(column + radius + 1, mask.width);
    for (int y = std::max(row - radius, 0); y < std::min(row + radius + 1, mask.height); ++y)
        std::fill(mask.row(y) + left, mask.row(y) + right, std::uint8_t{255});
}

image::Mask SpaceCarver::reachable(std::size_t camera, int columns, int rows) const {
    image::Mask mask(columns, rows);
    for (std::size_t cell = 0; cell < num_cells_; ++cell)
        if (views_[camera].block[cell] >= 0) mark(camera, cell, mask);
    return mask;
}

// Cameras that show a person at this cell whom no cell explains that all cameras see.
int SpaceCarver::num_unexplained(std::span<const image::Mask> masks, std::size_t cell) const {
    int num = 0;
    for (std::size_t camera = 0; camera < masks.size(); ++camera) {
        const std::int32_t block = views_[camera].block[cell];
        if (block < 0 || masks[camera].data.empty()) continue;
        const auto b = static_cast<std::size_t>(block);
        num += masks[camera].data[b] == kPerson && explained_[camera].data[b] == 0 ? 1 : 0;
    }
    return num;
}

void SpaceCarver::carve(std::span<const image::Mask> masks, std::vector<OthersSay>& others_say) {
    constexpr int kMaxMisses = 2;  // cameras that face each other lose the same part of a person
    constexpr int kMinUnexplained = 3;
    others_say.resize(masks.size());
    explained_.resize(masks.size());
    cuts_.clear();
    for (std::size_t camera = 0; camera < masks.size(); ++camera) {
        const image::Mask none(masks[camera].width, masks[camera].height);
        others_say[camera] = {none, none};
        explained_[camera] = none;
    }
    for (std::size_t cell = 0; cell < num_cells_; ++cell) {
        std::uint64_t sees = 0;
        std::uint64_t misses = 0;
        for (std::size_t camera = 0; camera < masks.size() && std::popcount(misses) <= kMaxMisses;
             ++camera) {
            const std::int32_t block = views_[camera].block[cell];
            if (block < 0 || masks[camera].data.empty()) continue;
            const std::uint64_t bit = std::uint64_t{1} << camera;
            sees |= bit;
            if (masks[camera].data[static_cast<std::size_t>(block)] == 0) misses |= bit;
        }
        if (std::popcount(misses) > kMaxMisses) continue;
        if (misses != 0) cuts_.push_back({cell, misses});
        for (std::size_t camera = 0; camera < masks.size(); ++camera) {
            const std::uint64_t bit = std::uint64_t{1} << camera;
            if ((sees & bit) == 0) continue;
            if (misses == 0) mark(camera, cell, explained_[camera]);
            if ((misses & ~bit) == 0 && std::popcount(sees & ~bit) >= 2)
                mark(camera, cell, others_say[camera].hidden);
        }
    }
    for (const Cut& cut : cuts_) {
        if (num_unexplained(masks, cut.cell) < kMinUnexplained) continue;
        for (std::size_t camera = 0; camera < masks.size(); ++camera)
            if ((cut.misses >> camera & 1) != 0) mark(camera, cut.cell, others_say[camera].needed);
    }
}

}  // namespace atrium::occupied_room
