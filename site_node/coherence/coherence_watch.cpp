#include "site_node/coherence/coherence_watch.hpp"

namespace atrium::coherence {

std::optional<Report> CoherenceWatch::look(const Sight& sight, Clock::time_point now) {
    coherence_.add(sight);
    ++num_looks_;
    if (last_judgement_ && now - *last_judgement_ < kJudgementPeriod) return std::nullopt;
    last_judgement_ = now;
    Report report = coherence_.judge();
    std::optional<Key> found;
    if (report.fault) found = Key(report.verdict, report.fault->camera);
    const bool is_again = found && found == last_;
    last_ = found;
    if (!is_again || (found == told_ && now - told_at_ < kRepeat)) return std::nullopt;
    told_ = found;
    told_at_ = now;
    return report;
}

}  // namespace atrium::coherence
