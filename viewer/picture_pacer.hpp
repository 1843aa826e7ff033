#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Decides when the next picture begins.
///
/// Pictures follow each other at an even period. While people arrive regularly the phase of the
/// pictures moves, by a small part of the period per picture, to where people wait least: shortly
/// after most of them are ready. If somebody new of every regular site is ready early, the picture
/// begins at once. On average there are at most 2 % more pictures than the period allows: a picture
/// begins early only by as much as earlier ones began late. Has no clock: all times are given. Not
/// thread-safe.
class PicturePacer {
public:
    using Clock = std::chrono::steady_clock;

    /// `follows_people` false: the period alone counts, as for a display that keeps its own time.
    PicturePacer(Clock::duration period, bool follows_people);

    void set_period(Clock::duration period);
    Clock::duration period() const { return period_; }

    /// Somebody new of `site` became ready to be drawn.
    void ready(const std::string& site, Clock::time_point at);
    /// A picture of all who were ready begins.
    void began(Clock::time_point at);

    /// When the next picture begins, given who is ready so far. In the past: now.
    Clock::time_point due() const;

private:
    struct Arrival {
        std::string site;
        Clock::time_point at;
    };

    void forget_old(Clock::time_point now);
    /// How much later than one period after `begin` the next picture waits for people least.
    Clock::duration shift(Clock::time_point begin) const;
    bool is_everybody_ready() const;

    Clock::duration period_;
    bool follows_people_;
    Clock::time_point began_{};
    bool has_begun_ = false;
    Clock::duration shift_{0};      // of the next picture
    Clock::duration saved_{0};      // by which pictures began late, and may begin early
    std::deque<Arrival> arrivals_;  // of the last second, the oldest first
    std::map<std::string, std::size_t> num_recent_;     // arrivals of each site
    std::map<std::string, Clock::time_point> waiting_;  // ready since the last picture began
};

}  // namespace atrium::viewer
