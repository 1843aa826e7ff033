#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::occupied_room {

/// Finds where people hide in one picture according to the other cameras: carves a grid of cells by
/// the masks of all other cameras and draws the cells that remain. Much coarser than the hull of
/// the site, and it needs no clean outlines.
///
/// Masks have half the size of the pictures: one value per 2x2 block.
class SpaceCarver {
public:
    /// `bounds_site` is where people can be. The number of cells is bounded.
    SpaceCarver(std::span<const geometry::CalibratedCamera> cameras,
                const geometry::Aabb& bounds_site);

    /// `masks[camera]` are the masks of one instant; an empty mask: no picture. Writes per camera
    /// the blocks onto which cells project that every other camera with a picture, at least two,
    /// covers with a person. Draws cells a little too large, which covers their shadows, too.
    void carve(std::span<const image::Mask> masks, std::vector<image::Mask>& hidden_by_others);

    /// Blocks onto which any cell projects: where people can be.
    image::Mask reachable(std::size_t camera, int columns, int rows) const;

private:
    // Where the centre of each cell projects.
    struct View {
        std::vector<std::int32_t> block;   // index into the mask; -1: outside the picture
        std::vector<std::uint8_t> radius;  // of the projected cell [blocks]
    };
    void mark(std::size_t camera, std::size_t cell, image::Mask& mask) const;

    double cell_m_ = 0.0;
    std::size_t num_cells_ = 0;
    std::vector<View> views_;  // per camera
};

}  // namespace atrium::occupied_room
