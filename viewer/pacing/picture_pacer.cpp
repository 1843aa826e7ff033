#include "viewer/pacing/picture_pacer.hpp"

#include <algorithm>
#include <limits>

namespace atrium::viewer {
namespace {

using Clock = PicturePacer::Clock;

constexpr std::chrono::seconds kMemory{1};
constexpr std::size_t kMostArrivals = 96;
constexpr std::size_t kRegular = 4;  // arrivals within kMemory that make a site regular

// shares of the period
constexpr double kMostShift = 0.15;  // per picture; keeps the pictures even
constexpr double kLeastGain = 0.1;   // smaller gains do not move the phase
constexpr double kMostEarly = 0.25;  // earliest begin before the end of the period
// backward step that is better than nearly a whole period forward
constexpr double kStepBack = 0.1;
// more pictures than the period allows, so the phase can move both ways
constexpr double kMoreOften = 0.02;

Clock::duration part(Clock::duration period, double share) {
    return std::chrono::duration_cast<Clock::duration>(share * period);
}

}  // namespace

PicturePacer::PicturePacer(Clock::duration period, bool follows_people)
    : period_(period), follows_people_(follows_people) {}

void PicturePacer::set_period(Clock::duration period) {
    if (period == period_) return;
    period_ = period;
    shift_ = saved_ = Clock::duration(0);
}

void PicturePacer::forget_old(Clock::time_point now) {
    while (!arrivals_.empty() &&
           (arrivals_.size() > kMostArrivals || now - arrivals_.front().at > kMemory)) {
        const auto found = num_recent_.find(arrivals_.front().site);
        if (--found->second == 0) num_recent_.erase(found);
        arrivals_.pop_front();
    }
}

void PicturePacer::ready(const std::string& site, Clock::time_point at) {
    if (!follows_people_) return;
    arrivals_.push_back({site, at});
    ++num_recent_[site];
    waiting_.insert_or_assign(site, at);
    forget_old(at);
}

void PicturePacer::began(Clock::time_point at) {
    if (has_begun_)
        saved_ = std::clamp(
            saved_ + (at - began_) - part(period_, 1.0 - kMoreOften), Clock::duration(0), period_);
    has_begun_ = true;
    began_ = at;
    forget_old(at);
    waiting_.clear();
    shift_ = shift(at);
}

Clock::duration PicturePacer::shift(Clock::time_point begin) const {
    const bool is_regular =
        std::ranges::any_of(num_recent_, [](const auto& site) { return site.second >= kRegular; });
    if (!is_regular) return Clock::duration(0);
    // mean wait for a picture that begins `phase` after `begin`, modulo the period
    const auto mean_wait = [&](Clock::duration phase) {
        double sum = 0.0;
        for (const Arrival& arrival : arrivals_) {
            const auto wait = (begin + phase - arrival.at) % period_;
            sum += static_cast<double>((wait.count() < 0 ? wait + period_ : wait).count());
        }
        return sum / static_cast<double>(arrivals_.size());
    };
    // the minimum lies at the phase of an arrival
    double least = std::numeric_limits<double>::infinity();
    Clock::duration best(0);
    for (const Arrival& arrival : arrivals_) {
        Clock::duration phase = (arrival.at - begin) % period_;
        if (phase.count() < 0) phase += period_;
        const double wait = mean_wait(phase);
        if (wait >= least) continue;
        least = wait;
        best = phase;
    }
    const double gain = mean_wait(Clock::duration(0)) - least;
    if (gain < kLeastGain * static_cast<double>(period_.count())) return Clock::duration(0);
    // backward is shorter, but slow unless pictures were late before
    const Clock::duration back = period_ - best;
    if (back <= std::max(saved_, part(period_, kStepBack))) best = -back;
    return std::clamp(best, -part(period_, kMostShift), part(period_, kMostShift));
}

bool PicturePacer::is_everybody_ready() const {
    bool is_anybody = false;
    for (const auto& [site, num] : num_recent_) {
        if (num < kRegular) continue;
        if (!waiting_.contains(site)) return false;
        is_anybody = true;
    }
    return is_anybody;
}

Clock::time_point PicturePacer::due() const {
    if (!has_begun_) return {};
    const Clock::duration early = std::min(saved_, part(period_, kMostEarly));
    const Clock::time_point earliest = began_ + period_ - early;
    // while the phase moves later, people who wait do not pull it back
    if (shift_ <= Clock::duration(0) && is_everybody_ready()) return earliest;
    return std::max(began_ + period_ + shift_, earliest);
}

}  // namespace atrium::viewer
