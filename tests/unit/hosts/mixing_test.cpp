#include "site_node/capture/metaframe_assembler.hpp"
#include "site_node/hosts/clock_epoch.hpp"
#include "site_node/hosts/host_table.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>

// Whatever the clocks, the network and the hosts do: no metaframe has pictures of two instants.
namespace atrium::hosts {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr int kHosts = 4;
constexpr std::size_t kCamerasPerHost = 2;

// A host and its faults.
struct SimulatedHost {
    std::int64_t clock_offset_ns = 0;
    double clock_rate = 0.0;  // a daemon slews it
    std::unique_ptr<ClockEpoch> epoch;
    double loss = 0.0;
    double slow_ns = 0.0;
    bool is_there = true;
};

class Mixing : public testing::TestWithParam<int> {
protected:
    double uniform(double low, double high) {
        return std::uniform_real_distribution<>(low, high)(random_);
    }
    bool chance(double p) { return std::bernoulli_distribution(p)(random_); }
    nanoseconds delay(const SimulatedHost& host) {
        return nanoseconds(static_cast<std::int64_t>(uniform(1e5, 2e6 + host.slow_ns)));
    }

    // Clocks that were set: by anything, and by whole periods, which times alone cannot tell.
    void set_clock(SimulatedHost& host) {
        const double steps[] = {uniform(-4e7, 4e7),
                                uniform(-2e6, 2e6),
                                static_cast<double>(period_.count()) * (chance(0.5) ? 1.0 : -1.0),
                                -static_cast<double>(host.clock_offset_ns)};
        host.clock_offset_ns += static_cast<std::int64_t>(steps[random_() % 4]);
    }

    // As NTP does, or as fast as chrony may.
    void slew_clock(SimulatedHost& host) {
        const double rates[] = {0.0, uniform(-9e-4, 9e-4), uniform(-0.08, 0.08)};
        host.clock_rate = rates[random_() % 3];
    }

    Timestamp model_time() const { return {now_ns_ + model_offset_ns_}; }

    // Of another process.
    void begin_epoch(SimulatedHost& host) {
        host.epoch = std::make_unique<ClockEpoch>(
            ClockEpoch::Clocks{[this, &host] { return Timestamp{now_ns_ + host.clock_offset_ns}; },
                               [this] { return nanoseconds(now_ns_ - kStart_ns); }});
    }

    void schedule(std::int64_t due_ns, std::function<void()> what) {
        events_.emplace(due_ns, std::move(what));
    }

    static void TearDownTestSuite() {
        EXPECT_GT(total_metaframes_, 0u) << "nothing was put together: nothing could be mixed";
        EXPECT_GT(total_complete_, 0u);
    }
    static inline std::size_t total_metaframes_ = 0;  // of all seeds
    static inline std::size_t total_complete_ = 0;

    std::int64_t now_ns_ = kStart_ns;
    std::int64_t model_offset_ns_ = 0;
    bool is_model_clock_set_ = false;  // and not noticed yet
    std::uint64_t question_ = 0;
    std::uint64_t first_valid_question_ = 0;
    std::mt19937_64 random_{static_cast<unsigned>(GetParam())};
    nanoseconds period_{GetParam() % 2 == 0 ? 33'333'333 : 16'666'667};
    std::multimap<std::int64_t, std::function<void()>> events_;
};

TEST_P(Mixing, NoMetaframeHasTwoInstants) {
    std::vector<std::string> cameras;
    std::vector<HostEntry> entries;
    std::vector<SimulatedHost> hosts(kHosts);
    for (int h = 0; h < kHosts; ++h) {
        HostEntry entry;
        entry.name = "host" + std::to_string(h);
        for (std::size_t c = 0; c < kCamerasPerHost; ++c) {
            cameras.push_back("cam" + std::to_string(cameras.size()));
            entry.cameras.push_back(cameras.back());
        }
        entries.push_back(entry);
        begin_epoch(hosts[h]);
        hosts[h].loss = chance(0.5) ? uniform(0.0, 0.3) : 0.0;
        hosts[h].slow_ns = chance(0.3) ? uniform(0.0, 1.5e8) : 0.0;
        if (chance(0.7)) set_clock(hosts[h]);
    }
    HostTable table(cameras, entries, {period_, milliseconds(100)});
    capture::MetaframeAssembler assembler(cameras.size(), {period_ / 4, milliseconds(100), 2});

    const auto steady = [&] {
        return HostTable::Time(std::chrono::hours(1) + nanoseconds(now_ns_ - kStart_ns));
    };
    std::size_t num_metaframes = 0;
    std::size_t num_complete = 0;
    const auto look_at = [&](const std::optional<capture::Metaframe>& metaframe) {
        if (!metaframe) return;
        ++num_metaframes;
        std::optional<std::uint64_t> instant;
        std::size_t num_there = 0;
        for (const auto& frame : metaframe->frames) {
            if (frame.is_lost()) continue;
            ++num_there;
            ASSERT_EQ(instant.value_or(frame.found->texture_frame_id),
                      frame.found->texture_frame_id)
                << "camera " << frame.camera;
            instant = frame.found->texture_frame_id;
        }
        num_complete += num_there == cameras.size() ? 1 : 0;
    };

    for (int instant = 0; instant < 300; ++instant) {
        const std::int64_t due_ns = kStart_ns + instant * period_.count();
        // the clock of the model part's host is set, too
        schedule(due_ns, [&] {
            if (!chance(0.004)) return;
            SimulatedHost model;
            model.clock_offset_ns = model_offset_ns_;
            set_clock(model);
            model_offset_ns_ = model.clock_offset_ns;
            is_model_clock_set_ = true;
        });
        for (int h = 0; h < kHosts; ++h) {
            schedule(due_ns, [&, h, instant, due_ns] {
                SimulatedHost& host = hosts[h];
                if (chance(0.004)) set_clock(host);
                if (chance(0.02)) slew_clock(host);
                host.clock_offset_ns += static_cast<std::int64_t>(
                    host.clock_rate * static_cast<double>(period_.count()));
                if (chance(0.004)) {
                    host.is_there = !host.is_there;
                    begin_epoch(host);
                }
                if (!host.is_there) return;
                for (std::size_t c = 0; c < kCamerasPerHost; ++c) {
                    if (chance(host.loss)) continue;
                    bus::CameraSilhouette silhouette;
                    silhouette.host = entries[h].name;
                    silhouette.camera = static_cast<std::uint32_t>(h * kCamerasPerHost + c);
                    // the shutters differ by up to a millisecond
                    silhouette.capture_time = {due_ns + host.clock_offset_ns +
                                               static_cast<std::int64_t>(uniform(0.0, 1e6))};
                    silhouette.clock_epoch = host.epoch->current();
                    silhouette.has_picture = !chance(0.02);
                    silhouette.frame_id = static_cast<std::uint64_t>(instant);
                    schedule(due_ns + 3'000'000 + delay(host).count(), [&, silhouette] {
                        std::vector<capture::CameraFrame> frames;
                        table.add(silhouette, model_time(), steady(), frames);
                        for (auto& frame : frames)
                            look_at(assembler.add(std::move(frame), steady()));
                    });
                }
            });
        }
        schedule(due_ns + 1, [&] {
            table.look(steady());
            look_at(assembler.expire(steady()));
        });
        if (instant % 3 != 0) continue;
        // as HostsSource does
        schedule(due_ns + 1, [&] {
            ++question_;
            if (!std::exchange(is_model_clock_set_, false)) return;
            first_valid_question_ = question_;
            table.forget_clocks(steady());
        });
        for (int h = 0; h < kHosts; ++h) {
            schedule(due_ns + 2, [&, h, due_ns] {
                bus::ClockAnswer answer;
                answer.host = entries[h].name;
                answer.asked = model_time();
                answer.number = question_;
                const std::int64_t at_ns = now_ns_ + delay(hosts[h]).count();
                schedule(at_ns, [&, h, answer]() mutable {
                    SimulatedHost& host = hosts[h];
                    if (!host.is_there) return;
                    answer.received = answer.answered = {now_ns_ + host.clock_offset_ns};
                    answer.clock_epoch = host.epoch->current();
                    schedule(now_ns_ + delay(host).count(), [&, answer] {
                        if (is_model_clock_set_ || answer.number < first_valid_question_) return;
                        table.add(answer, model_time(), steady());
                    });
                });
            });
        }
    }
    while (!events_.empty()) {
        const auto event = events_.extract(events_.begin());
        now_ns_ = std::max(now_ns_, event.key());
        event.mapped()();
        if (HasFatalFailure()) return;
    }
    total_metaframes_ += num_metaframes;
    total_complete_ += num_complete;
}
INSTANTIATE_TEST_SUITE_P(Seeds, Mixing, testing::Range(0, 300));

// With good clocks and networks nothing is left out: the test above would else pass by emptiness.
TEST(Hosts, GoodHostsGiveCompleteMetaframes) {
    const nanoseconds period{33'333'333};
    std::vector<HostEntry> entries{{"left", {"a"}, false, false, ""},
                                   {"right", {"b"}, false, true, ""}};
    HostTable table({"a", "b"}, entries, {period, milliseconds(100)});
    capture::MetaframeAssembler assembler(2, {period / 4, milliseconds(100), 0});
    std::size_t num_complete = 0;
    for (int instant = 0; instant < 100; ++instant) {
        const std::int64_t now_ns = kStart_ns + instant * period.count();
        const HostTable::Time steady{nanoseconds(now_ns)};
        for (const auto& entry : entries) {
            const std::int64_t off_ns = entry.is_model ? -7'000'000 : 7'000'000;
            bus::ClockAnswer answer;
            answer.host = entry.name;
            answer.asked = {now_ns};
            answer.received = answer.answered = {now_ns + 100'000 + off_ns};
            table.add(answer, {now_ns + 200'000}, steady);
            bus::CameraSilhouette silhouette;
            silhouette.host = entry.name;
            silhouette.camera = entry.is_model ? 1 : 0;
            silhouette.capture_time = {now_ns + off_ns};
            silhouette.has_picture = true;
            std::vector<capture::CameraFrame> frames;
            table.add(silhouette, {now_ns + 5'000'000}, steady, frames);
            for (auto& frame : frames) {
                const auto metaframe = assembler.add(std::move(frame), steady);
                if (!metaframe) continue;
                num_complete +=
                    metaframe->frames[0].is_lost() || metaframe->frames[1].is_lost() ? 0 : 1;
            }
        }
    }
    EXPECT_GE(num_complete, 99u);
}

}  // namespace
}  // namespace atrium::hosts
