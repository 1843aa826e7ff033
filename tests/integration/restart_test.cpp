#include "core/bus/bus.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/source_dir.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

// Two sites, a world server and a viewer. The tests kill one and start it again while the others
// run. ATRIUM_RESTART_ROUNDS sets the number of rounds for each of the three (default 2).
// docs/measurements/streams.md has the result of 20.
namespace atrium::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPatience = 120s;  // for slow machines with sanitizers, and rooms to render
constexpr double kGoneWithin_ms = 2000.0;
constexpr double kBackWithin_ms = 2000.0;
constexpr const char* kWorld = "restarts";
constexpr std::uint32_t kDomain = 193;  // used by this test only

int num_rounds() {
    const char* text = std::getenv("ATRIUM_RESTART_ROUNDS");
    return text != nullptr ? std::max(1, std::atoi(text)) : 2;
}

double ms_since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

/// Follows the programs over the bus: their progress by their status, and the lost ones.
class Onlooker {
public:
    Onlooker()
        : participant_(join()),
          waiter_(value(bus::Waiter::create(participant_))),
          sites_(value(bus::Reader<bus::SiteStatus>::create(participant_))),
          worlds_(value(bus::Reader<bus::WorldStatus>::create(participant_))),
          viewers_(value(bus::Reader<bus::ViewerStatus>::create(participant_))) {
        waiter_.add(sites_);
        waiter_.add(worlds_);
        waiter_.add(viewers_);
        thread_ = std::jthread([this](std::stop_token stop) { watch(stop); });
    }

    /// Waits until no program of this name is present.
    bool wait_gone(const std::string& name) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, kPatience, [&] { return !progress_.contains(name); });
    }
    /// Waits for two reports of each program from now on. Returns those whose second report shows
    /// no progress.
    std::vector<std::string> wait_progress(const std::vector<std::string>& names) {
        std::unique_lock lock(mutex_);
        const auto wait_reports = [&](std::map<std::string, std::uint64_t> since) {
            changed_.wait_for(lock, kPatience, [&] {
                return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
                    return num_reports_[name] > since[name];
                });
            });
        };
        wait_reports(num_reports_);
        std::map<std::string, std::uint64_t> before = progress_;
        wait_reports(num_reports_);
        std::vector<std::string> standing;
        for (const std::string& name : names) {
            if (!progress_.contains(name) || progress_[name] <= before[name])
                standing.push_back(name);
        }
        return standing;
    }
    /// Number of faults in all reports so far.
    std::uint64_t num_faults() const {
        const std::lock_guard lock(mutex_);
        return num_faults_;
    }
    int num_gone(const std::string& name) const {
        const std::lock_guard lock(mutex_);
        const auto found = num_gone_.find(name);
        return found == num_gone_.end() ? 0 : found->second;
    }

private:
    static bus::Participant join() {
        bus::BusOptions options;
        options.world = kWorld;
        options.domain = kDomain;
        return value(bus::Participant::create(options));
    }
    void note(const std::string& name, std::uint64_t progress, std::uint64_t num_faults) {
        const std::lock_guard lock(mutex_);
        ++num_reports_[name];
        progress_[name] = progress;
        num_faults_ += num_faults;
    }
    void lose(const std::string& name) {
        const std::lock_guard lock(mutex_);
        num_gone_[name] += progress_.erase(name) > 0 ? 1 : 0;
    }
    void watch(std::stop_token stop) {
        const std::stop_callback wake(stop, [this] { waiter_.wake(); });
        while (!stop.stop_requested()) {
            waiter_.wait(1000ms);
            sites_.take(
                [&](bus::SiteStatus&& s) {
                    note(s.site, s.num_metaframes_published, s.num_failed);
                },
                [&](const bus::SiteStatus& s) { lose(s.site); });
            worlds_.take([&](bus::WorldStatus&& s) { note(s.world, s.num_steps, s.num_rejected); },
                         [&](const bus::WorldStatus& s) { lose(s.world); });
            viewers_.take(
                [&](bus::ViewerStatus&& s) { note(s.viewer, s.num_frames, s.num_rejected); },
                [&](const bus::ViewerStatus& s) { lose(s.viewer); });
            changed_.notify_all();
        }
    }

    bus::Participant participant_;
    bus::Waiter waiter_;
    bus::Reader<bus::SiteStatus> sites_;
    bus::Reader<bus::WorldStatus> worlds_;
    bus::Reader<bus::ViewerStatus> viewers_;
    mutable std::mutex mutex_;                       // guards the next ones
    std::map<std::string, std::uint64_t> progress_;  // of the present programs
    std::map<std::string, std::uint64_t> num_reports_;
    std::map<std::string, int> num_gone_;
    std::uint64_t num_faults_ = 0;
    std::condition_variable changed_;
    std::jthread thread_;  // destroyed first
};

/// Times of one kind, over all rounds.
struct Times {
    std::vector<double> ms;
    void print(const std::string& what) {
        if (ms.empty()) return;  // nothing was measured, and the test has already failed
        std::sort(ms.begin(), ms.end());
        std::printf("%-28s %zu times, median %.0f ms, longest %.0f ms\n",
                    what.c_str(),
                    ms.size(),
                    ms[ms.size() / 2],
                    ms.back());
    }
};

class Restart : public testing::Test {
protected:
    static void SetUpTestSuite() {
        rooms_ = std::filesystem::path(testing::TempDir()) /
                 ("atrium_restart_" + std::to_string(getpid()));
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(rooms_); }
    void SetUp() override {
        for (const std::string name : {"alice", "bob", "wall", kWorld}) start(name);
        for (const std::string name : {"alice", "bob"}) {
            ASSERT_TRUE(wait(kWorld, "site_arrived site=" + name));
            ASSERT_TRUE(wait("wall", "person_shown site=" + name));
        }
    }
    void TearDown() override {
        for (auto& [name, program] : programs_) {
            program->signal(SIGTERM);
            EXPECT_EQ(program->wait(kPatience), 0) << name << program->output();
        }
    }

    void start(const std::string& name) {
        auto process = HostedProcess::start(command_of(name));
        ASSERT_TRUE(process) << process.error().message;
        programs_[name] = std::move(*process);
    }
    std::vector<std::string> command_of(const std::string& name) const {
        const std::string programs = ATRIUM_BIN_DIR "/";
        const std::string deploy = atrium::test::source_dir() + "/deploy/";
        std::vector<std::string> command;
        if (name == kWorld)
            command = {programs + "world_server", "--config", deploy + "worlds/playroom.toml"};
        else if (name == "wall")
            command = {programs + "viewer",
                       "--headless",
                       "--view.name",
                       name,
                       "--view.width",
                       "64",
                       "--view.height",
                       "36",
                       "--view.max_fps",
                       "10"};
        else
            command = {programs + "site_node",
                       "--config",
                       deploy + "sites/" + name + ".toml",
                       "--capture.rate_hz",
                       "10",
                       "--simulation.loop_s",
                       "1",
                       "--simulation.cache",
                       rooms_.string(),
                       "--log-level",
                       "debug"};
        for (const std::string& word : {std::string("--bus.world"),
                                        std::string(kWorld),
                                        std::string("--bus.domain"),
                                        std::to_string(kDomain)})
            command.push_back(word);
        return command;
    }
    bool wait(const std::string& name, const std::string& text, std::size_t from = 0) {
        return programs_[name]->wait_for_output(text, kPatience, from);
    }
    std::size_t seen(const std::string& name) const { return programs_.at(name)->output().size(); }

    /// Log lines of the other programs when it is gone, and when it is back.
    struct Lines {
        std::string by;
        std::string gone;
        std::string back;
    };
    void kill_and_restart(const std::string& name,
                          const std::string& ready,
                          const std::vector<Lines>& others_say);

    static inline std::filesystem::path rooms_;  // rendered by the first test
    std::map<std::string, std::unique_ptr<HostedProcess>> programs_;
    void print_times(const std::string& who) {
        gone_.print(who + " gone");
        start_.print(who + " started");
        back_.print(who + " back");
    }

    Onlooker onlooker_;
    Times gone_;
    Times back_;
    Times start_;
};

void Restart::kill_and_restart(const std::string& name,
                               const std::string& ready,
                               const std::vector<Lines>& others_say) {
    std::map<std::string, std::size_t> before;
    std::map<std::string, int> num_gone;
    for (const auto& [other, program] : programs_) {
        before[other] = seen(other);
        num_gone[other] = onlooker_.num_gone(other);
    }
    const auto killed = Clock::now();
    programs_[name]->signal(SIGKILL);
    for (const Lines& lines : others_say) {
        if (lines.gone.empty()) continue;
        ASSERT_TRUE(wait(lines.by, lines.gone, before[lines.by])) << lines.by << lines.gone;
    }
    ASSERT_TRUE(onlooker_.wait_gone(name));
    gone_.ms.push_back(ms_since(killed));
    EXPECT_LT(gone_.ms.back(), kGoneWithin_ms) << name;
    EXPECT_EQ(programs_[name]->wait(kPatience), 128 + SIGKILL);
    std::vector<std::string> others;
    for (const auto& [other, program] : programs_) {
        if (other != name) others.push_back(other);
    }
    EXPECT_THAT(onlooker_.wait_progress(others), testing::IsEmpty())
        << "these programs make no progress";

    for (const auto& [other, program] : programs_) before[other] = seen(other);
    const auto begin = Clock::now();
    start(name);
    ASSERT_TRUE(wait(name, ready)) << programs_[name]->output();
    start_.ms.push_back(ms_since(begin));
    const auto is_ready = Clock::now();
    for (const Lines& lines : others_say) {
        // all of its own lines are new
        const std::size_t from = lines.by == name ? 0 : before[lines.by];
        ASSERT_TRUE(wait(lines.by, lines.back, from)) << lines.by << lines.back;
    }
    back_.ms.push_back(ms_since(is_ready));
    EXPECT_LT(back_.ms.back(), kBackWithin_ms) << name;
    for (const std::string& other : others) {
        EXPECT_EQ(onlooker_.num_gone(other), num_gone[other]) << other << " was lost as well";
        const std::string output = programs_[other]->output();
        EXPECT_EQ(output.find(" error "), std::string::npos) << output;
    }
    others.push_back(name);
    EXPECT_THAT(onlooker_.wait_progress(others), testing::IsEmpty())
        << "these programs make no progress";
    EXPECT_EQ(onlooker_.num_faults(), 0U);
}

TEST_F(Restart, KilledSiteReturnsWhileOthersContinue) {
    for (int round = 0; round < num_rounds() && !HasFailure(); ++round) {
        kill_and_restart("alice",
                         "published id=",
                         {{kWorld, "site_left site=alice", "site_arrived site=alice"},
                          {"wall", "person_gone site=alice", "person_shown site=alice"}});
    }
    print_times("site");
}

TEST_F(Restart, SecondSiteOfTheNameIsRefusedAndTheFirstContinues) {
    const int num_gone = onlooker_.num_gone("alice");
    const std::size_t from = seen("wall");
    auto second = HostedProcess::start(command_of("alice"));
    ASSERT_TRUE(second) << second.error().message;
    EXPECT_EQ((*second)->wait(kPatience), 2) << (*second)->output();
    EXPECT_THAT((*second)->output(), testing::HasSubstr("site 'alice'"));
    EXPECT_THAT((*second)->output(), testing::HasSubstr("pid "));
    EXPECT_THAT(onlooker_.wait_progress({"alice", "bob", "wall", kWorld}), testing::IsEmpty());
    EXPECT_EQ(onlooker_.num_gone("alice"), num_gone) << "the first site was lost";
    EXPECT_EQ(programs_["wall"]->output().find("person_gone", from), std::string::npos);
}

TEST_F(Restart, KilledWorldServerReturnsWhileOthersContinue) {
    for (int round = 0; round < num_rounds() && !HasFailure(); ++round) {
        kill_and_restart(
            kWorld,
            "running world=",
            {{kWorld, "", "site_arrived site=alice"}, {kWorld, "", "site_arrived site=bob"}});
    }
    print_times("world server");
}

TEST_F(Restart, KilledViewerReturnsWhileOthersContinue) {
    for (int round = 0; round < num_rounds() && !HasFailure(); ++round) {
        kill_and_restart(
            "wall",
            "surface_open",
            {{"wall", "", "person_shown site=alice"}, {"wall", "", "person_shown site=bob"}});
    }
    print_times("viewer");
}

}  // namespace
}  // namespace atrium::test
