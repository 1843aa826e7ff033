#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::stream {

/// One way to code and send the stream.
struct Level {
    int jpeg_quality = 85;
    int colour_divisor = 1;  // 1: colours as large as the mask; 2: half as wide and high
    int send_every = 1;      // sends one of this many metaframes
    bool operator==(const Level&) const = default;
};

/// Returns all levels from the best, full resolution at `jpeg_quality`, to the smallest: first
/// quality falls, then resolution, then rate.
std::vector<Level> make_ladder(int jpeg_quality);

/// Size of one coded frame. Only the colours shrink with the level.
struct FrameBytes {
    std::size_t fixed = 0;   // mesh and masks
    std::size_t colour = 0;  // JPEG of all cameras
};

/// Predicts the size of a frame at each level from the frames sent so far.
class SizeModel {
public:
    explicit SizeModel(const std::vector<Level>& ladder);

    /// Adds a frame coded at this level. Ignores frames without colours: an empty room says nothing
    /// about the next person.
    void add(std::size_t level, const FrameBytes& bytes);

    /// Expected bytes of the next frame; 0 before the first one.
    double frame_bytes(std::size_t level) const;

private:
    std::vector<std::size_t> coding_;  // per level: the first level with the same pictures
    std::vector<double> ratio_;        // per coding: colour bytes relative to the best level
    double fixed_ = 0.0;
    double colour_at_best_ = 0.0;
    std::size_t last_coding_ = 0;
    int num_since_change_ = 0;
    bool has_seen_ = false;
};

}  // namespace atrium::stream
