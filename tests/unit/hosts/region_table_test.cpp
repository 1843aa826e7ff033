#include "site_node/hosts/region_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace atrium::hosts {
namespace {

using bus::HostState;
using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr std::chrono::nanoseconds kRegionPeriod = 20ms;

// Two hosts whose answers take as long as the test says.
class RegionTableTest : public testing::Test {
protected:
    // One order, answered after the delays; nullopt: not at all. Returns how long it waited.
    std::chrono::nanoseconds order(std::optional<std::chrono::nanoseconds> first,
                                   std::optional<std::chrono::nanoseconds> second) {
        const auto begin = now_;
        table_.begin(++frame_,
                     {first.has_value() || is_there_[0], second.has_value() || is_there_[1]},
                     now_);
        const std::uint64_t frame = frame_;
        for (std::size_t host = 0; host < 2; ++host) {
            if (const auto delay = host == 0 ? first : second)
                coming_.emplace(begin + *delay, std::pair(host, frame));
        }
        while (table_.waits_for_any() && now_ < table_.deadline()) {
            if (coming_.empty() || coming_.begin()->first > table_.deadline()) {
                now_ = table_.deadline();
                break;
            }
            arrive();
        }
        table_.end(now_);
        for (const HostEvent& event : table_.take_events()) log_ += event.line + "\n";
        const auto waited = now_ - begin;
        now_ = std::max(now_, begin + kRegionPeriod);
        while (!coming_.empty() && coming_.begin()->first <= now_) arrive();
        return waited;
    }
    void arrive() {
        const auto [time, what] = *coming_.begin();
        coming_.erase(coming_.begin());
        now_ = std::max(now_, time);
        table_.answered(what.first, what.second, now_);
    }
    HostState state(std::size_t host) const { return table_.statuses(now_)[host].state; }

    RegionTable table_{{{"east", {0}}, {"west", {1, 2}}}, kRegionPeriod};
    std::array<bool, 2> is_there_{};
    RegionTable::Time now_{1000s};
    std::uint64_t frame_ = 0;
    std::multimap<RegionTable::Time, std::pair<std::size_t, std::uint64_t>> coming_;
    std::string log_;
};

TEST_F(RegionTableTest, WaitsForAllHostsFromTheFirstOrderOn) {
    EXPECT_EQ(order(5ms, 9ms), 9ms);
    EXPECT_EQ(order(12ms, 9ms), 12ms);
    EXPECT_EQ(state(0), HostState::kInUse);
    EXPECT_EQ(state(1), HostState::kInUse);
    EXPECT_THAT(log_, HasSubstr("host_in_use host=west regions=2"));
    EXPECT_EQ(table_.statuses(now_)[1].num_regions, 2u);
    EXPECT_EQ(table_.statuses(now_)[1].num_left_out, 0u);
}

TEST_F(RegionTableTest, AHostThatDiesCostsOneWait) {
    order(5ms, 5ms);
    is_there_[1] = true;  // DDS needs a second to see that it is gone
    EXPECT_EQ(order(5ms, {}), 250ms);
    EXPECT_THAT(log_, HasSubstr("host_left_out host=west regions=2 reason=\"nothing comes"));
    for (int i = 0; i < 20; ++i) EXPECT_EQ(order(5ms, {}), 5ms);
    EXPECT_EQ(state(1), HostState::kMissing);
    is_there_[1] = false;
    EXPECT_EQ(order(5ms, {}), 5ms);
    EXPECT_EQ(state(1), HostState::kMissing);
    EXPECT_THAT(log_, HasSubstr("host_left_out host=west regions=2 reason=\"nothing comes"));
    EXPECT_EQ(table_.statuses(now_)[1].num_left_out, 22u);
    // found again: waited for at once
    EXPECT_EQ(order(5ms, 30ms), 30ms);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(RegionTableTest, ASlowHostIsLeftOutUntilTenAnswersAreInTime) {
    order(5ms, 5ms);
    is_there_[1] = true;
    for (int i = 0; i < 100; ++i) order(5ms, 300ms);
    EXPECT_EQ(state(1), HostState::kLate);
    EXPECT_THAT(log_, HasSubstr("its meshes come more than 250 ms after"));
    while (!coming_.empty()) arrive();
    for (int i = 0; i < 9; ++i) order(5ms, 5ms);
    EXPECT_EQ(state(1), HostState::kLate);
    order(5ms, 5ms);
    EXPECT_EQ(order(5ms, 9ms), 9ms);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(RegionTableTest, AHostThatIsFoundButNeverAnswersCostsOneWait) {
    is_there_ = {true, true};
    EXPECT_EQ(order({}, 5ms), 250ms);
    for (int i = 0; i < 200; ++i) EXPECT_EQ(order({}, 5ms), 5ms);
    EXPECT_THAT(log_, HasSubstr("host_left_out host=east"));
}

TEST_F(RegionTableTest, AHostWithAnotherRigIsNamedAndNobodyWaitsForIt) {
    order(5ms, 5ms);
    table_.begin(++frame_, {true, true}, now_);
    table_.answered(0, frame_, now_);
    table_.refused(1, now_);
    EXPECT_FALSE(table_.waits_for_any());
    table_.end(now_);
    EXPECT_EQ(state(1), HostState::kOtherRig);
    EXPECT_THAT(table_.why_without_answer(1), HasSubstr("rig"));
    EXPECT_EQ(table_.statuses(now_)[1].num_left_out, 1u);
    EXPECT_EQ(order(5ms, {}), 5ms);
    EXPECT_THAT(log_, HasSubstr("host_left_out host=west regions=2 reason=\"its rig, [hull]"));
    // started anew with the right file
    order(5ms, 9ms);
    EXPECT_EQ(state(1), HostState::kInUse);
    EXPECT_EQ(order(5ms, 9ms), 9ms);
}

TEST_F(RegionTableTest, AHostThatIsOverdueIsShownAsMissing) {
    order(5ms, 5ms);
    table_.begin(++frame_, {true, true}, now_);
    table_.answered(0, frame_, now_);
    now_ += 120ms;
    EXPECT_EQ(state(1), HostState::kInUse);
    now_ += 20ms;
    EXPECT_EQ(state(1), HostState::kMissing);
    EXPECT_EQ(state(0), HostState::kInUse);
    table_.answered(1, frame_, now_);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(RegionTableTest, AnswersToUnknownOrdersCountForNothing) {
    table_.begin(7, {true, true}, now_);
    EXPECT_FALSE(table_.answered(0, 3, now_));
    EXPECT_TRUE(table_.waits_for(0));
    EXPECT_TRUE(table_.answered(0, 7, now_));
    EXPECT_FALSE(table_.waits_for(0));
}

TEST_F(RegionTableTest, NobodyWaitsForAnOrderThatDidNotLeave) {
    order(5ms, 5ms);
    table_.begin(++frame_, {true, true}, now_);
    table_.not_sent(1);
    EXPECT_TRUE(table_.waits_for(0));
    EXPECT_FALSE(table_.waits_for(1));
    table_.answered(0, frame_, now_ + 5ms);
    EXPECT_FALSE(table_.waits_for_any());
    table_.end(now_ + 5ms);
    EXPECT_EQ(state(1), HostState::kInUse);  // it is not its fault
    EXPECT_EQ(table_.statuses(now_)[1].num_left_out, 1u);
}

// Whatever hosts do, a metaframe waits for 250 ms at most, and for a host that is silent only once.
TEST_F(RegionTableTest, NoHostHoldsTheSiteUp) {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        std::mt19937 random(seed);
        table_ = RegionTable({{"east", {0}}, {"west", {1, 2}}}, kRegionPeriod);
        coming_.clear();
        int num_waits = 0;
        int num_changes = 0;
        std::array<int, 2> mode{};  // 0: quick, 1: silent, 2: slow
        for (int i = 0; i < 300; ++i) {
            if (random() % 30 == 0) {
                mode[random() % 2] = static_cast<int>(random() % 3);
                ++num_changes;
            }
            const auto delay = [&](int of) -> std::optional<std::chrono::nanoseconds> {
                if (of == 1) return std::nullopt;
                return std::chrono::milliseconds(of == 0 ? random() % 18 : 260 + random() % 400);
            };
            is_there_ = {random() % 50 != 0, random() % 50 != 0};
            const auto waited = order(delay(mode[0]), delay(mode[1]));
            ASSERT_LE(waited, 250ms) << seed;
            if (waited > kRegionPeriod)
                ++num_waits;
            else
                ASSERT_LE(waited, kRegionPeriod);
        }
        // each change, and each time that DDS loses and finds a host, costs two waits at most
        EXPECT_LE(num_waits, 2 * (num_changes + 30)) << seed;
    }
}

}  // namespace
}  // namespace atrium::hosts
