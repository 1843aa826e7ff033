#include "core/bus/authentication_internal.hpp"

#include <dds/security/dds_security_api_cryptography.h>

// The functions that take the place of Cyclone's in its table for encryption. Each calls that of
// Cyclone, and notes when keys of a peer were last good for something.
namespace atrium::bus::authentication {
namespace {

// The same for all domains: the functions of one library. Set before the first is called.
dds_security_crypto_transform original_transform{};
dds_security_crypto_key_factory original_factory{};

HeardPeers::Crypto register_matched_remote_participant(
    dds_security_crypto_key_factory* factory,
    const DDS_Security_ParticipantCryptoHandle local,
    const DDS_Security_IdentityHandle remote,
    const DDS_Security_PermissionsHandle permissions,
    const DDS_Security_SharedSecretHandle secret,
    DDS_Security_SecurityException* exception) {
    const auto peer = original_factory.register_matched_remote_participant(
        factory, local, remote, permissions, secret, exception);
    if (peer != DDS_SECURITY_HANDLE_NIL) process().heard.add(peer, remote);
    return peer;
}

DDS_Security_boolean unregister_participant(dds_security_crypto_key_factory* factory,
                                            const DDS_Security_ParticipantCryptoHandle peer,
                                            DDS_Security_SecurityException* exception) {
    process().heard.remove(peer);
    return original_factory.unregister_participant(factory, peer, exception);
}

DDS_Security_boolean decode_rtps_message(dds_security_crypto_transform* transform,
                                         DDS_Security_OctetSeq* plain,
                                         const DDS_Security_OctetSeq* encoded,
                                         const DDS_Security_ParticipantCryptoHandle receiver,
                                         const DDS_Security_ParticipantCryptoHandle sender,
                                         DDS_Security_SecurityException* exception) {
    const auto is_good = original_transform.decode_rtps_message(
        transform, plain, encoded, receiver, sender, exception);
    if (is_good) process().heard.note(sender);
    return is_good;
}

}  // namespace

int init_crypto(const char* argument, void** context, void* domain) {
    const int result = process().init[1](argument, context, domain);
    if (result != 0 || *context == nullptr) return result;
    const auto* plugin = static_cast<dds_security_cryptography*>(*context);
    static std::once_flag once;
    std::call_once(once, [plugin] {
        original_transform = *plugin->crypto_transform;
        original_factory = *plugin->crypto_key_factory;
    });
    plugin->crypto_transform->decode_rtps_message = decode_rtps_message;
    plugin->crypto_key_factory->register_matched_remote_participant =
        register_matched_remote_participant;
    plugin->crypto_key_factory->unregister_participant = unregister_participant;
    return result;
}

int finalize_crypto(void* context) { return process().finalize[1](context); }

}  // namespace atrium::bus::authentication
