#include "core/presence/name_claim.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::presence {
namespace {

using namespace std::chrono_literals;
using bus::Presence;
using bus::ProgramKind;
using Verdict = NameClaim::Verdict;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;
const NameClaim::Clock::time_point kStart{std::chrono::hours(1)};

Presence lab(std::uint64_t instance, std::int64_t start_s, bool is_holder) {
    Presence presence;
    presence.kind = ProgramKind::kSiteNode;
    presence.name = "lab";
    presence.instance = instance;
    presence.is_holder = is_holder;
    presence.host = "alpha";
    presence.pid = 17;
    presence.start_time.ns = start_s * kSecond;
    return presence;
}

TEST(NameClaim, IsHeldAfterListeningWithoutRivals) {
    NameClaim claim(lab(1, 100, false), kStart);
    Presence other_name = lab(2, 50, true);
    other_name.name = "studio";
    claim.see(other_name, kStart);
    Presence other_kind = lab(3, 50, true);
    other_kind.kind = ProgramKind::kViewer;
    claim.see(other_kind, kStart);
    EXPECT_EQ(claim.decide(kStart + 100ms), Verdict::kWait);
    EXPECT_EQ(claim.decide(kStart + NameClaim::kListen), Verdict::kHold);
    EXPECT_EQ(claim.rival(), nullptr);
}

TEST(NameClaim, IsRefusedAtOnceIfTheHolderAnswers) {
    NameClaim claim(lab(1, 100, false), kStart);
    claim.see(lab(2, 50, true), kStart);
    EXPECT_EQ(claim.decide(kStart + 10ms), Verdict::kWait);
    claim.see(lab(2, 50, true), kStart + 20ms);
    EXPECT_EQ(claim.decide(kStart + 20ms), Verdict::kRefused);
    ASSERT_NE(claim.rival(), nullptr);
    EXPECT_THAT(describe(*claim.rival()),
                AllOf(HasSubstr("site 'lab'"),
                      HasSubstr("host alpha"),
                      HasSubstr("pid 17"),
                      HasSubstr("1970-01-01T00:00:50Z")));
}

// The holder's last message came before the newcomer discovered it. That looks like the last
// message of a killed holder.
TEST(NameClaim, AsksAgainIfTheAnswerCameBeforeDiscovery) {
    NameClaim holder(lab(2, 50, false), kStart);
    ASSERT_EQ(holder.decide(kStart + 1s), Verdict::kHold);
    const auto begin = kStart + 2s;
    NameClaim newcomer(lab(1, 100, false), begin);
    holder.see(lab(1, 100, false), begin);
    EXPECT_TRUE(holder.take_question());
    newcomer.see(lab(2, 50, true), begin + 10ms);
    EXPECT_EQ(newcomer.decide(begin + 10ms), Verdict::kWait);
    EXPECT_FALSE(newcomer.should_ask(begin + 10ms));
    const auto again = begin + NameClaim::kAskAgain;
    EXPECT_EQ(newcomer.decide(again), Verdict::kWait);
    EXPECT_TRUE(newcomer.should_ask(again));
    EXPECT_FALSE(newcomer.should_ask(again + 20ms)) << "must not ask at every check";
    holder.see(lab(1, 100, false), again);
    EXPECT_TRUE(holder.take_question());
    newcomer.see(lab(2, 50, true), again + 10ms);
    EXPECT_EQ(newcomer.decide(again + 10ms), Verdict::kRefused);
}

TEST(NameClaim, FrequentAskerGetsFewAnswers) {
    NameClaim holder(lab(2, 50, false), kStart);
    ASSERT_EQ(holder.decide(kStart + 1s), Verdict::kHold);
    int num_answers = 0;
    for (auto now = kStart + 1s; now < kStart + 2s; now += 1ms) {
        holder.see(lab(1, 100, false), now);
        num_answers += holder.take_question();
    }
    EXPECT_EQ(num_answers, 10);
}

TEST(NameClaim, AsksNobodyWithoutAHolder) {
    NameClaim claim(lab(1, 100, false), kStart);
    claim.see(lab(2, 50, false), kStart);
    EXPECT_EQ(claim.decide(kStart + 1s), Verdict::kWait);
    EXPECT_FALSE(claim.should_ask(kStart + 1s));
}

TEST(NameClaim, IsRefusedByAHolderWithAWrongClock) {
    for (const std::int64_t holder_start_s : {std::int64_t{1}, std::int64_t{100'000}}) {
        NameClaim claim(lab(1, 5000, false), kStart);
        claim.see(lab(2, holder_start_s, true), kStart);
        claim.see(lab(2, holder_start_s, true), kStart + 20ms);
        EXPECT_EQ(claim.decide(kStart + 20ms), Verdict::kRefused) << holder_start_s;
    }
}

TEST(NameClaim, IsFreeOnceTheLeaseOfAKilledHolderExpires) {
    NameClaim claim(lab(1, 100, false), kStart);
    claim.see(lab(2, 50, true), kStart);
    EXPECT_EQ(claim.decide(kStart + 1500ms), Verdict::kWait);
    ASSERT_NE(claim.rival(), nullptr);
    claim.gone(lab(2, 50, true));
    EXPECT_EQ(claim.decide(kStart + 1500ms), Verdict::kHold);
}

TEST(NameClaim, IsRefusedByASilentHolderThatDdsStillSees) {
    NameClaim claim(lab(1, 100, false), kStart);
    claim.see(lab(2, 50, true), kStart);
    EXPECT_EQ(claim.decide(kStart + NameClaim::kLease - 1ms), Verdict::kWait);
    EXPECT_EQ(claim.decide(kStart + NameClaim::kLease), Verdict::kRefused);
}

// Runs both claims. Messages arrive after `delay_steps` of 20 ms. Returns the holders.
std::vector<std::uint64_t> survivors(std::int64_t start_a_s,
                                     std::int64_t start_b_s,
                                     int delay_steps,
                                     int b_begins_step) {
    struct Process {
        Presence own;
        NameClaim claim;
        bool is_out = false;
        std::vector<std::pair<int, Presence>> inbox;  // step of arrival, message
    };
    std::vector<Process> all;
    all.push_back({lab(1, start_a_s, false), NameClaim(lab(1, start_a_s, false), kStart), {}, {}});
    all.push_back({lab(2, start_b_s, false),
                   NameClaim(lab(2, start_b_s, false), kStart + b_begins_step * 20ms),
                   {},
                   {}});
    const auto write = [&](std::size_t from, int step) {
        all[1 - from].inbox.emplace_back(step + delay_steps, all[from].own);
    };
    for (int step = 0; step < 400; ++step) {
        for (std::size_t i = 0; i < 2; ++i) {
            Process& self = all[i];
            const int begin = i == 1 ? b_begins_step : 0;
            if (self.is_out || step < begin) continue;
            if (step == begin) write(i, step);
            const auto now = kStart + step * 20ms;
            for (const auto& [arrival, presence] : self.inbox) {
                if (arrival != step && !(step == begin && arrival < step)) continue;
                self.claim.see(presence, now);
            }
            const Verdict verdict = self.claim.decide(now);
            if (verdict == Verdict::kHold && !self.own.is_holder) {
                self.own.is_holder = true;
                write(i, step);
            }
            if (self.claim.take_question() || self.claim.should_ask(now)) write(i, step);
            if (verdict != Verdict::kRefused) continue;
            self.is_out = true;
            all[1 - i].claim.gone(self.own);
        }
    }
    std::vector<std::uint64_t> held;
    for (const Process& process : all) {
        if (!process.is_out && process.own.is_holder) held.push_back(process.own.instance);
    }
    return held;
}

TEST(NameClaim, ExactlyOneOfTwoSurvivesAnyStart) {
    for (const std::int64_t start_b_s : {90, 100, 110}) {
        for (const int delay_steps : {0, 1, 10, 29, 31, 60}) {
            for (const int b_begins_step : {0, 1, 20, 30, 31, 100}) {
                EXPECT_EQ(survivors(100, start_b_s, delay_steps, b_begins_step).size(), 1U)
                    << "start " << start_b_s << " delay " << delay_steps << " begin "
                    << b_begins_step;
            }
        }
    }
    // both started together: the lower instance number wins
    EXPECT_EQ(survivors(100, 100, 1, 0), std::vector<std::uint64_t>{1});
}

TEST(NameClaim, LaterClaimDoesNotAffectTheFirstWhateverItsClock) {
    for (const std::int64_t start_b_s : {1, 100, 100'000}) {
        EXPECT_EQ(survivors(100, start_b_s, 2, 100), std::vector<std::uint64_t>{1}) << start_b_s;
    }
}

TEST(NameClaim, OlderOfTwoHoldersStays) {
    NameClaim older(lab(5, 100, false), kStart);
    NameClaim younger(lab(6, 200, false), kStart);
    ASSERT_EQ(older.decide(kStart + 1s), Verdict::kHold);
    ASSERT_EQ(younger.decide(kStart + 1s), Verdict::kHold);
    older.see(lab(6, 200, true), kStart + 60s);
    younger.see(lab(5, 100, true), kStart + 60s);
    EXPECT_EQ(older.decide(kStart + 60s), Verdict::kHold);
    EXPECT_EQ(younger.decide(kStart + 60s), Verdict::kRefused);
}

}  // namespace
}  // namespace atrium::presence
