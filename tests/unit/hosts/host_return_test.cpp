#include "site_node/hosts/host_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <random>

// A host whose fault has ended is in use within two seconds, and stays; meanwhile the others are in
// use all the time. On a simulated clock: nothing waits.
namespace atrium::hosts {
namespace {

using bus::HostState;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr std::int64_t kEpochStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kMs_ns = 1'000'000;
constexpr std::size_t kNumHosts = 4;
constexpr int kSeeds = 20;
constexpr std::int64_t kFaultBegin_ns = 3 * kSecond_ns;
constexpr std::int64_t kBackWithin_ns = 2 * kSecond_ns;

enum class Fault {
    kCutOff,      // nothing arrives
    kStoodStill,  // the same, and what it had waits in its queues
    kRestarted,
    kClockWrong,
    kLate,
    kModelClockWrong,      // that of the model part's host, and then right again
    kAllFollowModelClock,  // it is set for good; the hosts follow one after another
};
constexpr Fault kFaults[] = {Fault::kCutOff,
                             Fault::kStoodStill,
                             Fault::kRestarted,
                             Fault::kClockWrong,
                             Fault::kLate,
                             Fault::kModelClockWrong,
                             Fault::kAllFollowModelClock};

const char* name_of(Fault fault) {
    switch (fault) {
        case Fault::kCutOff:
            return "CutOff";
        case Fault::kStoodStill:
            return "StoodStill";
        case Fault::kRestarted:
            return "Restarted";
        case Fault::kClockWrong:
            return "ClockWrong";
        case Fault::kLate:
            return "Late";
        case Fault::kModelClockWrong:
            return "ModelClockWrong";
        default:
            return "AllFollowModelClock";
    }
}

struct ReturningHost {
    HostEntry entry;
    std::uint32_t first_camera = 0;
    std::int64_t clock_offset_ns = 0;
    std::uint64_t epoch = 0;
    std::int64_t slow_ns = 0;
    bool is_connected = true;
    std::vector<bus::CameraSilhouette> queue;
    std::optional<std::int64_t> fault_end_ns;  // of the simulation
    std::optional<std::int64_t> heard_ns;      // the first silhouette after the fault's end
    bool was_left_out = false;
};

class Simulation {
public:
    Simulation(Fault fault, double rate_hz, int seed)
        : fault_(fault),
          random_(static_cast<unsigned>(seed)),
          period_ns_(static_cast<std::int64_t>(1e9 / rate_hz)),
          hosts_(kNumHosts) {
        std::vector<std::string> cameras;
        std::vector<HostEntry> entries;
        for (ReturningHost& host : hosts_) {
            host.entry.name = fmt::format("host{}", entries.size());
            host.first_camera = static_cast<std::uint32_t>(cameras.size());
            for (std::int64_t left = integer(1, 4); left > 0; --left) {
                cameras.push_back(fmt::format("cam{}", cameras.size()));
                host.entry.cameras.push_back(cameras.back());
            }
            host.clock_offset_ns = integer(-kMs_ns, kMs_ns);
            host.epoch = random_();
            entries.push_back(host.entry);
        }
        table_.emplace(cameras, entries, HostTableOptions{nanoseconds(period_ns_), kDeadline});
    }

    void run() {
        schedule_fault();
        std::int64_t end_ns = 0;
        for (const ReturningHost& host : hosts_)
            end_ns = std::max(end_ns, host.fault_end_ns.value_or(0));
        end_ns += kBackWithin_ns + 2 * kSecond_ns;
        for (std::int64_t at_ns = 0; at_ns < end_ns; at_ns += period_ns_)
            schedule(at_ns, [this, at_ns] { capture(at_ns); });
        for (std::int64_t at_ns = 0; at_ns < end_ns; at_ns += 100 * kMs_ns)
            schedule(at_ns, [this] { ask(); });
        while (!events_.empty() && !testing::Test::HasFatalFailure()) {
            auto event = events_.extract(events_.begin());
            now_ns_ = event.key();
            event.mapped()();
        }
        for (const ReturningHost& host : hosts_) {
            EXPECT_EQ(host.was_left_out, host.fault_end_ns.has_value()) << host.entry.name;
            EXPECT_EQ(host.heard_ns.has_value(), host.fault_end_ns.has_value());
        }
    }

private:
    static constexpr milliseconds kDeadline{100};

    std::int64_t integer(std::int64_t low, std::int64_t high) {
        return std::uniform_int_distribution<std::int64_t>(low, high)(random_);
    }
    std::int64_t way_ns(const ReturningHost& host) {
        return integer(kMs_ns / 10, 3 * kMs_ns) + host.slow_ns;
    }
    void schedule(std::int64_t due_ns, std::function<void()> what) {
        events_.emplace(due_ns, std::move(what));
    }
    // By 0.6 periods to some seconds.
    std::int64_t wrong_by_ns() {
        const std::int64_t size_ns = integer(0, 1) == 0
                                         ? integer(period_ns_ * 6 / 10, 3 * period_ns_)
                                         : integer(kSecond_ns, 15 * kSecond_ns);
        return integer(0, 1) == 0 ? size_ns : -size_ns;
    }
    void set_clock(ReturningHost& host, std::int64_t offset_ns) {
        host.clock_offset_ns = offset_ns;
        host.epoch = random_();
    }

    void schedule_fault() {
        const std::int64_t length_ns = integer(1200 * kMs_ns, 8 * kSecond_ns);
        const std::int64_t end_ns = kFaultBegin_ns + length_ns;
        ReturningHost& host = hosts_[random_() % kNumHosts];
        host.fault_end_ns = end_ns;
        switch (fault_) {
            case Fault::kCutOff:
            case Fault::kStoodStill:
            case Fault::kRestarted:
                schedule(kFaultBegin_ns, [&] { host.is_connected = false; });
                schedule(end_ns, [this, &host] {
                    host.is_connected = true;
                    if (fault_ == Fault::kRestarted) host.epoch = random_();
                    for (auto& silhouette : std::exchange(host.queue, {})) send(host, silhouette);
                });
                return;
            case Fault::kClockWrong: {
                const std::int64_t right_ns = host.clock_offset_ns;
                schedule(kFaultBegin_ns, [this, &host, right_ns, by_ns = wrong_by_ns()] {
                    set_clock(host, right_ns + by_ns);
                });
                schedule(end_ns, [this, &host, right_ns] { set_clock(host, right_ns); });
                return;
            }
            case Fault::kLate:
                schedule(kFaultBegin_ns,
                         [&host, by_ns = integer(120, 400) * kMs_ns] { host.slow_ns = by_ns; });
                schedule(end_ns, [&host] { host.slow_ns = 0; });
                return;
            case Fault::kModelClockWrong:
            case Fault::kAllFollowModelClock:
                schedule_model_clock(end_ns, wrong_by_ns());
                return;
        }
    }

    void schedule_model_clock(std::int64_t end_ns, std::int64_t by_ns) {
        schedule(kFaultBegin_ns + integer(0, 100 * kMs_ns),
                 [this, by_ns] { set_model_clock(by_ns); });
        if (fault_ == Fault::kModelClockWrong) schedule(end_ns, [this] { set_model_clock(0); });
        for (ReturningHost& host : hosts_) {
            host.fault_end_ns = end_ns;
            if (fault_ == Fault::kModelClockWrong) continue;
            host.fault_end_ns = end_ns + integer(0, 4 * kSecond_ns);
            schedule(*host.fault_end_ns,
                     [this, &host, by_ns] { set_clock(host, host.clock_offset_ns + by_ns); });
        }
    }
    void set_model_clock(std::int64_t offset_ns) {
        model_offset_ns_ = offset_ns;
        is_model_clock_set_ = true;
    }

    Timestamp model_time() const { return {kEpochStart_ns + now_ns_ + model_offset_ns_}; }
    HostTable::Time steady() const {
        return HostTable::Time(std::chrono::hours(1) + nanoseconds(now_ns_));
    }

    void capture(std::int64_t due_ns) {
        for (ReturningHost& host : hosts_) {
            for (std::uint32_t i = 0; i < host.entry.cameras.size(); ++i) {
                bus::CameraSilhouette silhouette;
                silhouette.host = host.entry.name;
                silhouette.camera = host.first_camera + i;
                silhouette.capture_time = {kEpochStart_ns + due_ns + host.clock_offset_ns};
                silhouette.clock_epoch = host.epoch;
                silhouette.has_picture = true;
                if (host.is_connected)
                    send(host, silhouette);
                else if (fault_ == Fault::kStoodStill && host.queue.size() < 16)
                    host.queue.push_back(silhouette);
            }
        }
    }
    void send(ReturningHost& host, const bus::CameraSilhouette& silhouette) {
        schedule(now_ns_ + 3 * kMs_ns + way_ns(host), [this, &host, silhouette, sent_ns = now_ns_] {
            if (host.fault_end_ns && !host.heard_ns && sent_ns >= *host.fault_end_ns)
                host.heard_ns = now_ns_;
            frames_.clear();
            table_->add(silhouette, model_time(), steady(), frames_);
            look();
        });
    }

    // As HostsSource does.
    void ask() {
        table_->look(steady());
        ++question_;
        if (std::exchange(is_model_clock_set_, false)) {
            first_valid_question_ = question_;
            table_->forget_clocks(steady());
        }
        for (ReturningHost& host : hosts_) {
            if (!host.is_connected) continue;
            schedule(now_ns_ + way_ns(host),
                     [this, &host, asked = model_time(), number = question_] {
                         answer(host, asked, number);
                     });
        }
        look();
    }
    void answer(ReturningHost& host, Timestamp asked, std::uint64_t number) {
        if (!host.is_connected) return;
        bus::ClockAnswer answer;
        answer.host = host.entry.name;
        answer.asked = asked;
        answer.received = answer.answered = {kEpochStart_ns + now_ns_ + host.clock_offset_ns};
        answer.clock_epoch = host.epoch;
        schedule(now_ns_ + way_ns(host), [this, answer, number] {
            if (is_model_clock_set_ || number < first_valid_question_) return;
            table_->add(answer, model_time(), steady());
        });
    }

    // The property, after each event.
    void look() {
        if (now_ns_ < kSecond_ns) return;  // the start
        for (ReturningHost& host : hosts_) {
            const bool is_in_use = table_->is_in_use(host.first_camera);
            const bool must_be = !host.fault_end_ns || now_ns_ < kFaultBegin_ns ||
                                 (host.heard_ns && now_ns_ > *host.heard_ns + kBackWithin_ns);
            ASSERT_TRUE(is_in_use || !must_be)
                << host.entry.name << " is in state " << state_of(host) << " at "
                << 1e-9 * static_cast<double>(now_ns_) << " s, heard since "
                << 1e-9 * static_cast<double>(host.heard_ns.value_or(0)) << " s";
            if (!is_in_use) host.was_left_out = true;
        }
    }
    int state_of(const ReturningHost& host) const {
        return static_cast<int>(
            table_->statuses()[static_cast<std::size_t>(&host - hosts_.data())].state);
    }

    Fault fault_;
    std::mt19937_64 random_;
    std::int64_t period_ns_;
    std::vector<ReturningHost> hosts_;
    std::optional<HostTable> table_;
    std::multimap<std::int64_t, std::function<void()>> events_;
    std::vector<capture::CameraFrame> frames_;
    std::int64_t now_ns_ = 0;
    std::int64_t model_offset_ns_ = 0;
    bool is_model_clock_set_ = false;  // and not noticed yet
    std::uint64_t question_ = 0;
    std::uint64_t first_valid_question_ = 0;
};

class HostReturns : public testing::TestWithParam<std::tuple<Fault, double>> {};

TEST_P(HostReturns, IsInUseWithinTwoSeconds) {
    const auto& [fault, rate_hz] = GetParam();
    for (int seed = 0; seed < kSeeds && !HasFailure(); ++seed) {
        SCOPED_TRACE(fmt::format("seed {}", seed));
        Simulation(fault, rate_hz, seed).run();
    }
}

std::string name_of_case(const testing::TestParamInfo<HostReturns::ParamType>& info) {
    const auto& [fault, rate_hz] = info.param;
    return fmt::format("{}At{:g}Hz", name_of(fault), rate_hz);
}
INSTANTIATE_TEST_SUITE_P(Faults,
                         HostReturns,
                         testing::Combine(testing::ValuesIn(kFaults),
                                          testing::Values(10.0, 15.0, 30.0, 60.0)),
                         name_of_case);

}  // namespace
}  // namespace atrium::hosts
