#include "core/presence/membership.hpp"

#include "core/bus/limits.hpp"
#include "core/presence/clock_watch.hpp"
#include "core/presence/kernel_clock.hpp"
#include "core/presence/name_claim.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <tuple>
#include <utility>

namespace atrium::presence {

namespace {

using bus::Participant;
using bus::Presence;
using Clock = NameClaim::Clock;
constexpr std::chrono::milliseconds kLook{1000};    // period of the search for incompatible peers
constexpr std::chrono::milliseconds kJoinStep{20};  // longest wait while the name is claimed
constexpr std::chrono::seconds kRefresh{10};        // period of Presence: it has the clock's state
constexpr std::chrono::seconds kAlone{5};           // time for others to be found
constexpr std::size_t kMaxPresent = 4096;           // limit on data from untrusted senders

using Key = std::tuple<bus::ProgramKind, std::string, std::uint64_t>;
Key key_of(const Presence& presence) { return {presence.kind, presence.name, presence.instance}; }

std::uint64_t draw_instance() {
    std::random_device device;
    return std::uint64_t{device()} << 32U | device();
}

void read_clock(Presence& presence) {
    const KernelClock clock = kernel_clock();
    presence.is_clock_synchronised = clock.is_synchronised;
    presence.clock_max_error = clock.max_error;
}

}  // namespace

std::string host_name() {
    std::array<char, 256> name{};
    ::gethostname(name.data(), name.size() - 1);
    std::string text(name.data());
    for (char& c : text) {
        const bool is_allowed = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                                (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
        if (!is_allowed) c = '-';
    }
    text.resize(std::min(text.size(), bus::kMaxNameLength));
    return text.empty() ? "unknown" : text;
}

struct Membership::Impl {
    Impl(Participant joined, const MembershipOptions& options, MembershipEvents callbacks)
        : participant(std::move(joined)), events(std::move(callbacks)), own(make_own(options)) {}

    static Presence make_own(const MembershipOptions& options);
    Expected<void> open();
    Expected<void> claim(std::stop_token stop);
    void serve(std::stop_token stop);
    void take();
    void say_if_alone();
    Expected<void> announce();

    Participant participant;
    MembershipEvents events;
    Presence own;
    NameClaim name{own, Clock::now()};
    ClockWatch clocks;
    std::optional<bus::Writer<Presence>> writer;
    std::optional<bus::Reader<Presence>> reader;
    std::optional<bus::Waiter> waiter;
    mutable std::mutex mutex;  // guards `others` and changes of `own`
    std::map<Key, Presence> others;
    std::jthread thread;
};

Presence Membership::Impl::make_own(const MembershipOptions& options) {
    Presence own;
    own.kind = options.kind;
    own.name = options.name;
    own.instance = draw_instance();
    own.host = host_name();
    own.pid = static_cast<std::uint32_t>(::getpid());
    own.version = options.version;
    own.start_time = Timestamp::now();
    return own;
}

Expected<void> Membership::Impl::open() {
    auto made_writer = bus::Writer<Presence>::create(participant);
    if (!made_writer) return tl::unexpected(made_writer.error());
    writer = std::move(*made_writer);
    auto made_reader = bus::Reader<Presence>::create(participant);
    if (!made_reader) return tl::unexpected(made_reader.error());
    reader = std::move(*made_reader);
    auto made_waiter = bus::Waiter::create(participant);
    if (!made_waiter) return tl::unexpected(made_waiter.error());
    waiter = std::move(*made_waiter);
    waiter->add(*reader);
    return {};
}

Expected<void> Membership::Impl::announce() {
    {
        const std::lock_guard lock(mutex);
        ++own.num_written;
        read_clock(own);
    }
    const auto written = writer->write(own);
    if (!written) return tl::unexpected(written.error());
    return {};
}

void Membership::Impl::take() {
    const Clock::time_point now = Clock::now();
    const Timestamp arrived = Timestamp::now();
    reader->take_written(
        [&](Presence&& presence, Timestamp written) {
            if (presence.instance == own.instance) return;
            if (presence.host != own.host) {
                const auto line = clocks.see(presence.host, presence.instance, written, arrived);
                if (line) events.warn(*line);
            }
            name.see(presence, now);
            const std::lock_guard lock(mutex);
            if (others.size() < kMaxPresent || others.contains(key_of(presence)))
                others.insert_or_assign(key_of(presence), std::move(presence));
        },
        [&](const Presence& presence, bus::Ending /*how*/) {
            name.gone(presence);
            const std::lock_guard lock(mutex);
            others.erase(key_of(presence));
        });
}

Expected<void> Membership::Impl::claim(std::stop_token stop) {
    if (auto announced = announce(); !announced) return announced;
    bool has_said = false;
    while (!stop.stop_requested()) {
        waiter->wait(kJoinStep);
        take();
        const Clock::time_point now = Clock::now();
        const NameClaim::Verdict verdict = name.decide(now);
        const Presence* rival = name.rival();
        if (verdict == NameClaim::Verdict::kHold) {
            {
                const std::lock_guard lock(mutex);
                own.is_holder = true;
            }
            return announce();
        }
        if (verdict == NameClaim::Verdict::kRefused) {
            // those of hosts are in the site's file
            const bool is_of_host = own.kind == bus::ProgramKind::kCameraNode ||
                                    own.kind == bus::ProgramKind::kRegionNode;
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("the name is taken by {}; {}end that program",
                                          describe(*rival),
                                          is_of_host ? "" : "choose another name or "));
        }
        if (rival != nullptr && !std::exchange(has_said, true)) {
            events.info(fmt::format(
                "name_wait for=\"{}\" limit_ms={}", describe(*rival), NameClaim::kLease.count()));
        }
        if (verdict == NameClaim::Verdict::kWait && name.should_ask(now)) {
            if (auto announced = announce(); !announced) return announced;
        }
    }
    return make_error(ErrorKind::kUnavailable, "stopped while claiming the name");
}

// A viewer says so itself: it needs a world server or a site.
void Membership::Impl::say_if_alone() {
    {
        const std::lock_guard lock(mutex);
        if (!others.empty() || own.kind == bus::ProgramKind::kViewer) return;
    }
    const std::string place = participant.place();
    const bool has_neighbours = place.find("other_worlds=") != std::string::npos;
    const std::string line = fmt::format(
        "alone {} no other program of this world yet; world, domain and network must be the same "
        "in all programs, and all need keys of this world, or none; atrium doctor checks this "
        "host's network",
        place);
    has_neighbours ? events.warn(line) : events.info(line);
}

void Membership::Impl::serve(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { waiter->wake(); });
    const Clock::time_point begin = Clock::now();
    bool has_looked_around = false;
    Clock::time_point next_look = begin;
    Clock::time_point next_refresh = Clock::now() + kRefresh;
    bool is_lost = false;
    while (!stop.stop_requested()) {
        waiter->wait(kLook);
        take();
        const Clock::time_point now = Clock::now();
        if (name.decide(now) == NameClaim::Verdict::kRefused && !std::exchange(is_lost, true)) {
            events.name_lost(
                {ErrorKind::kConfiguration,
                 fmt::format("two programs hold this name; {} is older and keeps it, this one ends",
                             describe(*name.rival()))});
        }
        if (name.take_question() || now >= next_refresh) {
            next_refresh = now + kRefresh;
            if (auto announced = announce(); !announced) events.warn(announced.error().message);
        }
        if (now < next_look) continue;
        next_look = now + kLook;
        for (const std::string& line : participant.take_mismatches()) events.warn(line);
        for (const std::string& line : participant.take_dds_log()) events.warn(line);
        if (!has_looked_around && now - begin >= kAlone) {
            has_looked_around = true;
            say_if_alone();
        }
    }
}

Membership::Membership(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Membership::~Membership() {
    impl_->thread.request_stop();
    if (impl_->thread.joinable()) impl_->thread.join();
    static_cast<void>(impl_->writer->dispose(impl_->own));  // if it fails, the lease expires
}

Expected<std::unique_ptr<Membership>> Membership::join(const Participant& participant,
                                                       const MembershipOptions& options,
                                                       MembershipEvents events,
                                                       std::stop_token stop) {
    auto impl = std::make_unique<Impl>(participant, options, std::move(events));
    if (auto opened = impl->open(); !opened) return tl::unexpected(opened.error());
    std::unique_ptr<Membership> member(new Membership(std::move(impl)));
    if (auto claimed = member->impl_->claim(stop); !claimed) return tl::unexpected(claimed.error());
    Impl& self = *member->impl_;
    self.thread = std::jthread([&self](std::stop_token own) { self.serve(own); });
    pthread_setname_np(self.thread.native_handle(), "presence");
    return member;
}

std::vector<Presence> Membership::present() const {
    const std::lock_guard lock(impl_->mutex);
    std::vector<Presence> list{impl_->own};
    for (const auto& [key, presence] : impl_->others) list.push_back(presence);
    return list;
}

std::string Membership::place() const { return impl_->participant.place(); }

bus::OtherWorlds Membership::other_worlds() const { return impl_->participant.other_worlds(); }

}  // namespace atrium::presence
