#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::stream {

/// One way to send the stream.
struct Level {
    int jpeg_quality = 85;
    int colour_divisor = 1;  // 1: colours as large as the mask; 2: half as wide and high
    int send_every = 1;      // of n metaframes one is sent
    bool operator==(const Level&) const = default;
};

/// All levels from the best, which is `jpeg_quality` in full, to the smallest: first quality falls,
/// then resolution, then rate.
std::vector<Level> make_ladder(int jpeg_quality);

/// What one coded frame has. Colours shrink with the level; mesh and masks do not.
struct FrameBytes {
    std::size_t fixed = 0;   // mesh and masks
    std::size_t colour = 0;  // JPEG of all cameras
};

/// How large a frame is at each level, learned from the frames that were sent.
class SizeModel {
public:
    explicit SizeModel(const std::vector<Level>& ladder);

    /// A frame that was coded at this level of the ladder. One without colours, where nobody is
    /// seen, says nothing about those who come next and is passed over.
    void add(std::size_t level, const FrameBytes& bytes);

    /// Expected bytes of the next frame; 0 while no frame was seen.
    double frame_bytes(std::size_t level) const;

private:
    std::vector<std::size_t> coding_;  // per level: the first one with the same pictures
    std::vector<double> ratio_;        // per coding: colour bytes relative to the best level
    double fixed_ = 0.0;
    double colour_at_best_ = 0.0;
    std::size_t last_coding_ = 0;
    int num_since_change_ = 0;
    bool has_seen_ = false;
};

}  // namespace atrium::stream
