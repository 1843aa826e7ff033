#pragma once

#include "core/base/timestamp.hpp"

#include <dds/dds.h>
#include <dds/security/dds_security_api_authentication.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>
#include <string>
#include <unordered_map>

/// What the wrapped functions of Cyclone's plugins share. Private to authentication*.cpp,
/// crypto_calls.cpp and peer_leases.cpp.
namespace atrium::bus::authentication {

using Plugin = dds_security_authentication;
using Identity = DDS_Security_IdentityHandle;
using Handshake = DDS_Security_HandshakeHandle;

inline constexpr const char* kRevoked = "its key is revoked";
inline constexpr const char* kExpired = "its key has expired";

/// A program whose handshake has ended well.
struct Peer {
    std::string name;  // "viewer bob"
    std::string world;
    std::string serial;  // of its certificate
    Timestamp end;       // of its validity
};

struct Remote {
    dds_guid_t participant{};
    std::string text;  // of its prefix, as Cyclone logs it
    bool is_refused = false;
};

/// One loaded plugin: that of a domain.
struct Instance {
    Plugin original{};  // Cyclone's functions
    std::uint32_t domain = 0;
    const dds_security_authentication_listener* listener = nullptr;
    std::map<Identity, Remote> remotes;
    std::unordered_multimap<std::string, Identity> by_text;  // of `remotes`: there may be many
    std::map<Handshake, Identity> handshakes;                // with remote identities
    std::map<Identity, Peer> peers;

    void forget(Identity remote) {
        const auto found = remotes.find(remote);
        if (found == remotes.end()) return;
        const auto alike = by_text.equal_range(found->second.text);
        for (auto one = alike.first; one != alike.second;)
            one = one->second == remote ? by_text.erase(one) : std::next(one);
        remotes.erase(found);
    }
};

/// Limits the handshakes, each of which costs signatures, to a share of a core: strangers can ask
/// for any number. Those beyond it are tried again after a second.
class HandshakeBudget {
public:
    bool take() {
        const auto now = std::chrono::steady_clock::now();
        const double passed_s = std::chrono::duration<double>(now - counted_).count();
        counted_ = now;
        left_ = std::min(kAtOnce, left_ + kPerSecond * passed_s);
        if (left_ < 1.0) return false;
        left_ -= 1.0;
        return true;
    }

private:
    static constexpr double kAtOnce = 100.0;  // programs that all start together
    static constexpr double kPerSecond = 60.0;
    double left_ = kAtOnce;
    std::chrono::steady_clock::time_point counted_ = std::chrono::steady_clock::now();
};

/// When each peer with proven keys last sent something that its keys decrypt. Announcements are in
/// the clear, so they say nothing of it. Thread-safe; `note` is called for each datagram.
class HeardPeers {
public:
    using Clock = std::chrono::steady_clock;
    using Crypto = std::int64_t;  // Cyclone's handle of a peer's keys

    void add(Crypto peer, Identity identity) {
        const std::lock_guard lock(mutex_);
        Peer& added = peers_[peer];
        added.identity = identity;
        added.heard = Clock::now();
    }
    void note(Crypto peer) {
        const std::shared_lock lock(mutex_);
        const auto found = peers_.find(peer);
        if (found == peers_.end()) return;
        found->second.heard = Clock::now();
        found->second.was_heard = true;
    }
    void remove(Crypto peer) {
        const std::lock_guard lock(mutex_);
        peers_.erase(peer);
    }
    /// Peers that are silent since `time`, and whether they were heard before. Of several keys of
    /// one peer (for several participants of this process) one is enough.
    std::map<Identity, bool> silent_since(Clock::time_point time) const {
        const std::shared_lock lock(mutex_);
        std::map<Identity, bool> silent;
        std::set<Identity> heard;
        for (const auto& [crypto, peer] : peers_) {
            if (peer.heard.load() >= time)
                heard.insert(peer.identity);
            else
                silent[peer.identity] |= peer.was_heard.load();
        }
        for (const Identity one : heard) silent.erase(one);
        return silent;
    }

private:
    struct Peer {
        Identity identity = DDS_SECURITY_HANDLE_NIL;
        std::atomic<Clock::time_point> heard;  // or the handshake, before the first time
        std::atomic<bool> was_heard = false;
    };
    mutable std::shared_mutex mutex_;
    std::map<Crypto, Peer> peers_;
};

/// A plugin is made and ended by two functions of its library.
using Init = int (*)(const char* argument, void** context, void* domain);
using Finalize = int (*)(void* context);

struct Process {
    // of Cyclone's plugins for authentication and encryption
    std::array<Init, 2> init{};
    std::array<Finalize, 2> finalize{};
    std::string path;  // of ours; empty: not installed
    std::mutex mutex;  // guards all; never held during a call of Cyclone
    std::map<const Plugin*, Instance> instances;
    std::map<std::string, std::set<std::string>> refused;  // serial numbers by world
    std::map<std::string, std::string> refusals;           // of participants by GUID: who and why
    HandshakeBudget budget;
    HeardPeers heard;  // has a lock of its own
};

/// Never destroyed: threads of Cyclone may use it until the process ends.
Process& process();

/// A GUID prefix as Cyclone logs it: three numbers of four bytes.
std::string guid_text(const std::uint8_t* prefix);

void log_cut(const std::string& who, const std::string& why);

/// Keeps who is behind a GUID (guid_text) and why it was refused, for `refusal_of`. The caller
/// holds `Process::mutex`.
void note_refusal(const std::string& guid, const std::string& who, const std::string& why);

/// A reason of Cyclone or OpenSSL in plain words, as far as it is known.
std::string plain_reason(const std::string& reason);

/// The functions of our plugins (security_plugin.cpp).
int init(const char* argument, void** context, void* domain);
int finalize(void* context);
int init_crypto(const char* argument, void** context, void* domain);
int finalize_crypto(void* context);

}  // namespace atrium::bus::authentication
