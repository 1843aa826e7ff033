#pragma once

#include "core/base/timestamp.hpp"

#include <dds/security/dds_security_api_authentication.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>

/// What the wrapped functions of Cyclone's authentication share. Private to authentication*.cpp.
namespace atrium::bus::authentication {

using Plugin = dds_security_authentication;
using Identity = DDS_Security_IdentityHandle;
using Handshake = DDS_Security_HandshakeHandle;

/// A program whose handshake has ended well.
struct Peer {
    std::string name;  // "viewer bob"
    std::string world;
    std::string serial;  // of its certificate
    Timestamp end;       // of its validity
};

/// One loaded plugin: that of a domain.
struct Instance {
    Plugin original{};  // Cyclone's functions
    const dds_security_authentication_listener* listener = nullptr;
    std::map<Identity, std::string> guids;     // of remote identities, as Cyclone logs them
    std::map<Handshake, Identity> handshakes;  // with remote identities
    std::map<Identity, Peer> peers;
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

struct Process {
    int (*init)(const char*, void**, void*) = nullptr;  // of Cyclone's plugin
    int (*finalize)(void*) = nullptr;
    std::string path;  // of ours; empty: not installed
    std::mutex mutex;  // guards all; never held during a call of Cyclone
    std::map<const Plugin*, Instance> instances;
    std::map<std::string, std::set<std::string>> refused;  // serial numbers by world
    HandshakeBudget budget;
};

/// Never destroyed: threads of Cyclone may use it until the process ends.
Process& process();

/// A GUID prefix as Cyclone logs it: three numbers of four bytes.
std::string guid_text(const std::uint8_t* prefix);

void log_cut(const std::string& who, const std::string& why);

/// The functions of our plugin (authentication_plugin.cpp).
int init(const char* argument, void** context, void* domain);
int finalize(void* context);

}  // namespace atrium::bus::authentication
