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

}  // namespace

std::optional<CoherenceWatch::Judgement> CoherenceWatch::look(const Sight& sight,
                                                              Clock::time_point now) {
    has_used_last_ = coherence_.add(sight);
    ++num_looks_;
    if (last_judgement_ && now - *last_judgement_ < kJudgementPeriod) return std::nullopt;
    last_judgement_ = now;
    Judgement judgement{.report = coherence_.judge(), .recovered = {}};
    settle(judgement, now);
    return judgement;
}

void CoherenceWatch::settle(Judgement& judgement, Clock::time_point now) {
    Report& report = judgement.report;
    std::optional<Key> found;
    if (report.fault) found = Key(report.verdict, report.fault->camera);
    const bool blames_one = held_ && held_->second.camera != kNoCamera;
    if (report.verdict == Verdict::kIncoherent && !blames_one)
        found = Key(Verdict::kIncoherent, kNoCamera);
    const bool is_held = held_ && found == Key(held_->first, held_->second.camera);
    num_last_ = found == last_ ? num_last_ + 1 : 1;
    last_ = found;
    if (found && (is_held || num_last_ >= kInARow)) {
        if (blames_one && held_->second.camera != found->second)
            judgement.recovered = held_->second.camera;
        held_ = {report.verdict, report.fault.value_or(NamedFault{})};
        held_->second.camera = found->second;
        judgement.is_told = found != told_ || now - told_at_ >= kRepeat;
    }
    if (judgement.is_told) {
        told_ = found;
        told_at_ = now;
    }
    num_well_ = held_ && is_well(report, held_->second.camera) ? num_well_ + 1 : 0;
    if (num_well_ >= kInARow) {
        if (held_->second.camera != kNoCamera) judgement.recovered = held_->second.camera;
        held_.reset();
        told_.reset();
        num_well_ = 0;
    }
    if (held_) {
        report.verdict = held_->first;
        report.fault.reset();
        if (held_->second.camera != kNoCamera) report.fault = held_->second;
    } else if (found) {  // not often enough
        report.verdict = settled_;
        report.fault.reset();
    }
    settled_ = report.verdict;
}

}  // namespace atrium::coherence
