#include "core/bus/key_watch.hpp"

#include "core/base/process_threads.hpp"
#include "core/bus/authentication.hpp"
#include "core/bus/bundle_change.hpp"
#include "core/bus/dds_log.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/peer_leases.hpp"
#include "core/keys/certificates.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <ctime>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace atrium::bus {
namespace {

constexpr std::chrono::milliseconds kLookAtFile{500};
constexpr std::chrono::hours kSoon{30 * 24};
constexpr std::chrono::seconds kSignOfLife{4};
constexpr std::chrono::seconds kIgnored{10};
constexpr std::size_t kMaxKnown = 256;
using Clock = std::chrono::steady_clock;

void log_line(const std::string& line) { DdsLog::of_process().add(line, line); }

// Of the last change of content, mode or name; a zero if there is no file.
std::pair<std::time_t, long> change_of_file(const std::string& file) {
    struct stat info {};
    if (::stat(file.c_str(), &info) != 0) return {};
    return {info.st_ctim.tv_sec, info.st_ctim.tv_nsec};
}

// Cyclone's threads for announcements step back behind the people: in a flood of strangers they
// use what is left of the processor. What they do not get to is dropped in the socket.
// "dq.builtins" takes announcements in; "recv" reads their ports, and all ports unless "recvUC"
// reads the data's.
void put_discovery_behind() {
    constexpr int kSteps = 10;
    static std::once_flag once;
    std::call_once(once, [] {
        std::map<std::string, id_t> threads;
        std::error_code failure;
        for (const ProcessThread& thread : process_threads(failure))
            threads[thread.name] = static_cast<id_t>(thread.id);
        if (!threads.contains("recvUC")) threads.erase("recv");
        for (const char* name : {"dq.builtins", "recv"})
            if (const auto thread = threads.find(name); thread != threads.end())
                static_cast<void>(
                    ::setpriority(PRIO_PROCESS,
                                  thread->second,
                                  ::getpriority(PRIO_PROCESS, thread->second) + kSteps));
    });
}

}  // namespace

struct KeyWatch::Impl {
    std::string file;
    std::shared_ptr<const keys::Bundle> bundle;
    keys::CertificateFacts own;
    std::pair<std::time_t, long> file_change;
    std::string complaint;  // about the file; empty: it is good
    std::set<std::string> serials;
    std::optional<Reader<RevokedKeys>> reader;
    std::optional<Writer<RevokedKeys>> writer;
    std::string longest;  // list that is known
    std::size_t num_in_longest = 0;
    std::set<std::size_t> known;                       // hashes of good lists
    std::map<std::string, Clock::time_point> ignored;  // senders of bad lists, until when
    Clock::time_point next_publish;
    std::optional<Waiter> waiter;
    std::optional<PeerLeases> leases;
    bool has_expired = false;
    std::jthread thread;  // last: ends before the rest goes

    Expected<void> open(const Participant& participant);
    bool use(const std::string& crl, const std::string& from);
    void take(const RevokedKeys& list);
    void publish();
    void look_at_file();
    std::string complaint_about_file();
    void look_at_own_key();
    void serve(std::stop_token stop);
};

Expected<void> KeyWatch::Impl::open(const Participant& participant) {
    const auto facts = keys::facts_of_certificate(bundle->certificate);
    if (!facts) return tl::unexpected(facts.error());
    own = *facts;
    file_change = change_of_file(file);
    auto made_leases = PeerLeases::create(participant.impl()->participant.get());
    if (!made_leases) return tl::unexpected(made_leases.error());
    leases = std::move(*made_leases);
    auto made_reader = Reader<RevokedKeys>::create(participant);
    if (!made_reader) return tl::unexpected(made_reader.error());
    reader = std::move(*made_reader);
    auto made_waiter = Waiter::create(participant);
    if (!made_waiter) return tl::unexpected(made_waiter.error());
    waiter = std::move(*made_waiter);
    waiter->add(*reader);
    auto made_writer = Writer<RevokedKeys>::create(participant);
    if (!made_writer) return tl::unexpected(made_writer.error());
    writer = std::move(*made_writer);
    return {};
}

void KeyWatch::Impl::publish() {
    next_publish = Clock::now() + kSignOfLife;
    const keys::Member& self = bundle->member;
    const RevokedKeys list{self.kind == keys::Kind::kWorld ? self.world : self.name,
                           {longest.begin(), longest.end()}};
    if (const auto written = writer->write(list); !written)
        log_line(fmt::format("keys_not_published reason=\"{}\"", written.error().message));
}

// From another program, who may be hostile: a signature is checked only if it may be news.
void KeyWatch::Impl::take(const RevokedKeys& list) {
    const std::string crl(list.crl.begin(), list.crl.end());
    const auto now = Clock::now();
    std::erase_if(ignored, [now](const auto& one) { return one.second <= now; });
    if (known.contains(std::hash<std::string>{}(crl)) || ignored.contains(list.sender)) return;
    if (!use(crl, list.sender)) ignored[list.sender] = now + kIgnored;
}

// False if it is no list of this world's authority.
bool KeyWatch::Impl::use(const std::string& crl, const std::string& from) {
    const auto revoked = keys::read_crl(crl, bundle->identity_ca);
    if (!revoked) {
        log_line(
            fmt::format("keys_not_taken from=\"{}\" reason=\"{}\"", from, revoked.error().message));
        return false;
    }
    if (known.size() >= kMaxKnown) known.clear();
    known.insert(std::hash<std::string>{}(crl));
    const bool is_first = longest.empty();  // of the own bundle, at the start: no news
    if (is_first || revoked->size() > num_in_longest) {
        longest = crl;
        num_in_longest = revoked->size();
    }
    std::set<std::string> added;
    for (const keys::Revocation& entry : *revoked)
        if (serials.insert(entry.serial).second) added.insert(entry.serial);
    if (added.empty()) return true;
    refuse_keys(bundle->member.world, added);
    if (!is_first)
        log_line(fmt::format(
            "revoked_keys new={} all={} from=\"{}\"", added.size(), serials.size(), from));
    if (added.contains(own.serial))
        log_line(
            "own_key_revoked others cut this program off; if it shall go on, its owner runs "
            "`atrium keys renew` and exports a new bundle");
    return true;
}

void KeyWatch::Impl::look_at_file() {
    const auto change = change_of_file(file);
    if (change == file_change) return;
    file_change = change;
    const std::string before = std::exchange(complaint, complaint_about_file());
    if (complaint == before) return;
    log_line(complaint.empty() ? fmt::format("bundle_good_again file={}", file) : complaint);
}

// Takes the list of revoked keys from the file, too.
std::string KeyWatch::Impl::complaint_about_file() {
    const auto now = keys::read_bundle(file);
    if (!now) {
        file_change = {};  // it may be half copied: again at the next look
        return fmt::format("bundle_not_read reason=\"{}\"", now.error().message);
    }
    if (now->identity_ca == bundle->identity_ca) {
        use(now->crl, file);
        publish();
    }
    return complaint_about(*now, *bundle, file);
}

void KeyWatch::Impl::look_at_own_key() {
    if (has_expired || Timestamp::now() < own.validity.end) return;
    has_expired = true;
    log_line(
        fmt::format("own_key_expired at={} others cut this program off: its owner runs "
                    "`atrium keys renew {}`, exports a new bundle, and starts it again",
                    keys::time_text(own.validity.end),
                    bundle->member.name));
}

void KeyWatch::Impl::serve(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { waiter->wake(); });
    put_discovery_behind();
    use(bundle->crl, file);
    if (own.validity.end - Timestamp::now() < kSoon)
        log_line(
            fmt::format("own_key_expires at={} its owner runs `atrium keys renew {}` and "
                        "exports a new bundle before",
                        keys::time_text(own.validity.end),
                        bundle->member.name));
    while (!stop.stop_requested()) {
        waiter->wait(kLookAtFile);
        reader->take([this](RevokedKeys&& list) { take(list); });
        look_at_file();
        look_at_own_key();
        leases->look();
        if (Clock::now() >= next_publish) publish();
    }
}

KeyWatch::KeyWatch(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

KeyWatch::~KeyWatch() = default;

Expected<std::shared_ptr<KeyWatch>> KeyWatch::start(const Participant& participant,
                                                    const std::string& file,
                                                    std::shared_ptr<const keys::Bundle> bundle) {
    auto impl = std::make_unique<Impl>();
    impl->file = file;
    impl->bundle = std::move(bundle);
    if (auto opened = impl->open(participant); !opened) return tl::unexpected(opened.error());
    Impl& self = *impl;
    auto watch = std::make_shared<KeyWatch>(std::move(impl));
    self.thread = std::jthread([&self](std::stop_token stop) { self.serve(stop); });
    pthread_setname_np(self.thread.native_handle(), "keys");
    return watch;
}

}  // namespace atrium::bus
