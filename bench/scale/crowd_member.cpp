#include "bench/scale/crowd_member.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "core/presence/join_world.hpp"

#include <condition_variable>
#include <mutex>

// A program that is only present, like a small observer: Presence, and readers of descriptions and
// statuses.
int main(int argc, char** argv) {
    using namespace atrium;
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    std::string name = "member";
    std::uint32_t members = 0;
    config::OptionSet options;
    bus::declare(bus_options, options);
    options.add("name", name, "name in the world");
    options.add("members", members, "how many programs there will be; 0: does not matter");
    const app::Start start = app::start({.name = "crowd_member",
                                         .summary = "Is there.",
                                         .examples = "  crowd_member --name a --members 100\n"},
                                        options,
                                        argc,
                                        argv);
    if (!start.go_on) return start.exit_code;
    const auto participant = bus::Participant::create(bus_options);
    if (!participant) return app::fail(participant.error());
    const auto descriptions = bus::Reader<bus::SiteDescription>::create(*participant);
    if (!descriptions) return app::fail(descriptions.error());
    const auto statuses = bus::Reader<bus::SiteStatus>::create(*participant);
    if (!statuses) return app::fail(statuses.error());
    const auto membership = presence::join_world(
        *participant,
        bus::ProgramKind::kOther,
        name,
        [](const Error& lost) { app::log::warn("{}", lost.message); },
        stop.token());
    if (!membership) return app::fail(membership.error());
    const bench::SayWhenAllAreThere watch(**membership, members);
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait(lock, stop.token(), [] { return false; });
    return 0;
}
