#include "core/bus/authentication.hpp"

#include "core/bus/dds_log.hpp"
#include "core/keys/certificates.hpp"
#include "core/keys/member.hpp"

#include <dds/dds.h>
#include <dds/security/dds_security_api_authentication.h>
#include <dlfcn.h>
#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

namespace atrium::bus {
namespace {

using Plugin = dds_security_authentication;
using Result = DDS_Security_ValidationResult_t;
using Exception = DDS_Security_SecurityException;
using Identity = DDS_Security_IdentityHandle;
using Handshake = DDS_Security_HandshakeHandle;

constexpr const char* kOurPlugin = "libatrium_authentication.so";
constexpr const char* kCyclonesPlugin = "libdds_security_auth.so";

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

struct Process {
    int (*init)(const char*, void**, void*) = nullptr;  // of Cyclone's plugin
    int (*finalize)(void*) = nullptr;
    std::string path;  // of ours; empty: not installed
    std::mutex mutex;  // guards all; never held during a call of Cyclone
    std::map<const Plugin*, Instance> instances;
    std::map<std::string, std::set<std::string>> refused;  // serial numbers by world
};

// Never destroyed: threads of Cyclone may use it until the process ends.
Process& process() {
    static auto* const all = new Process;
    return *all;
}

// As Cyclone logs it: three numbers of four bytes.
std::string guid_text(const std::uint8_t* prefix) {
    const auto word = [prefix](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value = value << 8U | prefix[at + i];
        return value;
    };
    return fmt::format("{:x}:{:x}:{:x}", word(0), word(4), word(8));
}

// The binary property of a token; it is from the network.
std::string binary_property(const DDS_Security_DataHolder& token, std::string_view name) {
    for (std::uint32_t i = 0; i < token.binary_properties._length; ++i) {
        const auto& property = token.binary_properties._buffer[i];
        if (property.name != nullptr && property.name == name)
            return {reinterpret_cast<const char*>(property.value._buffer), property.value._length};
    }
    return {};
}

std::string text_property(const DDS_Security_DataHolder& token, std::string_view name) {
    for (std::uint32_t i = 0; i < token.properties._length; ++i) {
        const auto& property = token.properties._buffer[i];
        if (property.name != nullptr && property.name == name && property.value != nullptr)
            return property.value;
    }
    return {};
}

// Of a certificate as a peer sends it, with or without a zero at its end.
std::optional<Peer> peer_of(std::string certificate) {
    while (!certificate.empty() && certificate.back() == '\0') certificate.pop_back();
    const auto facts = keys::facts_of_certificate(certificate);
    if (!facts) return std::nullopt;
    const auto member = keys::member_of_subject(facts->subject);
    if (!member) return std::nullopt;
    return Peer{fmt::format("{} {}", keys::kind_text(member->kind), member->name),
                member->world,
                facts->serial,
                facts->validity.end};
}

void log_refusal(const std::string& who, const std::string& why) {
    std::string line = why.substr(0, 200);
    for (char& c : line)
        if (c < ' ' || c > '~' || c == '"') c = ' ';
    DdsLog::of_process().add(fmt::format("keys {} {}", who, line.substr(0, 40)),
                             fmt::format("refused peer=\"{}\" reason=\"{}\"", who, line));
}

void log_cut(const std::string& who, const std::string& why) {
    const std::string line = fmt::format("cut_off peer=\"{}\" reason=\"{}\"", who, why);
    DdsLog::of_process().add(line, line);
}

const Plugin& original_of(const Plugin* plugin) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    return all.instances.at(plugin).original;  // stays until the plugin is finalised
}

Result validate_remote_identity(Plugin* plugin,
                                Identity* remote,
                                DDS_Security_AuthRequestMessageToken* local_request,
                                const DDS_Security_AuthRequestMessageToken* remote_request,
                                Identity local,
                                const DDS_Security_IdentityToken* token,
                                const DDS_Security_GUID_t* guid,
                                Exception* exception) {
    const Result result = original_of(plugin).validate_remote_identity(
        plugin, remote, local_request, remote_request, local, token, guid, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED) {
        log_refusal("program " + guid_text(guid->prefix),
                    exception->message == nullptr ? "it proves no key" : exception->message);
        return result;
    }
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    all.instances.at(plugin).guids[*remote] = guid_text(guid->prefix);
    return result;
}

Result begin_handshake_request(Plugin* plugin,
                               Handshake* handshake,
                               DDS_Security_HandshakeMessageToken* message,
                               Identity local,
                               Identity remote,
                               const DDS_Security_OctetSeq* participant,
                               Exception* exception) {
    const Result result = original_of(plugin).begin_handshake_request(
        plugin, handshake, message, local, remote, participant, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED) return result;
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    all.instances.at(plugin).handshakes[*handshake] = remote;
    return result;
}

std::string claimed_name(const DDS_Security_HandshakeMessageToken& message) {
    const auto claim = peer_of(binary_property(message, "c.id"));
    return claim ? fmt::format("{} of world {}, by its own words", claim->name, claim->world)
                 : std::string("a program without keys of Atrium");
}

std::string reason_of(const Exception* exception) {
    return exception == nullptr || exception->message == nullptr ? "the handshake failed"
                                                                 : exception->message;
}

Result begin_handshake_reply(Plugin* plugin,
                             Handshake* handshake,
                             DDS_Security_HandshakeMessageToken* reply,
                             const DDS_Security_HandshakeMessageToken* request,
                             Identity remote,
                             Identity local,
                             const DDS_Security_OctetSeq* participant,
                             Exception* exception) {
    const Result result = original_of(plugin).begin_handshake_reply(
        plugin, handshake, reply, request, remote, local, participant, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED) {
        log_refusal(claimed_name(*request), reason_of(exception));
        return result;
    }
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    all.instances.at(plugin).handshakes[*handshake] = remote;
    return result;
}

std::optional<Peer> authenticated_peer(Plugin* plugin, Handshake handshake) {
    const Plugin& original = original_of(plugin);
    DDS_Security_AuthenticatedPeerCredentialToken token{};
    Exception exception{};
    if (!original.get_authenticated_peer_credential_token(plugin, &token, handshake, &exception))
        return std::nullopt;
    auto peer = peer_of(text_property(token, "c.id"));
    original.return_authenticated_peer_credential_token(plugin, &token, &exception);
    return peer;
}

Result refuse(const std::string& who, const std::string& why, Exception* exception) {
    log_refusal(who, why);
    exception->message = dds_string_dup(why.c_str());
    exception->code = 1;
    exception->minor_code = 0;
    return DDS_SECURITY_VALIDATION_FAILED;
}

Result process_handshake(Plugin* plugin,
                         DDS_Security_HandshakeMessageToken* reply,
                         const DDS_Security_HandshakeMessageToken* message,
                         Handshake handshake,
                         Exception* exception) {
    const Result result =
        original_of(plugin).process_handshake(plugin, reply, message, handshake, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED)
        log_refusal(claimed_name(*message), reason_of(exception));
    if (result != DDS_SECURITY_VALIDATION_OK && result != DDS_SECURITY_VALIDATION_OK_FINAL_MESSAGE)
        return result;
    auto peer = authenticated_peer(plugin, handshake);
    if (!peer)
        return refuse(
            "a program without keys of Atrium", "its certificate has no member", exception);
    Process& all = process();
    bool is_refused = false;
    {
        const std::lock_guard lock(all.mutex);
        is_refused = all.refused[peer->world].contains(peer->serial);
        Instance& instance = all.instances.at(plugin);
        const auto remote = instance.handshakes.find(handshake);
        if (!is_refused && remote != instance.handshakes.end())
            instance.peers.insert_or_assign(remote->second, *peer);
    }
    return is_refused ? refuse(peer->name, "its key is revoked", exception) : result;
}

DDS_Security_boolean return_handshake_handle(Plugin* plugin,
                                             Handshake handshake,
                                             Exception* exception) {
    {
        Process& all = process();
        const std::lock_guard lock(all.mutex);
        all.instances.at(plugin).handshakes.erase(handshake);
    }
    return original_of(plugin).return_handshake_handle(plugin, handshake, exception);
}

DDS_Security_boolean return_identity_handle(Plugin* plugin,
                                            Identity identity,
                                            Exception* exception) {
    {
        Process& all = process();
        const std::lock_guard lock(all.mutex);
        Instance& instance = all.instances.at(plugin);
        // Cyclone cuts it off without a word.
        const auto peer = instance.peers.find(identity);
        if (peer != instance.peers.end() && Timestamp::now() >= peer->second.end)
            log_cut(peer->second.name, "its key has expired");
        instance.peers.erase(identity);
        instance.guids.erase(identity);
    }
    return original_of(plugin).return_identity_handle(plugin, identity, exception);
}

DDS_Security_boolean set_listener(Plugin* plugin,
                                  const dds_security_authentication_listener* listener,
                                  Exception* exception) {
    {
        Process& all = process();
        const std::lock_guard lock(all.mutex);
        all.instances.at(plugin).listener = listener;
    }
    return original_of(plugin).set_listener(plugin, listener, exception);
}

int init(const char* argument, void** context, void* domain) {
    Process& all = process();
    const int result = all.init(argument, context, domain);
    if (result != 0 || *context == nullptr) return result;
    auto* plugin = static_cast<Plugin*>(*context);
    {
        const std::lock_guard lock(all.mutex);
        all.instances[plugin].original = *plugin;
    }
    plugin->validate_remote_identity = validate_remote_identity;
    plugin->begin_handshake_request = begin_handshake_request;
    plugin->begin_handshake_reply = begin_handshake_reply;
    plugin->process_handshake = process_handshake;
    plugin->return_handshake_handle = return_handshake_handle;
    plugin->return_identity_handle = return_identity_handle;
    plugin->set_listener = set_listener;
    return result;
}

int finalize(void* context) {
    Process& all = process();
    auto* plugin = static_cast<Plugin*>(context);
    {
        const std::lock_guard lock(all.mutex);
        if (const auto found = all.instances.find(plugin); found != all.instances.end()) {
            *plugin = found->second.original;
            all.instances.erase(found);
        }
    }
    return all.finalize(context);
}

// Beside Cyclone's library, where Debian and others put the plugins.
std::filesystem::path cyclones_plugin() {
    Dl_info info{};
    const auto address = reinterpret_cast<const void*>(&dds_create_domain);
    if (::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
    std::error_code error;
    const auto folder = std::filesystem::canonical(info.dli_fname, error).parent_path();
    for (const char* beside : {"libddsc0debian", "."}) {
        const auto file = folder / beside / kCyclonesPlugin;
        if (std::filesystem::exists(file, error)) return file;
    }
    return {};
}

// In the next folder lib/atrium upwards from the program: /usr/lib/atrium, or that of the build.
std::filesystem::path our_plugin() {
    std::error_code error;
    auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    while (!error && folder.has_relative_path()) {
        const auto file = folder / "lib" / "atrium" / kOurPlugin;
        if (std::filesystem::exists(file, error)) return file;
        folder = folder.parent_path();
    }
    return {};
}

tl::unexpected<Error> not_loaded(const std::string& what) {
    return make_error(
        ErrorKind::kNotFound,
        fmt::format("cannot encrypt: {}; install Atrium and libddsc0debian again", what));
}

template <typename Function>
Function* symbol(void* library, const char* name) {
    return reinterpret_cast<Function*>(::dlsym(library, name));
}

}  // namespace

Expected<std::string> install_authentication() {
    static std::mutex installing;
    const std::lock_guard lock(installing);
    Process& all = process();
    if (!all.path.empty()) return all.path;
    const auto theirs = cyclones_plugin();
    if (theirs.empty())
        return not_loaded(fmt::format("{} is not beside libddsc.so", kCyclonesPlugin));
    const auto ours = our_plugin();
    if (ours.empty())
        return not_loaded(
            fmt::format("{} is in no folder lib/atrium above the program", kOurPlugin));
    // Both stay loaded until the process ends: Cyclone's threads may be in them.
    void* const their_library = ::dlopen(theirs.c_str(), RTLD_NOW);
    if (their_library == nullptr) return not_loaded(::dlerror());
    void* const our_library = ::dlopen(ours.c_str(), RTLD_NOW);
    if (our_library == nullptr) return not_loaded(::dlerror());
    all.init = symbol<int(const char*, void**, void*)>(their_library, "init_authentication");
    all.finalize = symbol<int(void*)>(their_library, "finalize_authentication");
    auto* const set = symbol<void(decltype(&init), decltype(&finalize))>(
        our_library, "atrium_set_authentication");
    if (all.init == nullptr || all.finalize == nullptr || set == nullptr)
        return not_loaded("the plugins are of other versions");
    set(&init, &finalize);
    all.path = ours.string();
    return all.path;
}

void refuse_keys(const std::string& world, const std::set<std::string>& serials) {
    struct Cut {
        const dds_security_authentication_listener* listener;
        const Plugin* plugin;
        Identity identity;
        std::string name;
    };
    std::vector<Cut> cuts;
    Process& all = process();
    {
        const std::lock_guard lock(all.mutex);
        all.refused[world].insert(serials.begin(), serials.end());
        for (const auto& [plugin, instance] : all.instances) {
            for (const auto& [identity, peer] : instance.peers) {
                if (peer.world == world && serials.contains(peer.serial))
                    cuts.push_back({instance.listener, plugin, identity, peer.name});
            }
        }
    }
    for (const Cut& cut : cuts) {
        log_cut(cut.name, "its key is revoked");
        if (cut.listener != nullptr) cut.listener->on_revoke_identity(cut.plugin, cut.identity);
    }
}

std::string proven_name(const dds_guid_t& participant) {
    return proven_name_in(guid_text(participant.v));
}

std::string proven_name_in(const std::string& line) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    for (const auto& [plugin, instance] : all.instances) {
        for (const auto& [identity, peer] : instance.peers) {
            const auto guid = instance.guids.find(identity);
            if (guid != instance.guids.end() && line.find(guid->second) != std::string::npos)
                return peer.name;
        }
    }
    return {};
}

}  // namespace atrium::bus
