#pragma once

#include "core/base/executor.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "site_node/camouflage/camera_eye.hpp"
#include "site_node/camouflage/camera_view.hpp"
#include "site_node/camouflage/dissent_search.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::camouflage {

struct CamouflagedPartsOptions {
    DissentSearchOptions search;
    float least_depth_m = 0.06F;    // of a person, along a viewing ray
    float most_clash = 30.0F;       // between the colours of two cameras (image::colour_clash)
    float least_change = 2.5F;      // of a block from the empty room [grey levels]
    std::size_t fewest_blocks = 8;  // of a part
};

/// Finds parts of people that look like the empty room in one camera, from what all others show:
/// a light shirt before a light wall. Its silhouette alone would cut them out of the visual hull.
///
/// Space is searched for places where all cameras but one show a person, a quarter of it at each
/// instant. That camera's picture is then decided in blocks of 8 x 8 pixels. A block belongs to a
/// person if all others see one along its viewing ray, and if what it shows is not the empty room
/// as it was learned (a shadow on it counts as unknown), but the colour that one of the cameras
/// beside it shows there. The hull of the others bounds the part at its edge.
///
/// Where a silhouette is right, such places are few if there are many cameras, and thin; and the
/// colours differ there.
///
/// Related: Lee, Woo, Boyer, "Silhouette Segmentation in Multiple Views", 2011. We decide blocks
/// instead of solving for all pixels of all cameras together.
///
/// Deterministic, for any number of workers. Keeps its memory. Not thread-safe.
class CamouflagedParts {
public:
    /// `bounds_site`: where people can be; DissentSearch::can_search them.
    CamouflagedParts(std::span<const geometry::CalibratedCamera> cameras,
                     const geometry::Aabb& bounds_site,
                     const CamouflagedPartsOptions& options = {});

    /// `views`: one per camera, of successive instants.
    void find(std::span<const CameraView> views, Executor& executor);

    /// What the last `find` found in the picture of a camera: squares of pixels.
    std::span<const image::PixelRect> found(std::size_t camera) const {
        return pictures_[camera].found;
    }

private:
    static constexpr int kBlock = 8;
    struct Block {
        float near_m = 0.0F;  // depths of the candidates in it
        float far_m = 0.0F;   // 0: no candidates
    };
    struct Run {
        float first_m = 0.0F;
        float depth_m = 0.0F;  // 0: there is none
    };
    // Working memory of one camera.
    struct Picture {
        int columns = 0;
        int rows = 0;
        std::vector<Block> blocks;
        std::vector<std::uint8_t> is_found;  // per block
        std::vector<std::uint32_t> marked;   // blocks with candidates
        std::vector<std::uint32_t> part;
        std::vector<std::uint32_t> edge;
        std::vector<image::PixelRect> found;
    };

    void decide(std::span<const CameraView> views, std::size_t camera, const GiveWay& give_way);
    bool belongs_to_person(std::span<const CameraView> views,
                           std::size_t camera,
                           std::uint32_t block) const;
    void mark_blocks(std::size_t camera);
    Run longest_run(std::span<const CameraView> views,
                    std::size_t camera,
                    const Eigen::Vector2f& px,
                    const Block& block) const;
    bool agrees(std::span<const CameraView> views,
                std::size_t camera,
                const Eigen::Vector3f& point_site) const;
    bool shows_same_colour(std::span<const CameraView> views,
                           std::size_t camera,
                           const Eigen::Vector3f& point_site,
                           const Eigen::Vector3f& colour) const;
    void drop_small_parts(Picture& picture) const;
    void add_edge(std::span<const CameraView> views, std::size_t camera, const GiveWay& give_way);

    CamouflagedPartsOptions options_;
    std::vector<CameraEye> eyes_;
    DissentSearch search_;
    std::vector<Picture> pictures_;  // per camera
};

}  // namespace atrium::camouflage
