#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/refine/luma_picture.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace atrium::bench {

/// Motions with limbs apart, crossed, raised, bent and before the trunk.
inline constexpr std::array kMotions{"wave", "walk", "push", "kick", "scoop", "carry"};

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

/// The exact hull. Ends the program with 1 and a message that begins with `where` if there is none.
geometry::TriangleMesh hull_of(const FilmedInstant& instant,
                               hull::HullScratch& scratch,
                               const std::string& where);

}  // namespace atrium::bench
