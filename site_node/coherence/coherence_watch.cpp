#include "site_node/coherence/coherence_watch.hpp"

#include <algorithm>

namespace atrium::coherence {
namespace {

constexpr double kAsWell = 1.5;  // of the errors of all

// A rig is also called coherent if a second fault hides the first one, or if nothing is known of
// the camera any more.
bool is_well(const Report& report, std::size_t camera) {
    if (report.verdict != Verdict::kCoherent) return false;
    if (camera >= report.cameras.size()) return true;  // no camera was to blame
    const CameraCoherence& its = report.cameras[camera];
    return its.num_tangencies >= Coherence::kLeastTangencies &&
           its.rms_px <= std::max(Coherence::kLeastEffect_px, kAsWell * report.rms_px);
}

// Large enough errors that no camera is to blame for.
bool may_be_lenses(const Report& report) {
    return (report.verdict == Verdict::kCoherent || report.verdict == Verdict::kIncoherent) &&
           report.rms_px >= kDoubtful_px;
}

}  // namespace

std::optional<CoherenceWatch::Judgement> CoherenceWatch::look(const Sight& sight,
                                                              Clock::time_point now) {
    has_used_last_ = coherence_.add(sight);
    ++num_looks_;
    if (last_judgement_ && now - *last_judgement_ < kJudgementPeriod) return std::nullopt;
    last_judgement_ = now;
    Judgement judgement{.report = coherence_.judge(), .recovered = {}};
    try_lenses(judgement.report, now);
    settle(judgement, now);
    return judgement;
}

CoherenceWatch::Judgement CoherenceWatch::finish() {
    Judgement judgement{.report = coherence_.judge(), .recovered = {}};
    Report& report = judgement.report;
    if (held_) {
        tell_held(report);
    } else if (may_be_lenses(report) && !lenses_tried_at_ &&
               (report.lenses = coherence_.other_lenses())) {
        report.verdict = Verdict::kLenses;
        judgement.is_told = true;
    }
    return judgement;
}

void CoherenceWatch::tell_held(Report& report) const {
    report.verdict = held_->verdict;
    report.lenses = held_->lenses;
    report.fault.reset();
    if (held_->fault.camera != kNoCamera) report.fault = held_->fault;
}

void CoherenceWatch::try_lenses(Report& report, Clock::time_point now) {
    const bool is_doubtful = may_be_lenses(report);
    num_doubtful_ = is_doubtful ? num_doubtful_ + 1 : 0;
    num_fitting_ = is_doubtful ? 0 : num_fitting_ + 1;
    if (num_fitting_ >= kInARow) lenses_.reset();
    if (num_doubtful_ >= kInARow && (!lenses_tried_at_ || now - *lenses_tried_at_ >= kLensPeriod)) {
        lenses_ = coherence_.other_lenses();
        lenses_tried_at_ = now;
    }
    if (!is_doubtful || !lenses_) return;
    report.verdict = Verdict::kLenses;
    report.lenses = lenses_;
}

void CoherenceWatch::settle(Judgement& judgement, Clock::time_point now) {
    Report& report = judgement.report;
    std::optional<Key> found;
    if (report.fault) found = Key(report.verdict, report.fault->camera);
    const bool blames_one = held_ && held_->fault.camera != kNoCamera;
    const bool has_no_camera =
        report.verdict == Verdict::kIncoherent || report.verdict == Verdict::kLenses;
    if (has_no_camera && !blames_one) found = Key(report.verdict, kNoCamera);
    const bool is_held = held_ && found == held_->key();
    num_last_ = found == last_ ? num_last_ + 1 : 1;
    last_ = found;
    // errors lasted before other lenses were tried
    const bool is_certain = num_last_ >= kInARow || report.verdict == Verdict::kLenses;
    if (found && (is_held || is_certain)) {
        if (blames_one && held_->fault.camera != found->second)
            judgement.recovered = held_->fault.camera;
        held_ = {report.verdict, report.fault.value_or(NamedFault{}), report.lenses};
        held_->fault.camera = found->second;
        judgement.is_told = found != told_ || now - told_at_ >= kRepeat;
    }
    if (judgement.is_told) {
        told_ = found;
        told_at_ = now;
    }
    num_well_ = held_ && is_well(report, held_->fault.camera) ? num_well_ + 1 : 0;
    if (num_well_ >= kInARow) {
        if (held_->fault.camera != kNoCamera) judgement.recovered = held_->fault.camera;
        held_.reset();
        told_.reset();
        num_well_ = 0;
    }
    if (held_) {
        tell_held(report);
    } else if (found) {  // not often enough
        report.verdict = settled_;
        report.fault.reset();
    }
    settled_ = report.verdict;
}

}  // namespace atrium::coherence
