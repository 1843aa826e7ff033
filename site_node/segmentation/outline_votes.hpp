#pragma once

#include "core/image/image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace atrium::segmentation {

/// Where the edge lies that an outline pixel of a mask follows. A person in front of the room has
/// the edge in the picture. If the learned room contains a person who has left since, the mask
/// shows that person's place, and the edge lies in the learned room.
enum class OutlineVote : std::uint8_t { kUndecided, kPicture, kRoom };

/// Compares contrasts [grey levels] across an outline.
OutlineVote compare_contrasts(int in_picture, int in_room);

/// Contrast between two pixels of a picture: sum of the differences in luma and chroma.
int contrast(const image::YuvView& picture, int x0, int y0, int x1, int y1);
int contrast(const BackgroundStatistics& room, int x0, int y0, int x1, int y1);

/// Distance of the compared pixels from the outline [px]. Even: both have the same filter of a
/// mosaic.
constexpr int kVoteDistance_px = 2;

/// Calls `visit(x, y, OutlineVote)` for every outline pixel of `mask`, once per background
/// neighbour. `picture`, `room` and `mask` must have one size.
template <typename Visit>
void visit_outline(const image::YuvView& picture,
                   const BackgroundStatistics& room,
                   const image::Mask& mask,
                   Visit&& visit) {
    constexpr int kD = kVoteDistance_px;
    struct Step {
        int x, y;
    };
    for (int y = kD; y < mask.height - kD; ++y) {
        const std::uint8_t* const row = mask.row(y);
        for (int x = kD; x < mask.width - kD; ++x) {
            if (row[x] == 0) {
                std::uint64_t next = 1;
                if (x + 8 <= mask.width) std::memcpy(&next, row + x, sizeof next);
                if (next == 0) x += 7;
                continue;
            }
            for (const Step d : {Step{1, 0}, Step{-1, 0}, Step{0, 1}, Step{0, -1}}) {
                if (mask.at(x + d.x, y + d.y) != 0) continue;
                const int in_x = x - kD * d.x;
                const int in_y = y - kD * d.y;
                const int out_x = x + kD * d.x;
                const int out_y = y + kD * d.y;
                if (mask.at(in_x, in_y) == 0 || mask.at(out_x, out_y) != 0) continue;
                visit(x,
                      y,
                      compare_contrasts(contrast(picture, in_x, in_y, out_x, out_y),
                                        contrast(room, in_x, in_y, out_x, out_y)));
            }
        }
    }
}

}  // namespace atrium::segmentation
