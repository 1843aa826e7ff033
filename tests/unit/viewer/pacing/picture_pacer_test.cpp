#include "viewer/pacing/picture_pacer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using Clock = PicturePacer::Clock;

constexpr Clock::duration kPeriod = 33'333us;
const Clock::time_point kFirstPicture{1000s};

double ms(Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

struct Site {
    Clock::duration period = kPeriod;
    Clock::duration phase{0};
    Clock::duration jitter{0};  // each arrival is later by up to this
};

struct Paced {
    std::vector<double> intervals_ms;
    std::vector<double> waits_ms;  // of the drawn people
    double mean_wait_ms() const {
        double sum = 0.0;
        for (const double wait : waits_ms) sum += wait;
        return sum / static_cast<double>(waits_ms.size());
    }
    double longest_ms() const {
        return *std::max_element(intervals_ms.begin(), intervals_ms.end());
    }
    double shortest_ms() const {
        return *std::min_element(intervals_ms.begin(), intervals_ms.end());
    }
};

// A drawing thread that needs no time. The results omit the first two seconds.
Paced run(const std::vector<Site>& sites, PicturePacer& pacer, std::chrono::seconds length = 20s) {
    std::mt19937 random(7);
    std::vector<std::pair<Clock::time_point, std::string>> arrivals;
    for (std::size_t i = 0; i < sites.size(); ++i) {
        const Site& site = sites[i];
        for (auto at = kFirstPicture + site.phase; at < kFirstPicture + length; at += site.period) {
            const auto late = site.jitter.count() > 0 ? random() % site.jitter.count() : 0;
            arrivals.emplace_back(at + Clock::duration(late), "site " + std::to_string(i));
        }
    }
    std::sort(arrivals.begin(), arrivals.end());
    Paced result;
    std::map<std::string, Clock::time_point> waiting;
    auto next = arrivals.begin();
    auto now = kFirstPicture;
    auto last = now;
    while (now < kFirstPicture + length) {
        // waits like the drawing thread: until a picture is due or a person arrives
        while (now < pacer.due()) {
            if (next == arrivals.end() || next->first > pacer.due()) {
                now = pacer.due();
                break;
            }
            now = std::max(now, next->first);
            pacer.ready(next->second, next->first);
            waiting[next->second] = next->first;
            ++next;
        }
        pacer.began(now);
        if (now > kFirstPicture + 2s) {
            result.intervals_ms.push_back(ms(now - last));
            for (const auto& [site, since] : waiting) result.waits_ms.push_back(ms(now - since));
        }
        waiting.clear();
        last = now;
    }
    return result;
}

TEST(PicturePacer, KeepsAnEvenRateWithoutPeople) {
    PicturePacer sut(kPeriod, true);
    const Paced result = run({}, sut);
    EXPECT_EQ(result.longest_ms(), ms(kPeriod));
    EXPECT_EQ(result.shortest_ms(), ms(kPeriod));
}

TEST(PicturePacer, MovesItsPhaseUntilAPersonHardlyWaits) {
    for (int phase_ms = 0; phase_ms < 33; phase_ms += 3) {
        PicturePacer sut(kPeriod, true);
        const Paced result =
            run({{.phase = std::chrono::milliseconds(phase_ms), .jitter = 4ms}}, sut);
        EXPECT_LT(result.mean_wait_ms(), 5.0) << phase_ms;
        EXPECT_LT(result.longest_ms(), 1.3 * ms(kPeriod)) << phase_ms;
        EXPECT_GT(result.shortest_ms(), 0.6 * ms(kPeriod)) << phase_ms;
    }
}

TEST(PicturePacer, MakesNeitherOfTwoSitesWaitAWholePeriod) {
    for (const auto apart : {2ms, 8ms, 16ms, 25ms}) {
        PicturePacer sut(kPeriod, true);
        const Paced result = run({{.jitter = 3ms}, {.phase = apart, .jitter = 3ms}}, sut);
        // at best the picture begins with the later of the two nearest arrivals
        const double between_ms = std::min(ms(apart), ms(kPeriod - apart));
        EXPECT_LT(result.mean_wait_ms(), 0.5 * between_ms + 5.0) << ms(apart);
    }
}

TEST(PicturePacer, IsNoFasterThanAllowed) {
    std::mt19937 random(3);
    for (int i = 0; i < 30; ++i) {
        std::vector<Site> sites(1 + random() % 6);
        for (Site& site : sites) {
            site.period = std::chrono::milliseconds(2 + random() % 80);
            site.phase = std::chrono::milliseconds(random() % 100);
            site.jitter = std::chrono::milliseconds(random() % 30);
        }
        PicturePacer sut(kPeriod, true);
        const Paced result = run(sites, sut);
        const double mean_ms = 18'000.0 / static_cast<double>(result.intervals_ms.size());
        EXPECT_GT(mean_ms, 0.975 * ms(kPeriod)) << i;
        EXPECT_LT(mean_ms, 1.16 * ms(kPeriod)) << i;
        EXPECT_LT(result.longest_ms(), 1.2 * ms(kPeriod)) << i;
    }
}

TEST(PicturePacer, DoesNotDisturbADisplayWithItsOwnClock) {
    PicturePacer sut(kPeriod, false);
    const Paced result = run({{.phase = 10ms}}, sut);
    EXPECT_EQ(result.longest_ms(), ms(kPeriod));
    EXPECT_EQ(result.shortest_ms(), ms(kPeriod));
}

TEST(PicturePacer, DoesNotCatchUpWithABurstOfPictures) {
    PicturePacer sut(kPeriod, true);
    sut.began(kFirstPicture);
    sut.began(kFirstPicture + 10s);  // the machine stood still
    EXPECT_EQ(sut.due(), kFirstPicture + 10s + kPeriod);
}

TEST(PicturePacer, BeginsEarlyOnceEverybodyHasArrived) {
    PicturePacer sut(kPeriod, true);
    auto now = kFirstPicture;
    sut.began(now);
    for (int i = 0; i < 10; ++i) {
        now += kPeriod + 2ms;  // a little late each time
        sut.ready("a", now - 1ms);
        sut.ready("b", now - 1ms);
        sut.began(now);
    }
    const auto due = sut.due();
    sut.ready("a", now + 18ms);
    EXPECT_EQ(sut.due(), due) << "b is missing";
    sut.ready("b", now + 19ms);
    EXPECT_LT(sut.due(), now + kPeriod - 5ms);
}

}  // namespace
}  // namespace atrium::viewer
