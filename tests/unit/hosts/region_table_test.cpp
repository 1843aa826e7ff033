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
constexpr std::int64_t kRun_ns = 1'700'000'000'000'000'000;

// Two hosts whose answers take as long as the test says.
class RegionTableTest : public testing::Test {
protected:
    // One order, answered after the delays; nullopt: not at all. Returns how long it waited.
    std::chrono::nanoseconds order(std::optional<std::chrono::nanoseconds> first,
                                   std::optional<std::chrono::nanoseconds> second) {
        const auto begin = now_;
        table_.begin(key(++frame_),
                     {first.has_value() || is_there_[0], second.has_value() || is_there_[1]},
                     now_);
        const std::uint64_t frame = frame_;
        for (std::size_t host = 0; host < 2; ++host) {
            if (const auto delay = host == 0 ? first : second)
                coming_.emplace(begin + *delay, std::pair(host, frame));
        }
        while (const auto until = table_.waits_until(now_)) {
            if (coming_.empty() || coming_.begin()->first > *until) {
                now_ = *until;
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
        table_.answered(what.first, key(what.second), now_);
    }
    // of a metaframe of the running model part
    bus::FrameKey key(std::uint64_t frame) const {
        return {frame, {kRun_ns + static_cast<std::int64_t>(frame)}};
    }
    std::vector<bus::HostStatus> statuses() const {
        return table_.statuses(std::vector<bool>(is_there_.begin(), is_there_.end()), now_);
    }
    bool waits() const { return table_.waits_until(now_).has_value(); }
    HostState state(std::size_t host) const { return statuses()[host].state; }

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
    EXPECT_EQ(statuses()[1].num_regions, 2u);
    EXPECT_EQ(statuses()[1].num_left_out, 0u);
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
    EXPECT_EQ(statuses()[1].num_left_out, 22u);
    // found again: waited for at once
    EXPECT_EQ(order(5ms, 30ms), 30ms);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(RegionTableTest, ASlowHostIsLeftOutUntilTenAnswersAreInTime) {
    order(5ms, 5ms);
    is_there_[1] = true;
    for (int i = 0; i < 100; ++i) order(5ms, 300ms);
    EXPECT_EQ(state(1), HostState::kLate);
    EXPECT_THAT(log_, HasSubstr("its meshes came more than 250 ms after"));
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
    table_.begin(key(++frame_), {true, true}, now_);
    table_.answered(0, key(frame_), now_);
    table_.refused(1, now_);
    EXPECT_FALSE(waits());
    table_.end(now_);
    EXPECT_EQ(state(1), HostState::kOtherRig);
    EXPECT_THAT(table_.why_without_answer(1), HasSubstr("rig"));
    EXPECT_EQ(statuses()[1].num_left_out, 1u);
    EXPECT_EQ(order(5ms, {}), 5ms);
    EXPECT_THAT(log_, HasSubstr("host_left_out host=west regions=2 reason=\"its rig, [hull]"));
    // started anew with the right file
    order(5ms, 9ms);
    EXPECT_EQ(state(1), HostState::kInUse);
    EXPECT_EQ(order(5ms, 9ms), 9ms);
}

TEST_F(RegionTableTest, AHostThatIsOverdueIsShownAsMissing) {
    order(5ms, 5ms);
    table_.begin(key(++frame_), {true, true}, now_);
    table_.answered(0, key(frame_), now_);
    now_ += 120ms;
    EXPECT_EQ(state(1), HostState::kInUse);
    now_ += 20ms;
    EXPECT_EQ(state(1), HostState::kMissing);
    EXPECT_EQ(state(0), HostState::kInUse);
    table_.answered(1, key(frame_), now_);
    EXPECT_EQ(state(1), HostState::kInUse);
}

TEST_F(RegionTableTest, AnswersToUnknownOrdersCountForNothing) {
    table_.begin(key(7), {true, false}, now_);
    EXPECT_FALSE(table_.answered(0, key(3), now_));
    // of the model part before this one, which counted as this one does
    EXPECT_FALSE(table_.answered(0, {7, {kRun_ns - 1}}, now_));
    EXPECT_TRUE(waits());
    EXPECT_TRUE(table_.answered(0, key(7), now_));
    EXPECT_FALSE(waits());
}

TEST_F(RegionTableTest, NobodyWaitsForAnOrderThatDidNotLeave) {
    order(5ms, 5ms);
    table_.begin(key(++frame_), {true, true}, now_);
    table_.not_sent(1);
    EXPECT_TRUE(waits());
    table_.answered(0, key(frame_), now_ + 5ms);
    EXPECT_FALSE(waits());
    table_.end(now_ + 5ms);
    EXPECT_EQ(state(1), HostState::kInUse);  // it is not its fault
    EXPECT_EQ(statuses()[1].num_left_out, 1u);
}

TEST_F(RegionTableTest, NobodyWaitsForAProgramThatEnds) {
    order(5ms, 5ms);
    table_.begin(key(++frame_), {true, true}, now_);
    table_.answered(0, key(frame_), now_);
    EXPECT_TRUE(waits());
    table_.gone(1, now_);
    EXPECT_FALSE(waits());
    table_.end(now_);
    EXPECT_EQ(state(1), HostState::kMissing);
    is_there_[1] = false;
    order(5ms, {});
    EXPECT_EQ(order(5ms, 30ms), 30ms) << "started anew";
}

// What nobody takes would fill the writer.
TEST_F(RegionTableTest, AHostThatDoesNotAnswerGetsFewOrders) {
    order(5ms, 5ms);
    is_there_[1] = true;
    order(5ms, {});
    int num_orders = 0;
    for (int i = 0; i < 100; ++i) {
        order(5ms, {});
        num_orders += table_.wants_order(1) ? 1 : 0;
        EXPECT_TRUE(table_.wants_order(0));
    }
    EXPECT_LE(num_orders, 9) << "of two seconds";
    EXPECT_GE(num_orders, 7);
    order(5ms, 5ms);  // this one may not have got an order
    for (int i = 0; i < 13 && state(1) != HostState::kInUse; ++i) order(5ms, 5ms);
    EXPECT_EQ(state(1), HostState::kInUse);
}

// While no camera delivers there are no orders, and no reason to call anybody missing.
TEST_F(RegionTableTest, WithoutOrdersAHostIsThereIfItIsConnected) {
    EXPECT_EQ(state(0), HostState::kMissing);
    is_there_ = {true, false};
    EXPECT_EQ(state(0), HostState::kInUse);
    EXPECT_EQ(state(1), HostState::kMissing);
    is_there_ = {true, true};
    order(5ms, 5ms);
    now_ += 10s;
    EXPECT_EQ(state(1), HostState::kInUse);
    is_there_ = {true, false};
    EXPECT_EQ(state(1), HostState::kMissing);
}

// One metaframe a second: an answer would be too old when the next one looks for it.
TEST_F(RegionTableTest, AMissingHostOfASlowSiteIsWaitedForAQuarterSecond) {
    table_ = RegionTable({{"east", {0}}, {"west", {1, 2}}}, 1s);
    is_there_ = {true, true};
    EXPECT_EQ(order(5ms, {}), 1s) << "at most";
    now_ += 1s;
    EXPECT_EQ(order(5ms, {}), 250ms);
    now_ += 1s;
    EXPECT_EQ(order(5ms, 30ms), 30ms);
    EXPECT_EQ(state(1), HostState::kInUse);
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
