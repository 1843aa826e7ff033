#pragma once

#include "site_node/coherence/coherence.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace atrium::coherence {

/// Decides which faults of its rig a running site tells. A fault holds from kInARow judgements in a
/// row that find it, until as many find its camera well or a fault of another one. An incoherent
/// rig without a camera to blame is such a fault, too, unless that of a camera holds. A fault is
/// told when it begins, and every ten minutes. No threads; not thread-safe.
class CoherenceWatch {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kJudgementPeriod{2};
    static constexpr std::size_t kInARow = 3;
    static constexpr std::chrono::minutes kRepeat{10};

    explicit CoherenceWatch(std::vector<geometry::CalibratedCamera> cameras)
        : coherence_(std::move(cameras)) {}

    struct Judgement {
        Report report;         // newest figures; the verdict and the fault that hold
        bool is_told = false;  // the fault is to be told now
        std::optional<std::size_t> recovered;  // the camera whose fault ended now
    };
    /// Adds an instant. Returns a judgement if one was due.
    std::optional<Judgement> look(const Sight& sight, Clock::time_point now);

    Report judge() const { return coherence_.judge(); }
    std::size_t num_looks() const { return num_looks_; }
    /// True if the last instant counts for judgements: somebody moved.
    bool has_used_last() const { return has_used_last_; }

private:
    // One fault: its camera, or kNoCamera of an incoherent rig.
    using Key = std::pair<Verdict, std::size_t>;
    static constexpr std::size_t kNoCamera = SIZE_MAX;

    void settle(Judgement& judgement, Clock::time_point now);

    Coherence coherence_;
    std::size_t num_looks_ = 0;
    bool has_used_last_ = false;
    std::optional<Clock::time_point> last_judgement_;
    std::optional<Key> last_, told_;
    Clock::time_point told_at_{};
    std::optional<std::pair<Verdict, NamedFault>> held_;
    Verdict settled_ = Verdict::kTooLittle;
    std::size_t num_last_ = 0;  // judgements in a row that found `last_`
    std::size_t num_well_ = 0;  // judgements in a row that found the camera of `held_` well
};

}  // namespace atrium::coherence
