#pragma once

#include "core/recording/site_frames.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::exporting {

/// Part of a recording that is exported.
struct Selection {
    std::string site;
    Timestamp begin;  // when recorded, both included
    Timestamp end;
    std::uint32_t every = 1;  // each n-th frame
};

/// The frames of a selection in turn: with all their textures, at rising capture times.
class FrameSource {
public:
    /// As recording::SiteFrames::open.
    static Expected<FrameSource> open(const std::shared_ptr<const recording::WorldFile>& world,
                                      const Selection& selection);
    std::optional<recording::SiteFrame> next();

    /// Frames that were left out, so far: textures were lost, or another frame has the same time.
    std::uint64_t num_left_out() const { return num_left_out_; }
    const recording::SiteFrames& frames() const { return frames_; }

private:
    FrameSource(recording::SiteFrames frames, std::uint32_t every)
        : frames_(std::move(frames)), every_(every) {}

    recording::SiteFrames frames_;
    std::uint32_t every_;
    std::uint64_t num_good_ = 0;
    std::uint64_t num_left_out_ = 0;
    std::optional<Timestamp> last_;
};

/// The times of a selection's frames, from reading it once.
struct Survey {
    struct Time {
        Timestamp capture_time;
        Timestamp recorded;
    };
    std::vector<Time> frames;
    std::uint64_t num_refused = 0;                      // samples that could not be read
    std::uint64_t num_damaged = 0;                      // chunks that could not be read
    std::string damage;                                 // why the last of them could not
    double rate_hz = 0.0;                               // median
    std::optional<geometry::RigidTransform> placement;  // world_from_site at the first frame

    double time_s(std::size_t frame) const;  // since the first frame
};

/// Looks at up to `max_frames` frames of the selection. kConfiguration if it has none: the message
/// says when the recording has some.
Expected<Survey> survey(const std::shared_ptr<const recording::WorldFile>& world,
                        const Selection& selection,
                        std::size_t max_frames);

}  // namespace atrium::exporting
