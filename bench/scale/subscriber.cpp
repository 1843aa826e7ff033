#include "bench/scale/crowd_member.hpp"
#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "core/presence/join_world.hpp"
#include "viewer/receive/session.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <set>
#include <thread>

// A viewer without pictures. It receives, pairs and reports to the sites, and with --decode decodes
// people up to the data for a graphics card. Prints "sees N" once it has frames of N sites, and its
// results at the end: "frame SITE ID CAPTURE_NS COMPLETE_NS" and "person SITE CAPTURE_NS
// DECODED_NS".
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr auto kPicture = std::chrono::nanoseconds(1s) / 60;  // how often a viewer looks for people

template <typename T>
T value(Expected<T> expected) {
    if (expected) return std::move(*expected);
    std::exit(app::fail(expected.error()));
}

struct Arrival {
    std::string site;  // short: no allocation
    std::uint64_t id;
    std::int64_t capture_ns;
    std::int64_t arrived_ns;
};

class Subscriber {
public:
    Subscriber(const bus::BusOptions& options, const std::string& name, std::size_t num_sites)
        : session_(value(viewer::Session::create(options, name))), num_sites_(num_sites) {
        status_.viewer = name;
        frames_.reserve(1U << 16U);
        people_.reserve(1U << 16U);
        session_->on_complete([this](const viewer::FramePair& pair) { complete(pair.mesh); });
    }

    const bus::Participant& participant() const { return session_->participant(); }

    void run(bool decode, std::stop_token stop) {
        if (decode) session_->start_decoding();
        const std::jthread receiving([&](std::stop_token own) { session_->receive(own); });
        std::mutex mutex;
        std::condition_variable_any never;
        auto due = Clock::now();
        auto status_due = due;
        while (!stop.stop_requested()) {
            if (decode) take_people();
            if (Clock::now() >= status_due) {
                status_due = Clock::now() + 1s;
                tell();
            }
            due = std::max(due + (decode ? kPicture : std::chrono::nanoseconds(1s)), Clock::now());
            std::unique_lock lock(mutex);
            never.wait_until(lock, stop, due, [] { return false; });
        }
    }

    void report() const {
        for (const Arrival& a : frames_)
            fmt::print("frame {} {} {} {}\n", a.site, a.id, a.capture_ns, a.arrived_ns);
        for (const Arrival& a : people_)
            fmt::print("person {} {} {}\n", a.site, a.capture_ns, a.arrived_ns);
        fmt::print("rejected {}\n", session_->num_rejected());
    }

private:
    void complete(const bus::SiteMesh& mesh) {
        frames_.push_back({mesh.site, mesh.frame_id, mesh.capture_time.ns, Timestamp::now().ns});
        if (seen_.size() < num_sites_ && seen_.insert(mesh.site).second &&
            seen_.size() == num_sites_) {
            fmt::print("sees {}\n", num_sites_);
            std::fflush(stdout);
        }
    }

    void take_people() {
        for (auto& [site, update] : session_->take_people()) {
            if (!update.model) continue;
            people_.push_back({site, 0, update.capture_time.ns, Timestamp::now().ns});
            session_->recycle(std::move(*update.model));
        }
    }

    void tell() {
        status_.time = Timestamp::now();
        status_.num_pairs_shown = people_.size();
        status_.num_pairs_skipped = session_->num_pairs_skipped();
        status_.num_incomplete = session_->num_incomplete();
        status_.num_rejected = session_->num_rejected();
        status_.resident_bytes = app::resident_bytes();
        if (const auto sent = session_->publish(status_); !sent)
            app::log::warn("status_failed {}", sent.error().message);
    }

    std::unique_ptr<viewer::Session> session_;
    std::size_t num_sites_;
    bus::ViewerStatus status_;
    std::set<std::string> seen_;  // of the receiving thread, like the next one
    std::vector<Arrival> frames_;
    std::vector<Arrival> people_;
};

}  // namespace

int main(int argc, char** argv) {
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    std::string name = "subscriber";
    std::uint32_t sites = 1;
    std::uint32_t members = 0;
    bool decode = false;
    config::OptionSet options;
    bus::declare(bus_options, options);
    options.add("name", name, "name of the viewer");
    options.add("sites", sites, "how many sites there will be");
    options.add("members", members, "how many programs there will be; 0: does not matter");
    options.add("decode", decode, "decode what was received");
    const app::Start start =
        app::start({.name = "subscriber",
                    .summary = "Receives what sites publish as a viewer does, and draws nothing.",
                    .examples = "  subscriber --sites 4\n"},
                   options,
                   argc,
                   argv);
    if (!start.go_on) return start.exit_code;
    Subscriber subscriber(bus_options, name, sites);
    const auto membership = value(presence::join_world(
        subscriber.participant(),
        bus::ProgramKind::kViewer,
        name,
        [](const Error& lost) { app::log::warn("{}", lost.message); },
        stop.token()));
    const bench::SayWhenAllAreThere watch(*membership, members);
    subscriber.run(decode, stop.token());
    subscriber.report();
    return 0;
}
