#pragma once

#include "core/base/expected.hpp"
#include "core/keys/member.hpp"
#include "core/keys/validity.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Certificate authorities, certificates of members and the list of revoked ones. All keys are on
/// P-256. Texts are PEM; private keys are unencrypted PKCS#8.
namespace atrium::keys {

/// The two authorities of a world. With one, the owner of any certificate could sign new rights for
/// himself, because Cyclone DDS accepts every signer that the authority of permissions certified.
enum class Authority : std::uint8_t { kIdentity, kPermissions };

/// "identity" or "permissions", as in names of files and in the subject.
std::string_view authority_text(Authority authority);

struct KeyPair {
    std::string certificate;
    std::string private_key;
};

/// Makes a self-signed authority, whose subject is "CN=identity,OU=authority,O=WORLD". Fails with
/// kInternal.
Expected<KeyPair> make_authority(Authority authority, const std::string& world, Validity validity);

/// Makes a key and a certificate for `member`, signed by the identity authority. Fails with
/// kInvalidData if `identity` is damaged, else with kInternal.
Expected<KeyPair> make_certificate(const KeyPair& identity,
                                   const Member& member,
                                   Validity validity);

/// What a certificate says of itself; unverified.
struct CertificateFacts {
    std::string subject;  // RFC 2253
    std::string serial;   // hexadecimal
    Validity validity;
};
/// Fails with kInvalidData.
Expected<CertificateFacts> facts_of_certificate(std::string_view certificate);

/// Checks a certificate of an authority of `world` at the time `now`: P-256, self-signed, subject,
/// purpose, time. Returns its validity. Fails with kInvalidData.
Expected<Validity> check_authority(Authority authority,
                                   std::string_view certificate,
                                   const std::string& world,
                                   Timestamp now);

/// Checks that a private key belongs to a certificate. Fails with kInvalidData.
Expected<void> check_key(std::string_view private_key, std::string_view certificate);

/// Checks a member's certificate at the time `now`: subject, signature of the identity authority,
/// time, and that `crl` is of this authority and does not have it. Returns its validity, which ends
/// with that of the list. Fails with kInvalidData.
Expected<Validity> check_certificate(std::string_view certificate,
                                     const Member& member,
                                     std::string_view identity_certificate,
                                     std::string_view crl,
                                     Timestamp now);

/// Why a certificate is revoked.
enum class Reason : std::uint8_t {
    kLost,      // somebody else may have the private key
    kLeft,      // the member no longer takes part
    kReplaced,  // by a new certificate
};
/// "lost", "left" or "replaced".
std::string_view reason_text(Reason reason);
std::optional<Reason> find_reason(std::string_view text);

struct Revocation {
    std::string serial;  // as in CertificateFacts
    Timestamp at;
    Reason reason = Reason::kLost;
};
/// Makes the list of revoked certificates. Fails with kInvalidData if `identity` is damaged, else
/// with kInternal.
Expected<std::string> make_crl(const KeyPair& identity,
                               std::span<const Revocation> revoked,
                               Validity validity);
/// The content of a list, whose signature is checked. Fails with kInvalidData.
Expected<std::vector<Revocation>> read_crl(std::string_view crl,
                                           std::string_view identity_certificate);

}  // namespace atrium::keys
