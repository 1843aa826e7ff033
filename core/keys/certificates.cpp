#include "core/keys/certificates.hpp"

#include "core/keys/openssl_internal.hpp"

#include <openssl/bn.h>

#include <array>

namespace atrium::keys {
namespace {

constexpr int kVersion3 = 2;      // counted from 0
constexpr int kSerialBits = 126;  // positive, and unguessable
constexpr const char* kAuthorityUnit = "authority";

struct NamePart {
    const char* field;
    std::string text;
};

// In the order of the file; RFC 2253 texts have the opposite order.
bool set_name(X509_NAME* name, const std::array<NamePart, 3>& parts) {
    for (const NamePart& part : parts) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(part.text.data());
        if (X509_NAME_add_entry_by_txt(name,
                                       part.field,
                                       MBSTRING_UTF8,
                                       bytes,
                                       static_cast<int>(part.text.size()),
                                       -1,
                                       0) != 1)
            return false;
    }
    return true;
}

bool set_random_serial(X509* certificate) {
    const std::unique_ptr<BIGNUM, Freed<BN_free>> number(BN_new());
    return number && BN_rand(number.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1 &&
           BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}

bool add_extension(X509* certificate, X509* issuer, int nid, const char* value) {
    X509V3_CTX context;
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    const std::unique_ptr<X509_EXTENSION, Freed<X509_EXTENSION_free>> extension(
        X509V3_EXT_conf_nid(nullptr, &context, nid, value));
    return extension && X509_add_ext(certificate, extension.get(), -1) == 1;
}

// All but subject, issuer and extensions.
Certificate new_certificate(EVP_PKEY* key, Validity validity) {
    Certificate made(X509_new());
    const bool is_made = made && X509_set_version(made.get(), kVersion3) == 1 &&
                         set_random_serial(made.get()) &&
                         set_time(X509_getm_notBefore(made.get()), validity.begin) &&
                         set_time(X509_getm_notAfter(made.get()), validity.end) &&
                         X509_set_pubkey(made.get(), key) == 1;
    return is_made ? std::move(made) : nullptr;
}

Expected<KeyPair> as_texts(X509* certificate, EVP_PKEY* key) {
    KeyPair pair{to_pem(certificate), to_pem(key)};
    if (pair.certificate.empty() || pair.private_key.empty())
        return openssl_failed("write a key as text");
    return pair;
}

std::string authority_subject(Authority authority, const std::string& world) {
    return "CN=" + std::string(authority_text(authority)) + ",OU=" + kAuthorityUnit + ",O=" + world;
}

const char* usage_of(Authority authority) {
    // Cyclone DDS asks for the right to sign documents
    return authority == Authority::kIdentity ? "critical,keyCertSign,cRLSign"
                                             : "critical,digitalSignature,keyCertSign";
}

}  // namespace

std::string_view authority_text(Authority authority) {
    return authority == Authority::kIdentity ? "identity" : "permissions";
}

Expected<KeyPair> make_authority(Authority authority, const std::string& world, Validity validity) {
    const NoErrorsLeft clean;
    const PrivateKey key(EVP_EC_gen("P-256"));
    if (!key) return openssl_failed("make a key");
    const Certificate made = new_certificate(key.get(), validity);
    if (!made) return openssl_failed("make a certificate");
    X509* const authority_certificate = made.get();
    X509_NAME* const subject = X509_get_subject_name(authority_certificate);
    const bool is_complete =
        set_name(subject,
                 {{{"O", world},
                   {"OU", kAuthorityUnit},
                   {"CN", std::string(authority_text(authority))}}}) &&
        X509_set_issuer_name(authority_certificate, subject) == 1 &&
        add_extension(authority_certificate,
                      authority_certificate,
                      NID_basic_constraints,
                      "critical,CA:TRUE,pathlen:0") &&
        add_extension(
            authority_certificate, authority_certificate, NID_key_usage, usage_of(authority)) &&
        add_extension(
            authority_certificate, authority_certificate, NID_subject_key_identifier, "hash") &&
        X509_sign(authority_certificate, key.get(), EVP_sha256()) > 0;
    if (!is_complete) return openssl_failed("sign a certificate");
    return as_texts(authority_certificate, key.get());
}

Expected<KeyPair> make_certificate(const KeyPair& identity,
                                   const Member& member,
                                   Validity validity) {
    const NoErrorsLeft clean;
    const auto issuer = signer_of(identity, "identity");
    if (!issuer) return tl::unexpected(issuer.error());
    X509* const authority = issuer->certificate.get();
    const PrivateKey key(EVP_EC_gen("P-256"));
    if (!key) return openssl_failed("make a key");
    const Certificate made = new_certificate(key.get(), validity);
    if (!made) return openssl_failed("make a certificate");
    const bool is_complete =
        set_name(X509_get_subject_name(made.get()),
                 {{{"O", member.world},
                   {"OU", std::string(kind_text(member.kind))},
                   {"CN", member.name}}}) &&
        X509_set_issuer_name(made.get(), X509_get_subject_name(authority)) == 1 &&
        add_extension(made.get(), authority, NID_basic_constraints, "critical,CA:FALSE") &&
        add_extension(made.get(), authority, NID_key_usage, "critical,digitalSignature") &&
        add_extension(made.get(), authority, NID_subject_key_identifier, "hash") &&
        add_extension(made.get(), authority, NID_authority_key_identifier, "keyid:always") &&
        X509_sign(made.get(), issuer->key.get(), EVP_sha256()) > 0;
    if (!is_complete) return openssl_failed("sign a certificate");
    return as_texts(made.get(), key.get());
}

Expected<CertificateFacts> facts_of_certificate(std::string_view certificate) {
    const NoErrorsLeft clean;
    const Certificate parsed = parse_certificate(certificate);
    if (!parsed) return make_error(ErrorKind::kInvalidData, "a certificate is damaged");
    const auto begin = time_of(X509_get0_notBefore(parsed.get()));
    const auto end = time_of(X509_get0_notAfter(parsed.get()));
    const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
        ASN1_INTEGER_to_BN(X509_get0_serialNumber(parsed.get()), nullptr));
    if (!begin || !end || !number)
        return make_error(ErrorKind::kInvalidData, "a certificate has no usable time or number");
    CertificateFacts facts{
        name_text(X509_get_subject_name(parsed.get())), "", Validity{*begin, *end}};
    char* hex = BN_bn2hex(number.get());
    if (hex == nullptr) return openssl_failed("write a number");
    facts.serial = hex;
    OPENSSL_free(hex);
    return facts;
}

Expected<void> check_key(std::string_view private_key, std::string_view certificate) {
    const NoErrorsLeft clean;
    const PrivateKey key = parse_private_key(private_key);
    if (!key) return make_error(ErrorKind::kInvalidData, "the private key is damaged");
    const Certificate parsed = parse_certificate(certificate);
    if (!parsed) return make_error(ErrorKind::kInvalidData, "the certificate is damaged");
    if (X509_check_private_key(parsed.get(), key.get()) != 1)
        return make_error(ErrorKind::kInvalidData,
                          "the private key does not belong to the certificate");
    return {};
}

Expected<Validity> check_authority(Authority authority,
                                   std::string_view certificate,
                                   const std::string& world,
                                   Timestamp now) {
    const NoErrorsLeft clean;
    const auto what =
        "the certificate of the " + std::string(authority_text(authority)) + " authority ";
    const auto wrong = [&](const std::string& why) {
        return make_error(ErrorKind::kInvalidData, what + why);
    };
    const auto facts = facts_of_certificate(certificate);
    if (!facts) return wrong("is damaged");
    const Certificate parsed = parse_certificate(certificate);
    if (facts->subject != authority_subject(authority, world))
        return wrong("is that of another world or authority");
    if (X509_NAME_cmp(X509_get_subject_name(parsed.get()), X509_get_issuer_name(parsed.get())) !=
            0 ||
        X509_verify(parsed.get(), X509_get0_pubkey(parsed.get())) != 1)
        return wrong("is not signed by itself");
    const std::uint32_t needed =
        authority == Authority::kIdentity ? KU_KEY_CERT_SIGN | KU_CRL_SIGN : KU_DIGITAL_SIGNATURE;
    if (X509_check_ca(parsed.get()) != 1 || (X509_get_key_usage(parsed.get()) & needed) != needed)
        return wrong("may not sign what an authority signs");
    if (now < facts->validity.begin) return wrong("is not valid yet: is the clock right?");
    if (now >= facts->validity.end)
        return wrong("has expired on " + day_text(facts->validity.end) +
                     ": make new keys with `atrium keys init`");
    return facts->validity;
}

}  // namespace atrium::keys
