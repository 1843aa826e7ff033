#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/luma_picture.hpp"

#include <span>
#include <vector>

namespace atrium::bench {

/// What the cameras of a simulated room see at one instant, in their order.
struct FilmedInstant {
    std::vector<hull::SilhouetteView> silhouettes;
    std::vector<image::YuvImage> pictures;
    std::vector<image::Mask> masks;

    std::vector<const hull::SilhouetteView*> silhouette_pointers() const;
    std::vector<refine::PictureView> picture_views(
        std::span<const geometry::CalibratedCamera> cameras) const;
};

/// With true masks: figures show what the geometry adds to the error, not the segmentation.
FilmedInstant film(simulation::RoomRenderer& room, double time_s);

}  // namespace atrium::bench
