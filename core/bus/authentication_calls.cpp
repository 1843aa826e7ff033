#include "core/bus/authentication_internal.hpp"
#include "core/bus/cyclone_entities.h"
#include "core/bus/dds_log.hpp"
#include "core/keys/certificates.hpp"
#include "core/keys/member.hpp"

#include <dds/dds.h>
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

// The functions that take the place of Cyclone's in its table. Each calls that of Cyclone.
namespace atrium::bus::authentication {
namespace {

using Result = DDS_Security_ValidationResult_t;
using Exception = DDS_Security_SecurityException;

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

// It may be from the network.
std::string quotable(const std::string& text) {
    std::string line = text.substr(0, 200);
    for (char& c : line)
        if (c < ' ' || c > '~' || c == '"') c = ' ';
    return line;
}

void log_refusal(const std::string& who, const std::string& why) {
    DdsLog::of_process().add(fmt::format("keys {} {}", who, why.substr(0, 40)),
                             fmt::format("refused peer=\"{}\" reason=\"{}\"", who, why));
}

// Notes that the keys of a program are refused, and logs it.
void refuse(const Plugin* plugin, Identity remote, const std::string& who, const std::string& why) {
    // a message of a handshake that has begun anew meanwhile: that one will end, or say why
    if (why.find("does not match future_challenge") != std::string::npos) return;
    const std::string plain = quotable(plain_reason(why));
    {
        Process& all = process();
        const std::lock_guard lock(all.mutex);
        auto& remotes = all.instances.at(plugin).remotes;
        if (const auto found = remotes.find(remote); found != remotes.end()) {
            found->second.is_refused = true;
            note_refusal(found->second.text, who, plain);
        }
    }
    log_refusal(who, plain);
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
                    quotable(exception->message == nullptr ? "it proves no key"
                                                           : plain_reason(exception->message)));
        return result;
    }
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    Instance& instance = all.instances.at(plugin);
    Remote& added = instance.remotes[*remote];
    static_assert(sizeof added.participant == sizeof *guid);
    std::memcpy(&added.participant, guid, sizeof *guid);
    added.text = guid_text(guid->prefix);
    instance.by_text.emplace(added.text, *remote);
    return result;
}

bool may_begin_handshake() {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    return all.budget.take();
}

Result begin_handshake_request(Plugin* plugin,
                               Handshake* handshake,
                               DDS_Security_HandshakeMessageToken* message,
                               Identity local,
                               Identity remote,
                               const DDS_Security_OctetSeq* participant,
                               Exception* exception) {
    if (!may_begin_handshake()) return DDS_SECURITY_VALIDATION_PENDING_RETRY;
    const Result result = original_of(plugin).begin_handshake_request(
        plugin, handshake, message, local, remote, participant, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED) return result;
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    all.instances.at(plugin).handshakes[*handshake] = remote;
    return result;
}

// The last message of a handshake has no certificate: then the program's GUID.
std::string claimed_name(const Plugin* plugin,
                         Identity remote,
                         const DDS_Security_HandshakeMessageToken& message) {
    if (const auto claim = peer_of(binary_property(message, "c.id")))
        return fmt::format("{} of world {}, by its own words", claim->name, claim->world);
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    const auto& remotes = all.instances.at(plugin).remotes;
    const auto found = remotes.find(remote);
    return found == remotes.end() ? "a program" : "program " + found->second.text;
}

Identity remote_of(const Plugin* plugin, Handshake handshake) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    const auto& handshakes = all.instances.at(plugin).handshakes;
    const auto remote = handshakes.find(handshake);
    return remote == handshakes.end() ? DDS_SECURITY_HANDLE_NIL : remote->second;
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
    if (!may_begin_handshake()) return DDS_SECURITY_VALIDATION_PENDING_RETRY;
    const Result result = original_of(plugin).begin_handshake_reply(
        plugin, handshake, reply, request, remote, local, participant, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED) {
        refuse(plugin, remote, claimed_name(plugin, remote, *request), reason_of(exception));
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

Result failure(const std::string& why, Exception* exception) {
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
    const Identity remote = remote_of(plugin, handshake);
    const Result result =
        original_of(plugin).process_handshake(plugin, reply, message, handshake, exception);
    if (result == DDS_SECURITY_VALIDATION_FAILED)
        refuse(plugin, remote, claimed_name(plugin, remote, *message), reason_of(exception));
    if (result != DDS_SECURITY_VALIDATION_OK && result != DDS_SECURITY_VALIDATION_OK_FINAL_MESSAGE)
        return result;
    auto peer = authenticated_peer(plugin, handshake);
    if (!peer) {
        const std::string why = "its certificate names no member of a world of Atrium";
        refuse(plugin, remote, claimed_name(plugin, remote, *message), why);
        return failure(why, exception);
    }
    Process& all = process();
    bool is_refused = false;
    {
        const std::lock_guard lock(all.mutex);
        is_refused = all.refused[peer->world].contains(peer->serial);
        Instance& instance = all.instances.at(plugin);
        if (!is_refused && remote != DDS_SECURITY_HANDLE_NIL)
            instance.peers.insert_or_assign(remote, *peer);
    }
    if (!is_refused) return result;
    const std::string why = kRevoked;
    refuse(plugin, remote, peer->name, why);
    return failure(why, exception);
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
        if (peer != instance.peers.end() && Timestamp::now() >= peer->second.end) {
            log_cut(peer->second.name, kExpired);
            const auto remote = instance.remotes.find(identity);
            if (remote != instance.remotes.end())
                note_refusal(remote->second.text, peer->second.name, kExpired);
        }
        instance.peers.erase(identity);
        instance.forget(identity);
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

}  // namespace

Process& process() {
    static auto* const all = new Process;
    return *all;
}

std::string guid_text(const std::uint8_t* prefix) {
    const auto word = [prefix](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value = value << 8U | prefix[at + i];
        return value;
    };
    return fmt::format("{:x}:{:x}:{:x}", word(0), word(4), word(8));
}

std::string plain_reason(const std::string& reason) {
    constexpr const char* kOther = "its key is of another key store";
    constexpr std::array<std::pair<std::string_view, const char*>, 5> kPlain{
        {{"unable to get local issuer certificate", kOther},
         {"certificate signature failure", kOther},
         {"certificate revoked", kRevoked},
         {"certificate has expired", kExpired},
         {"Certificate expired", kExpired}}};
    for (const auto& [theirs, ours] : kPlain)
        if (reason.find(theirs) != std::string::npos) return ours;
    return reason;
}

void note_refusal(const std::string& guid, const std::string& who, const std::string& why) {
    constexpr std::size_t kMaxRefusals = 4096;  // they are untrusted
    auto& refusals = process().refusals;
    if (refusals.size() >= kMaxRefusals) refusals.clear();
    refusals.insert_or_assign(guid, fmt::format("{} ({})", why, who));
}

void log_cut(const std::string& who, const std::string& why) {
    const std::string line = fmt::format("cut_off peer=\"{}\" reason=\"{}\"", who, why);
    DdsLog::of_process().add(line, line);
}

int init(const char* argument, void** context, void* domain) {
    Process& all = process();
    const int result = all.init[0](argument, context, domain);
    if (result != 0 || *context == nullptr) return result;
    auto* plugin = static_cast<Plugin*>(*context);
    {
        const std::lock_guard lock(all.mutex);
        Instance& added = all.instances[plugin];
        added.original = *plugin;
        added.domain = atrium_domain_id(plugin->gv);
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
    return all.finalize[0](context);
}

}  // namespace atrium::bus::authentication
