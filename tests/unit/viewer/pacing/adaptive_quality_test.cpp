#include "viewer/pacing/adaptive_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace atrium::viewer {
namespace {

using namespace std::chrono_literals;
using Clock = AdaptiveQuality::Clock;

const Clock::time_point kQualityBegin{1000s};

Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// A simulated machine on which a picture takes `busy_s`.
struct Machine {
    std::function<double(const PictureQuality&)> busy_s;
    double late_s = 0.0;
    Clock::time_point now = kQualityBegin;
    int num_changes = 0;

    void run(AdaptiveQuality& sut, double length_s) {
        const Clock::time_point end = now + seconds(length_s);
        while (now < end) {
            const double busy = busy_s(sut.quality());
            const Clock::time_point ended = now + seconds(busy);
            if (sut.add({ended, seconds(busy), seconds(late_s)})) ++num_changes;
            now = std::max(ended, now + seconds(1.0 / sut.quality().max_fps));
        }
    }
};

// Cost of a picture drawn in software: one part per pixel, one part for the scene.
double picture_s(const PictureQuality& quality, double full_s) {
    return full_s * ((quality.has_shadows ? 0.3 : 0.15) + 0.7 * quality.scale * quality.scale);
}

TEST(AdaptiveQuality, ReducesRateThenResolutionThenShadows) {
    AdaptiveQuality sut({.max_fps = 60.0});
    std::vector<PictureQuality> levels{sut.quality()};
    // slightly too expensive at each level in turn
    Machine machine{[](const PictureQuality& quality) { return 0.95 / quality.max_fps; }};
    while (sut.level() + 1 < sut.num_levels()) {
        const std::size_t before = sut.level();
        while (sut.level() == before) machine.run(sut, 0.02);
        levels.push_back(sut.quality());
    }
    const std::vector<PictureQuality> expected{{60.0, 1.0, true},
                                               {30.0, 1.0, true},
                                               {20.0, 1.0, true},
                                               {15.0, 1.0, true},
                                               {15.0, 0.75, true},
                                               {15.0, 0.5, true},
                                               {15.0, 0.5, false}};
    EXPECT_EQ(levels, expected);
    machine.run(sut, 60.0);
    EXPECT_EQ(sut.level() + 1, sut.num_levels()) << "the last level must be reached";
}

TEST(AdaptiveQuality, FindsALevelWithHeadroomWithinSecondsAndStays) {
    for (double full_ms = 5.0; full_ms < 250.0; full_ms *= 1.13) {
        AdaptiveQuality sut({.max_fps = 30.0});
        Machine machine{[&](const PictureQuality& q) { return picture_s(q, 1e-3 * full_ms); }};
        machine.run(sut, 12.0);
        const double load = machine.busy_s(sut.quality()) * sut.quality().max_fps;
        EXPECT_TRUE(load <= 0.9 || sut.level() + 1 == sut.num_levels()) << full_ms;
        EXPECT_TRUE(sut.level() == 0 || full_ms > 29.0) << full_ms;
        machine.num_changes = 0;
        machine.run(sut, 600.0);
        EXPECT_EQ(machine.num_changes, 0) << full_ms << " ms: it oscillates";
    }
}

TEST(AdaptiveQuality, DoesNotOscillateWithNoiseOrWrongPredictions) {
    std::mt19937 random(5);
    std::lognormal_distribution<double> noise(0.0, 0.35);
    for (const double full_ms : {12.0, 24.0, 30.0, 45.0, 60.0, 90.0}) {
        AdaptiveQuality sut({.max_fps = 30.0});
        Machine machine{
            [&](const PictureQuality& q) { return noise(random) * picture_s(q, 1e-3 * full_ms); }};
        machine.run(sut, 600.0);
        EXPECT_LE(machine.num_changes, 14) << full_ms;
    }
    // a cliff: more than 16 pictures/s cost everything, which no measurement predicts
    AdaptiveQuality sut({.max_fps = 30.0});
    Machine cliff{[](const PictureQuality& q) { return q.max_fps > 16.0 ? 0.2 : 0.01; }};
    cliff.run(sut, 600.0);
    // it retries after 2, 4, 8, ... 64 s
    EXPECT_LE(cliff.num_changes, 2 * 15);
    cliff.num_changes = 0;
    cliff.run(sut, 600.0);
    EXPECT_EQ(cliff.num_changes, 2 * 9) << "up and down again every 64 s";
}

TEST(AdaptiveQuality, RecoversWhenThereIsHeadroom) {
    for (const double load_ms : {45.0, 90.0, 400.0}) {
        AdaptiveQuality sut({.max_fps = 30.0});
        double full_s = 1e-3 * load_ms;
        Machine machine{[&](const PictureQuality& q) { return picture_s(q, full_s); }};
        machine.run(sut, 20.0);
        EXPECT_GT(sut.level(), 0U) << load_ms;
        full_s = 0.01;
        machine.run(sut, 20.0);
        EXPECT_EQ(sut.level(), 0U) << load_ms;
        EXPECT_EQ(sut.quality(), PictureQuality{});
        EXPECT_EQ(sut.reason(), "time_to_spare");
    }
}

TEST(AdaptiveQuality, IgnoresAFewLongPictures) {
    AdaptiveQuality sut({.max_fps = 30.0});
    int num = 0;
    Machine machine{[&](const PictureQuality&) { return ++num % 4 == 0 ? 0.2 : 0.012; }};
    machine.run(sut, 60.0);
    EXPECT_EQ(machine.num_changes, 0);
}

TEST(AdaptiveQuality, LateDecodingReducesDrawing) {
    AdaptiveQuality sut({.max_fps = 30.0});
    Machine machine{[](const PictureQuality&) { return 0.01; }, 0.2};
    machine.run(sut, 0.6);
    EXPECT_EQ(sut.level(), 1U);
    EXPECT_EQ(sut.reason(), "decoding");
    machine.late_s = 0.08;  // neither late nor early: the level stays
    machine.run(sut, 1.0);
    machine.num_changes = 0;
    machine.run(sut, 60.0);
    EXPECT_EQ(machine.num_changes, 0);
    machine.late_s = 0.01;
    machine.run(sut, 30.0);
    EXPECT_EQ(sut.level(), 0U);
}

TEST(AdaptiveQuality, NeverExceedsTheBestQuality) {
    AdaptiveQuality sut({.max_fps = 10.0, .scale = 0.6, .has_shadows = false});
    Machine machine{[](const PictureQuality&) { return 1.0; }};
    machine.run(sut, 60.0);
    EXPECT_EQ(sut.quality(), (PictureQuality{10.0, 0.5, false}));
    machine.busy_s = [](const PictureQuality&) { return 0.001; };
    machine.run(sut, 60.0);
    EXPECT_EQ(sut.quality(), (PictureQuality{10.0, 0.6, false}));
    EXPECT_EQ(sut.level(), 0U);
}

TEST(AdaptiveQuality, IsDescribedForLogAndUser) {
    const PictureQuality reduced{.max_fps = 15.0, .scale = 0.75, .has_shadows = false};
    EXPECT_EQ(to_string(reduced), "fps=15 scale=0.75 shadows=off");
    EXPECT_EQ(describe(reduced), "15 pictures/s, 75 % of the resolution, no shadows");
    EXPECT_EQ(describe({.max_fps = 30.0}), "30 pictures/s");
}

}  // namespace
}  // namespace atrium::viewer
