#pragma once

#include "core/base/expected.hpp"
#include "viewer/config/viewer_config.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Decides when the pictures of a run start to count and when the run ends, from the options
/// `wait_people`, `frames` and `seconds`.
class RunLimit {
public:
    using Clock = std::chrono::steady_clock;

    RunLimit(const ViewerConfig& config, Clock::time_point begin);

    enum class Now { kGoesOn, kBegan, kOver };  // kBegan: pictures count from now on
    /// Call after every picture; `num_frames` pictures so far. Error kUnavailable if the people do
    /// not come in time.
    Expected<Now> update(std::uint64_t num_frames, std::size_t num_people, Clock::time_point now);
    /// What to do if the people do not come. `place`: the world, and what else is heard;
    /// `silent_sites`: sites of this world that publish nothing yet.
    static std::string cure(const std::string& place, const std::vector<std::string>& silent_sites);

    /// Whether pictures count now.
    bool is_counting() const { return is_counting_; }
    /// Rate of the pictures that counted.
    double frames_per_s() const { return frames_per_s_; }

private:
    std::size_t wait_people_;
    Clock::duration wait_timeout_;
    std::uint64_t frames_;
    Clock::duration length_;  // 0: no limit
    Clock::time_point since_;
    std::uint64_t counted_from_ = 0;
    bool is_counting_;
    double frames_per_s_ = 0.0;
};

}  // namespace atrium::viewer
