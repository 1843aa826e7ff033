#include "site_node/camouflage/camouflaged_parts.hpp"

#include "core/image/colour_clash.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace atrium::camouflage {
namespace {

constexpr float kRayStep_m = 0.02F;
constexpr float kGreysPerLevel = 256.0F;  // of the luma of a BackgroundModel
constexpr float kChromaPerLevel = 128.0F;
constexpr int kTestedRows = 4;  // of each so many rows, the first two are valid everywhere

// Mean Y, U and V of what is valid in a block whose corner and side are multiples of four; `room`:
// the same of the empty room.
struct BlockColour {
    Eigen::Vector3f shown = Eigen::Vector3f::Zero();
    Eigen::Vector3f room = Eigen::Vector3f::Zero();
};
BlockColour colour_of(const CameraView& view, int left, int top, int side) {
    const segmentation::BackgroundModel& room = *view.room;
    BlockColour sum;
    const auto width = static_cast<std::size_t>(room.width());
    for (int y = top; y < top + side; y += kTestedRows) {
        for (int row = y; row < y + 2; ++row) {
            for (int x = left; x < left + side; ++x) {
                sum.shown.x() += static_cast<float>(view.picture.y.at(x, row));
                sum.room.x() += static_cast<float>(
                    room.luma[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(x)]);
            }
        }
        for (int x = left / 2; x < (left + side) / 2; ++x) {
            const std::size_t block =
                static_cast<std::size_t>(y / 2) * (width / 2) + static_cast<std::size_t>(x);
            sum.shown.y() += static_cast<float>(view.picture.u.at(x, y / 2)) - 128.0F;
            sum.shown.z() += static_cast<float>(view.picture.v.at(x, y / 2)) - 128.0F;
            sum.room.y() += static_cast<float>(room.u[block]);
            sum.room.z() += static_cast<float>(room.v[block]);
        }
    }
    const auto num_pixels = static_cast<float>(side * side / 2);
    const float num_chroma = num_pixels / 4.0F;
    sum.shown.x() *= view.inverse_gain;
    const Eigen::Array3f num(num_pixels, num_chroma, num_chroma);
    sum.shown.array() /= num;
    sum.room.array() /= num * Eigen::Array3f(kGreysPerLevel, kChromaPerLevel, kChromaPerLevel);
    return sum;
}

}  // namespace

CamouflagedParts::CamouflagedParts(std::span<const geometry::CalibratedCamera> cameras,
                                   const geometry::Aabb& bounds_site,
                                   const CamouflagedPartsOptions& options)
    : options_(options), search_(bounds_site, options.search), pictures_(cameras.size()) {
    for (const geometry::CalibratedCamera& camera : cameras) eyes_.emplace_back(camera);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        Picture& picture = pictures_[i];
        picture.columns = eyes_[i].width() / kBlock;
        picture.rows = eyes_[i].height() / kBlock;
        picture.blocks.resize(static_cast<std::size_t>(picture.columns) *
                              static_cast<std::size_t>(picture.rows));
        picture.is_found.resize(picture.blocks.size());
    }
}

// Whether all other cameras that see the point show a person there.
bool CamouflagedParts::agrees(std::span<const CameraView> views,
                              std::size_t camera,
                              const Eigen::Vector3f& point_site) const {
    std::size_t num_with = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (i == camera || !counts(views[i], eyes_[i])) continue;
        const CameraEye::Place place = eyes_[i].place_of(point_site);
        if (!place.is_in_picture) continue;
        if (!is_person(views[i], place.px)) return false;
        ++num_with;
    }
    return num_with >= options_.search.fewest_others;
}

// Where others see a person along the ray of a pixel, near the candidates of its block.
CamouflagedParts::Run CamouflagedParts::longest_run(std::span<const CameraView> views,
                                                    std::size_t camera,
                                                    const Eigen::Vector2f& px,
                                                    const Block& block) const {
    constexpr float kBeyond_m = 0.1F;
    const CameraEye& eye = eyes_[camera];
    const Eigen::Vector3f ray = eye.ray_camera(px);
    Run longest;
    Run run;
    if (ray.z() == 0.0F) return longest;
    const float far_m = block.far_m + kBeyond_m;
    for (float depth_m = std::max(block.near_m - kBeyond_m, kRayStep_m); depth_m < far_m;
         depth_m += kRayStep_m) {
        if (!agrees(views, camera, eye.point_site(ray, depth_m))) {
            run = {};
            continue;
        }
        if (run.depth_m == 0.0F) run.first_m = depth_m;
        run.depth_m += kRayStep_m;
        if (run.depth_m > longest.depth_m) longest = run;
    }
    return longest;
}

// Whether one of the two cameras beside this one shows the colour where its ray meets the person.
bool CamouflagedParts::shows_same_colour(std::span<const CameraView> views,
                                         std::size_t camera,
                                         const Eigen::Vector3f& point_site,
                                         const Eigen::Vector3f& colour) const {
    constexpr int kSide = 4;
    const Eigen::Vector3f to_camera = (eyes_[camera].centre_site() - point_site).normalized();
    std::array<std::pair<float, std::size_t>, 2> beside{};  // cosine, camera; falling
    beside.fill({-1.0F, views.size()});
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (i == camera || !counts(views[i], eyes_[i])) continue;
        const float cosine = (eyes_[i].centre_site() - point_site).normalized().dot(to_camera);
        if (cosine > beside[0].first)
            beside = {std::pair(cosine, i), beside[0]};
        else if (cosine > beside[1].first)
            beside[1] = {cosine, i};
    }
    for (const auto& [cosine, i] : beside) {
        if (i == views.size()) continue;
        const CameraEye::Place place = eyes_[i].place_of(point_site);
        if (!place.is_in_picture) continue;
        const int left = static_cast<int>(place.px.x()) / kSide * kSide;
        const int top = static_cast<int>(place.px.y()) / kSide * kSide;
        const image::YuvView& picture = views[i].picture;
        if (left + kSide > picture.width() || top + kSide > picture.height()) continue;
        if (image::colour_clash(colour_of(views[i], left, top, kSide).shown, colour) <=
            options_.most_clash)
            return true;
    }
    return false;
}

// Notes in which blocks of its picture a camera alone shows nobody.
void CamouflagedParts::mark_blocks(std::size_t camera) {
    Picture& picture = pictures_[camera];
    for (const std::uint32_t block : picture.marked) {
        picture.blocks[block] = {};
        picture.is_found[block] = 0;
    }
    picture.marked.clear();
    for (const Dissent& candidate : search_.found()) {
        if (candidate.camera != camera) continue;
        const CameraEye::Place place = eyes_[camera].place_of(candidate.point_site);
        if (!place.is_in_picture) continue;
        const float radius_px = options_.search.voxel_m * eyes_[camera].focal_px() / place.depth_m;
        const auto first = [](float px) {
            return std::max(0, static_cast<int>(std::floor(px / kBlock)));
        };
        const int last_column =
            std::min(picture.columns - 1, static_cast<int>((place.px.x() + radius_px) / kBlock));
        const int last_row =
            std::min(picture.rows - 1, static_cast<int>((place.px.y() + radius_px) / kBlock));
        for (int row = first(place.px.y() - radius_px); row <= last_row; ++row) {
            for (int column = first(place.px.x() - radius_px); column <= last_column; ++column) {
                const auto index = static_cast<std::uint32_t>(row * picture.columns + column);
                Block& block = picture.blocks[index];
                if (block.far_m == 0.0F) {
                    picture.marked.push_back(index);
                    block.near_m = std::numeric_limits<float>::infinity();
                }
                block.near_m = std::min(block.near_m, place.depth_m);
                block.far_m = std::max(block.far_m, place.depth_m);
            }
        }
    }
}

// Whether a block that the mask leaves out shows a person.
bool CamouflagedParts::belongs_to_person(std::span<const CameraView> views,
                                         std::size_t camera,
                                         std::uint32_t index) const {
    const Picture& picture = pictures_[camera];
    const CameraView& view = views[camera];
    const int left = static_cast<int>(index) % picture.columns * kBlock;
    const int top = static_cast<int>(index) / picture.columns * kBlock;
    int num_known = 0;
    for (int y = top; y < top + kBlock; y += 4)
        for (int x = left; x < left + kBlock; x += 2) num_known += view.mask->at(x, y) != 0 ? 1 : 0;
    if (num_known > kBlock / 2) return false;
    const BlockColour colour = colour_of(view, left, top, kBlock);
    if ((colour.shown - colour.room).cwiseAbs().maxCoeff() < options_.least_change) return false;
    const Eigen::Vector2f middle =
        Eigen::Array2f(static_cast<float>(left), static_cast<float>(top)) +
        0.5F * static_cast<float>(kBlock - 1);
    const Run run = longest_run(views, camera, middle, picture.blocks[index]);
    if (run.depth_m < options_.least_depth_m) return false;
    const CameraEye& eye = eyes_[camera];
    return shows_same_colour(
        views, camera, eye.point_site(eye.ray_camera(middle), run.first_m), colour.shown);
}

// Drops parts of few blocks, which have a side in common.
void CamouflagedParts::drop_small_parts(Picture& picture) const {
    constexpr std::uint8_t kVisited = 2;
    std::vector<std::uint32_t>& part = picture.part;
    for (const std::uint32_t start : picture.marked) {
        if (picture.is_found[start] != 1) continue;
        part.assign(1, start);
        picture.is_found[start] = kVisited;
        for (std::size_t k = 0; k < part.size(); ++k) {
            const int column = static_cast<int>(part[k]) % picture.columns;
            const int row = static_cast<int>(part[k]) / picture.columns;
            for (const auto& [x, y] : {std::pair(column - 1, row),
                                       std::pair(column + 1, row),
                                       std::pair(column, row - 1),
                                       std::pair(column, row + 1)}) {
                if (x < 0 || y < 0 || x >= picture.columns || y >= picture.rows) continue;
                const auto next = static_cast<std::uint32_t>(y * picture.columns + x);
                if (picture.is_found[next] != 1) continue;
                picture.is_found[next] = kVisited;
                part.push_back(next);
            }
        }
        if (part.size() >= options_.fewest_blocks) continue;
        for (const std::uint32_t block : part) picture.is_found[block] = 0;
    }
}

// Around the blocks that were found, the others' silhouettes decide each 2 x 2 pixels.
void CamouflagedParts::add_edge(std::span<const CameraView> views,
                                std::size_t camera,
                                const GiveWay& give_way) {
    constexpr int kCell = 2;
    constexpr float kLeastDepth_m = 0.04F;
    Picture& picture = pictures_[camera];
    picture.edge.clear();
    const auto columns = static_cast<std::uint32_t>(picture.columns);
    for (const std::uint32_t index : picture.marked) {
        if (picture.is_found[index] == 0) continue;
        const std::uint32_t column = index % columns;
        const std::uint32_t row = index / columns;
        for (std::uint32_t y = std::max(row, 1U) - 1; y <= row + 1; ++y) {
            for (std::uint32_t x = std::max(column, 1U) - 1; x <= column + 1; ++x) {
                if (x >= columns || y >= static_cast<std::uint32_t>(picture.rows)) continue;
                const std::uint32_t next = y * columns + x;
                if (picture.is_found[next] != 0) continue;
                Block& block = picture.blocks[next];
                if (block.far_m == 0.0F) block.near_m = std::numeric_limits<float>::infinity();
                block.near_m = std::min(block.near_m, picture.blocks[index].near_m);
                block.far_m = std::max(block.far_m, picture.blocks[index].far_m);
                picture.edge.push_back(next);
            }
        }
    }
    std::ranges::sort(picture.edge);
    const auto repeated = std::ranges::unique(picture.edge);
    picture.edge.erase(repeated.begin(), repeated.end());
    for (const std::uint32_t index : picture.edge) {
        give_way();
        const int left = static_cast<int>(index % columns) * kBlock;
        const int top = static_cast<int>(index / columns) * kBlock;
        for (int y = top; y < top + kBlock; y += kCell) {
            for (int x = left; x < left + kBlock; x += kCell) {
                const Eigen::Vector2f middle(static_cast<float>(x) + 0.5F,
                                             static_cast<float>(y) + 0.5F);
                if (longest_run(views, camera, middle, picture.blocks[index]).depth_m >=
                    kLeastDepth_m)
                    picture.found.push_back({x, y, kCell, kCell});
            }
        }
    }
    // so that the next instant forgets these blocks, too
    picture.marked.insert(picture.marked.end(), picture.edge.begin(), picture.edge.end());
}

void CamouflagedParts::decide(std::span<const CameraView> views,
                              std::size_t camera,
                              const GiveWay& give_way) {
    Picture& picture = pictures_[camera];
    mark_blocks(camera);
    for (const std::uint32_t block : picture.marked) {
        picture.is_found[block] = belongs_to_person(views, camera, block) ? 1 : 0;
        give_way();
    }
    drop_small_parts(picture);
    for (const std::uint32_t block : picture.marked) {
        if (picture.is_found[block] == 0) continue;
        const auto at = static_cast<int>(block);
        picture.found.push_back(
            {at % picture.columns * kBlock, at / picture.columns * kBlock, kBlock, kBlock});
    }
    if (!picture.found.empty()) add_edge(views, camera, give_way);
}

void CamouflagedParts::find(std::span<const CameraView> views, Executor& executor) {
    assert(views.size() == pictures_.size());
    search_.find(views, eyes_, executor);
    for (Picture& picture : pictures_) picture.found.clear();
    if (search_.found().empty()) return;
    const auto work = [&](std::size_t camera, std::size_t worker) {
        if (counts(views[camera], eyes_[camera])) decide(views, camera, {&executor, worker});
    };
    executor.parallel_for(views.size(), work);
}

}  // namespace atrium::camouflage
