#include "site_node/stream/rate_controller.hpp"

#include "time_at.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace atrium::stream {
namespace {

using std::chrono::milliseconds;

TEST(Ladder, LowersFirstQualityThenResolutionThenRate) {
    const std::vector<Level> ladder = make_ladder(85);
    EXPECT_EQ(ladder.front(), (Level{85, 1, 1}));
    for (std::size_t i = 1; i < ladder.size(); ++i) {
        const Level& before = ladder[i - 1];
        const Level& after = ladder[i];
        EXPECT_LE(before.send_every, after.send_every);
        if (before.send_every != after.send_every) continue;
        EXPECT_LE(before.colour_divisor, after.colour_divisor);
        if (before.colour_divisor == after.colour_divisor) {
            EXPECT_GT(before.jpeg_quality, after.jpeg_quality);
        }
    }
    EXPECT_EQ(ladder.back().send_every, 6);
}

TEST(Ladder, BeginsWithTheConfiguredQuality) {
    for (int quality = 1; quality <= 100; ++quality) {
        const std::vector<Level> ladder = make_ladder(quality);
        EXPECT_EQ(ladder.front(), (Level{quality, 1, 1}));
        for (const Level& level : ladder) EXPECT_LE(level.jpeg_quality, quality);
    }
}

TEST(SizeModel, LearnsTheSizeOfALevel) {
    const std::vector<Level> ladder = make_ladder(85);
    SizeModel sizes(ladder);
    EXPECT_EQ(sizes.frame_bytes(0), 0.0);
    for (int i = 0; i < 20; ++i) sizes.add(0, {10'000, 100'000});
    EXPECT_NEAR(sizes.frame_bytes(0), 110'000, 1);
    // level 2 takes 0.3, not the first estimate of 0.62
    for (int i = 0; i < 20; ++i) sizes.add(2, {10'000, 30'000});
    EXPECT_NEAR(sizes.frame_bytes(2), 40'000, 1'000);
    EXPECT_NEAR(sizes.frame_bytes(0), 110'000, 8'000);
    for (int i = 0; i < 20; ++i) sizes.add(0, {10'000, 100'000});
    EXPECT_NEAR(sizes.frame_bytes(2), 40'000, 2'000);
}

TEST(SizeModel, ForgetsAnEmptyRoomAtOnce) {
    SizeModel sizes(make_ladder(85));
    sizes.add(0, {10'000, 100'000});
    for (int i = 0; i < 100; ++i) sizes.add(0, {0, 0});
    EXPECT_NEAR(sizes.frame_bytes(0), 110'000, 1);
}

/// Offers metaframes at 30 Hz and codes the admitted ones.
class Controlled : public testing::Test {
protected:
    // Bytes of colour at a level, for 100 kB at the best level.
    double colour(std::size_t level) const {
        const Level& chosen = controller_.ladder()[level];
        return 100e3 * chosen.jpeg_quality / 85.0 * (chosen.colour_divisor == 2 ? 0.28 : 1.0);
    }
    void run(double seconds) {
        for (const double end_s = now_s_ + seconds; now_s_ < end_s; now_s_ += 1.0 / 30.0) {
            const std::size_t before = controller_.level();
            const auto level = controller_.offer(at(now_s_));
            num_steps_ += controller_.level() != before ? 1 : 0;
            if (!level) continue;
            const double noise =
                std::uniform_real_distribution(1.0 - noise_, 1.0 + noise_)(random_);
            const FrameBytes bytes{fixed_, static_cast<std::size_t>(noise * colour(*level))};
            controller_.coded(*level, bytes, at(now_s_));
            sent_.emplace_back(now_s_, 8.0 * static_cast<double>(bytes.fixed + bytes.colour));
        }
    }
    double rate_bit_per_s(double from_s) const {
        double bits = 0.0;
        for (const auto& [time_s, size] : sent_) bits += time_s >= from_s ? size : 0.0;
        return bits / (now_s_ - from_s);
    }
    const Level& level() const { return controller_.ladder()[controller_.level()]; }

    RateController controller_{85, 30.0};
    std::mt19937_64 random_{5};
    std::size_t fixed_ = 12'000;
    double noise_ = 0.05;
    double now_s_ = 0.0;
    int num_steps_ = 0;
    std::vector<std::pair<double, double>> sent_;  // time [s], size [bit]
};

TEST_F(Controlled, SendsEverythingAtBestQualityWithoutACap) {
    run(3.0);
    EXPECT_EQ(num_steps_, 0);
    EXPECT_GE(sent_.size(), 90u);
    EXPECT_EQ(controller_.next_bit_per_s(), 0.0);
}

TEST_F(Controlled, StepsDownAtOnceAndNoFartherThanNecessary) {
    run(2.0);
    controller_.set_cap({20e6, 20e6});
    run(0.05);
    EXPECT_EQ(num_steps_, 1);
    EXPECT_EQ(level().colour_divisor, 1);
    EXPECT_EQ(level().send_every, 1);
    run(10.0);
    EXPECT_GT(rate_bit_per_s(4.0), 0.8 * 20e6);
    EXPECT_LE(rate_bit_per_s(4.0), 20e6);
}

TEST_F(Controlled, KnowsThatAMeshDoesNotShrink) {
    fixed_ = 20'000;  // 4.8 Mbit/s at 30 Hz: no quality goes below 4
    run(2.0);
    controller_.set_cap({4e6, 4e6});
    run(5.0);
    EXPECT_GE(level().send_every, 2);
    EXPECT_LE(rate_bit_per_s(2.5), 4e6);
    EXPECT_GT(rate_bit_per_s(2.5), 0.6 * 4e6);
}

TEST_F(Controlled, AMetaframeThatIsNotSentGivesItsTurnToTheNext) {
    fixed_ = 20'000;
    run(2.0);
    controller_.set_cap({4e6, 4e6});
    run(5.0);
    ASSERT_GE(level().send_every, 2);
    const auto offer = [&] { return controller_.offer(at(now_s_ += 1.0 / 30.0)).has_value(); };
    int num_offers = 0;
    while (!offer()) ASSERT_LT(++num_offers, 100);
    controller_.give_back();
    EXPECT_TRUE(offer());
    EXPECT_FALSE(offer()) << "its turn is over";
}

TEST_F(Controlled, RisesOnlyAfterAWhile) {
    controller_.set_cap({15e6, 15e6});
    run(5.0);
    const std::size_t low = controller_.level();
    ASSERT_GT(low, 0u);
    controller_.set_cap({});
    run(0.9);
    EXPECT_EQ(controller_.level(), low);
    run(0.2);
    EXPECT_EQ(controller_.level(), 0u);
}

// At caps near the size of a level, a controller would tend to oscillate.
TEST_F(Controlled, DoesNotOscillateAtAnyCap) {
    run(1.0);
    for (double cap_mbit = 2.0; cap_mbit < 30.0; cap_mbit += 0.5) {
        controller_.set_cap({1e6 * cap_mbit, 1e6 * cap_mbit});
        run(10.0);  // time to learn and settle
        const int before = num_steps_;
        run(30.0);
        EXPECT_LE(num_steps_ - before, 6) << cap_mbit << " Mbit/s";
    }
}

TEST_F(Controlled, SendsAtMostTheCapPlusOneFramePerSecond) {
    noise_ = 0.6;  // unpredictable sizes
    const double cap_bit_per_s = 6e6;
    controller_.set_cap({cap_bit_per_s, cap_bit_per_s});
    run(60.0);
    ASSERT_GT(sent_.size(), 300u);
    for (std::size_t begin = 0; begin < sent_.size(); ++begin) {
        double bits = 0.0;
        double largest = 0.0;
        for (std::size_t i = begin; i < sent_.size() && sent_[i].first < sent_[begin].first + 1.0;
             ++i) {
            bits += sent_[i].second;
            largest = std::max(largest, sent_[i].second);
        }
        ASSERT_LE(bits, cap_bit_per_s + largest) << "from " << sent_[begin].first << " s";
    }
}

TEST_F(Controlled, SkipsFramesForAQueueButKeepsTheLevel) {
    controller_.set_cap({20e6, 20e6});
    run(5.0);
    const std::size_t before = controller_.level();
    controller_.set_cap({20e6, 5e6});
    run(1.0);
    EXPECT_EQ(controller_.level(), before);
    EXPECT_LE(rate_bit_per_s(now_s_ - 1.0), 5e6 + 8.0 * 120e3);
}

TEST_F(Controlled, SkipsNoFramesOfASlowSource) {
    // 10 Hz fit where 30 would not
    for (int i = 0; i < 100; ++i) {
        now_s_ += 0.1;
        controller_.set_cap({10e6, 10e6});
        if (const auto level = controller_.offer(at(now_s_)))
            controller_.coded(
                *level, {12'000, static_cast<std::size_t>(colour(*level))}, at(now_s_));
    }
    EXPECT_EQ(level().send_every, 1);
    EXPECT_LE(controller_.level(), 1u);
}

}  // namespace
}  // namespace atrium::stream
