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
    /// Values of the masks; 0: the room, and nobody.
    static constexpr std::uint8_t kPerson = 255;
    static constexpr std::uint8_t kMayHide = 128;  // was never seen empty, may hide a person

    /// What the other cameras say about the blocks of one camera at one instant.
    struct OthersSay {
        /// Every other camera, at least two, covers this place with a person. Drawn a little too
        /// large, which covers shadows, too.
        image::Mask hidden;
        /// The other cameras show a person here that nothing else explains: with this camera's
        /// room in place of the person, rays of at least three of them meet nobody.
        image::Mask needed;
    };

    /// `bounds_site` is where people can be. The number of cells is bounded.
    SpaceCarver(std::span<const geometry::CalibratedCamera> cameras,
                const geometry::Aabb& bounds_site);

    /// `masks[camera]` are the masks of one instant; an empty mask: no picture.
    void carve(std::span<const image::Mask> masks, std::vector<OthersSay>& others_say);

    /// Blocks onto which any cell projects: where people can be.
    image::Mask reachable(std::size_t camera, int columns, int rows) const;

private:
    // Where the centre of each cell projects.
    struct View {
        std::vector<std::int32_t> block;   // index into the mask; -1: outside the picture
        std::vector<std::uint8_t> radius;  // of the projected cell [blocks]
    };
    // A cell that one or two cameras cut away.
    struct Cut {
        std::size_t cell;
        std::uint64_t misses;  // these cameras see the room there, and nobody
    };
    void mark(std::size_t camera, std::size_t cell, image::Mask& mask) const;
    int num_unexplained(std::span<const image::Mask> masks, std::size_t cell) const;

    double cell_m_ = 0.0;
    std::size_t num_cells_ = 0;
    std::vector<View> views_;  // per camera
    // of the last instant
    std::vector<Cut> cuts_;
    std::vector<image::Mask>
        explained_;  // per camera: blocks onto which cells project that all see
};

}  // namespace atrium::occupied_room
