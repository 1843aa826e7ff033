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
/// Pictures follow each other at an even period. While people arrive regularly, the phase of the
/// pictures moves by a small part of the period per picture, to the phase with the least waiting:
/// shortly after most people are ready. If every regular site has a new person early, the picture
/// begins at once. On average at most 2 % more pictures are drawn than the period allows: a picture
/// begins early only by as much as earlier ones began late. Has no clock: the caller passes all
/// times. Not thread-safe.
class PicturePacer {
public:
    using Clock = std::chrono::steady_clock;

    /// `follows_people` false: only the period counts, as for a display with its own timing.
    PicturePacer(Clock::duration period, bool follows_people);

    void set_period(Clock::duration period);
    Clock::duration period() const { return period_; }

    /// A new person of `site` became ready to draw.
    void ready(const std::string& site, Clock::time_point at);
    /// A picture with all ready people begins.
    void began(Clock::time_point at);

    /// Time at which the next picture begins, from what is known so far. A time in the past means
    /// now.
    Clock::time_point due() const;

private:
    struct Arrival {
        std::string site;
        Clock::time_point at;
    };

    void forget_old(Clock::time_point now);
    /// Offset from one period after `begin` at which people wait least for the next picture.
    Clock::duration shift(Clock::time_point begin) const;
    bool is_everybody_ready() const;

    Clock::duration period_;
    bool follows_people_;
    Clock::time_point began_{};
    bool has_begun_ = false;
    Clock::duration shift_{0};      // for the next picture
    Clock::duration saved_{0};      // total lateness, which early pictures may use up
    std::deque<Arrival> arrivals_;  // of the last second, oldest first
    std::map<std::string, std::size_t> num_recent_;     // arrivals per site
    std::map<std::string, Clock::time_point> waiting_;  // ready since the start of the last picture
};

}  // namespace atrium::viewer
