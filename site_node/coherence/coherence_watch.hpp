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
/// told when it begins, and every ten minutes.
///
/// If as many judgements in a row find errors of kDoubtful_px and no camera to blame, it tries
/// whether other lenses explain them, and again every kLensPeriod: then kLenses is the fault.
///
/// No threads; not thread-safe.
class CoherenceWatch {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kJudgementPeriod{2};
    static constexpr std::size_t kInARow = 3;
    static constexpr std::chrono::minutes kRepeat{10};
    static constexpr std::chrono::minutes kLensPeriod{5};

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
    /// The last judgement of a run. Tries other lenses if the run was too short for it.
    Judgement finish();
    std::size_t num_looks() const { return num_looks_; }
    /// True if the last instant counts for judgements: somebody moved.
    bool has_used_last() const { return has_used_last_; }

private:
    // One fault: its camera, or kNoCamera of an incoherent rig.
    using Key = std::pair<Verdict, std::size_t>;
    static constexpr std::size_t kNoCamera = SIZE_MAX;

    // The fault that holds.
    struct Held {
        Verdict verdict;
        NamedFault fault;  // `camera` may be kNoCamera
        std::optional<OtherLenses> lenses;
        Key key() const { return {verdict, fault.camera}; }
    };

    void tell_held(Report& report) const;
    void try_lenses(Report& report, Clock::time_point now);
    void settle(Judgement& judgement, Clock::time_point now);

    Coherence coherence_;
    std::size_t num_looks_ = 0;
    bool has_used_last_ = false;
    std::optional<Clock::time_point> last_judgement_;
    std::optional<Key> last_, told_;
    Clock::time_point told_at_{};
    std::optional<Held> held_;
    Verdict settled_ = Verdict::kTooLittle;
    std::optional<OtherLenses> lenses_;  // that explain the errors
    std::optional<Clock::time_point> lenses_tried_at_;
    std::size_t num_doubtful_ = 0;  // judgements in a row with errors, and no camera to blame
    std::size_t num_fitting_ = 0;   // judgements in a row without
    std::size_t num_last_ = 0;      // judgements in a row that found `last_`
    std::size_t num_well_ = 0;      // judgements in a row that found the camera of `held_` well
};

}  // namespace atrium::coherence
