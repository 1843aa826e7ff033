#pragma once

#include "site_node/coherence/coherence.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace atrium::coherence {

/// Decides when a running site tells of a camera that was moved or is late: if two judgements in a
/// row agree, then again after ten minutes. No threads; not thread-safe.
class CoherenceWatch {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kJudgementPeriod{5};
    static constexpr std::chrono::minutes kRepeat{10};

    explicit CoherenceWatch(std::vector<geometry::CalibratedCamera> cameras)
        : coherence_(std::move(cameras)) {}

    /// Adds an instant. Returns a report with a fault if it is to be told now.
    std::optional<Report> look(const Sight& sight, Clock::time_point now);

    Report judge() const { return coherence_.judge(); }
    std::size_t num_looks() const { return num_looks_; }

private:
    using Key = std::pair<Verdict, std::size_t>;  // camera

    Coherence coherence_;
    std::size_t num_looks_ = 0;
    std::optional<Clock::time_point> last_judgement_;
    std::optional<Key> last_, told_;
    Clock::time_point told_at_{};
};

}  // namespace atrium::coherence
