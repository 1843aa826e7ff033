#include "core/keys/certificates.hpp"
#include "core/keys/openssl_internal.hpp"

#include <openssl/bn.h>

#include <algorithm>
#include <array>

namespace atrium::keys {
namespace {

constexpr int kCrlVersion2 = 1;  // counted from 0

struct ReasonName {
    Reason reason;
    std::string_view text;
    int code;  // of RFC 5280
};
constexpr std::array<ReasonName, 3> kReasons{
    {{Reason::kLost, "lost", CRL_REASON_KEY_COMPROMISE},
     {Reason::kLeft, "left", CRL_REASON_CESSATION_OF_OPERATION},
     {Reason::kReplaced, "replaced", CRL_REASON_SUPERSEDED}}};

bool add_revocation(X509_CRL* list, const Revocation& revocation) {
    BIGNUM* parsed = nullptr;
    if (BN_hex2bn(&parsed, revocation.serial.c_str()) == 0) return false;
    const std::unique_ptr<BIGNUM, Freed<BN_free>> number(parsed);
    const std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>> serial(
        BN_to_ASN1_INTEGER(number.get(), nullptr));
    const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> time(ASN1_TIME_new());
    const std::unique_ptr<ASN1_ENUMERATED, Freed<ASN1_ENUMERATED_free>> reason(
        ASN1_ENUMERATED_new());
    std::unique_ptr<X509_REVOKED, Freed<X509_REVOKED_free>> entry(X509_REVOKED_new());
    if (!serial || !time || !reason || !entry) return false;
    const auto named = std::ranges::find(kReasons, revocation.reason, &ReasonName::reason);
    const bool is_complete =
        set_time(time.get(), revocation.at) &&
        ASN1_ENUMERATED_set(reason.get(), named->code) == 1 &&
        X509_REVOKED_set_serialNumber(entry.get(), serial.get()) == 1 &&
        X509_REVOKED_set_revocationDate(entry.get(), time.get()) == 1 &&
        X509_REVOKED_add1_ext_i2d(entry.get(), NID_crl_reason, reason.get(), 0, 0) == 1 &&
        X509_CRL_add0_revoked(list, entry.get()) == 1;
    if (is_complete) (void)entry.release();  // the list owns it now
    return is_complete;
}

// Lists of one authority are numbered in the order in which they were made; each has one entry
// more.
bool set_crl_number(X509_CRL* list, std::size_t num_revoked) {
    const std::unique_ptr<ASN1_INTEGER, Freed<ASN1_INTEGER_free>> number(ASN1_INTEGER_new());
    return number && ASN1_INTEGER_set_uint64(number.get(), num_revoked + 1) == 1 &&
           X509_CRL_add1_ext_i2d(list, NID_crl_number, number.get(), 0, 0) == 1;
}

std::optional<Revocation> revocation_of(X509_REVOKED* entry) {
    const std::unique_ptr<BIGNUM, Freed<BN_free>> number(
        ASN1_INTEGER_to_BN(X509_REVOKED_get0_serialNumber(entry), nullptr));
    const auto at = time_of(X509_REVOKED_get0_revocationDate(entry));
    if (!number || !at) return std::nullopt;
    char* hex = BN_bn2hex(number.get());
    if (hex == nullptr) return std::nullopt;
    Revocation revocation{hex, *at};
    OPENSSL_free(hex);
    const std::unique_ptr<ASN1_ENUMERATED, Freed<ASN1_ENUMERATED_free>> reason(
        static_cast<ASN1_ENUMERATED*>(
            X509_REVOKED_get_ext_d2i(entry, NID_crl_reason, nullptr, nullptr)));
    if (!reason) return std::nullopt;
    const auto code = ASN1_ENUMERATED_get(reason.get());
    const auto named = std::ranges::find(kReasons, code, &ReasonName::code);
    if (named == kReasons.end()) return std::nullopt;
    revocation.reason = named->reason;
    return revocation;
}

// A list that the authority signed; null for any other.
RevocationList list_of(std::string_view crl, X509* authority) {
    RevocationList list = parse_revocation_list(crl);
    const bool is_its =
        list &&
        X509_NAME_cmp(X509_CRL_get_issuer(list.get()), X509_get_subject_name(authority)) == 0 &&
        X509_CRL_verify(list.get(), X509_get0_pubkey(authority)) == 1;
    return is_its ? std::move(list) : nullptr;
}

std::string reason_of_refusal(int code, const Member& member, const Validity& validity) {
    switch (code) {
        case X509_V_ERR_CERT_HAS_EXPIRED:
            return "has expired on " + day_text(validity.end) + ": run `atrium keys renew " +
                   member.name + "` and export it";
        case X509_V_ERR_CERT_NOT_YET_VALID:
            return "is valid from " + time_text(validity.begin) + ": is the clock right?";
        case X509_V_ERR_CERT_REVOKED:
            return "is revoked: run `atrium keys renew " + member.name +
                   "` if the member may take part, and export it";
        case X509_V_ERR_CRL_HAS_EXPIRED:
        case X509_V_ERR_CRL_NOT_YET_VALID:
            return "cannot be judged, because the list of revoked ones is not valid now: is the "
                   "clock right?";
        default:
            return std::string("is not signed by the identity authority (") +
                   X509_verify_cert_error_string(code) + "): export the bundle again";
    }
}

}  // namespace

std::string_view reason_text(Reason reason) {
    return std::ranges::find(kReasons, reason, &ReasonName::reason)->text;
}

std::optional<Reason> find_reason(std::string_view text) {
    const auto named = std::ranges::find(kReasons, text, &ReasonName::text);
    return named == kReasons.end() ? std::nullopt : std::optional(named->reason);
}

Expected<std::string> make_crl(const KeyPair& identity,
                               std::span<const Revocation> revoked,
                               Validity validity) {
    const NoErrorsLeft clean;
    const auto issuer = signer_of(identity, "identity");
    if (!issuer) return tl::unexpected(issuer.error());
    const RevocationList list(X509_CRL_new());
    const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> begin(ASN1_TIME_new());
    const std::unique_ptr<ASN1_TIME, Freed<ASN1_TIME_free>> end(ASN1_TIME_new());
    bool is_complete =
        list && begin && end && X509_CRL_set_version(list.get(), kCrlVersion2) == 1 &&
        X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(issuer->certificate.get())) ==
            1 &&
        set_time(begin.get(), validity.begin) && set_time(end.get(), validity.end) &&
        X509_CRL_set1_lastUpdate(list.get(), begin.get()) == 1 &&
        X509_CRL_set1_nextUpdate(list.get(), end.get()) == 1 &&
        set_crl_number(list.get(), revoked.size());
    for (const Revocation& revocation : revoked)
        is_complete = is_complete && add_revocation(list.get(), revocation);
    is_complete = is_complete && X509_CRL_sort(list.get()) == 1 &&
                  X509_CRL_sign(list.get(), issuer->key.get(), EVP_sha256()) > 0;
    if (!is_complete) return openssl_failed("make the list of revoked certificates");
    std::string text = to_pem(list.get());
    if (text.empty()) return openssl_failed("write the list of revoked certificates");
    return text;
}

Expected<std::vector<Revocation>> read_crl(std::string_view crl,
                                           std::string_view identity_certificate) {
    const NoErrorsLeft clean;
    const auto damaged = [] {
        return make_error(ErrorKind::kInvalidData,
                          "the list of revoked certificates is damaged, or of another world");
    };
    const Certificate authority = parse_certificate(identity_certificate);
    if (!authority) return damaged();
    const RevocationList list = list_of(crl, authority.get());
    if (!list) return damaged();
    std::vector<Revocation> revoked;
    STACK_OF(X509_REVOKED)* const entries = X509_CRL_get_REVOKED(list.get());
    for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
        auto revocation = revocation_of(sk_X509_REVOKED_value(entries, i));
        if (!revocation) return damaged();
        revoked.push_back(std::move(*revocation));
    }
    return revoked;
}

Expected<Validity> check_certificate(std::string_view certificate,
                                     const Member& member,
                                     std::string_view identity_certificate,
                                     std::string_view crl,
                                     Timestamp now) {
    const NoErrorsLeft clean;
    const auto wrong = [](const std::string& why) {
        return make_error(ErrorKind::kInvalidData, why);
    };
    const auto facts = facts_of_certificate(certificate);
    if (!facts) return wrong("the certificate is damaged: export the bundle again");
    if (facts->subject != subject_of(member))
        return wrong("the certificate is not that of " + describe(member) +
                     ": export the bundle again");
    const Certificate authority = parse_certificate(identity_certificate);
    if (!authority) return wrong("the certificate of the identity authority is damaged");
    const RevocationList list = list_of(crl, authority.get());
    if (!list)
        return wrong(
            "the list of revoked certificates is damaged, or of another world: export "
            "the bundle again");
    const Certificate parsed = parse_certificate(certificate);
    const std::unique_ptr<X509_STORE, Freed<X509_STORE_free>> store(X509_STORE_new());
    const std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>> context(X509_STORE_CTX_new());
    const bool is_ready =
        store && context && X509_STORE_add_cert(store.get(), authority.get()) == 1 &&
        X509_STORE_add_crl(store.get(), list.get()) == 1 &&
        X509_STORE_CTX_init(context.get(), store.get(), parsed.get(), nullptr) == 1;
    if (!is_ready) return openssl_failed("check a certificate");
    X509_VERIFY_PARAM* const parameters = X509_STORE_CTX_get0_param(context.get());
    X509_VERIFY_PARAM_set_time(parameters, static_cast<std::time_t>(now.ns / 1'000'000'000));
    X509_VERIFY_PARAM_set_flags(parameters, X509_V_FLAG_CRL_CHECK | X509_V_FLAG_X509_STRICT);
    if (X509_verify_cert(context.get()) != 1)
        return wrong("the certificate " + reason_of_refusal(X509_STORE_CTX_get_error(context.get()),
                                                            member,
                                                            facts->validity));
    if (X509_check_ca(parsed.get()) != 0)
        return wrong("the certificate is one of an authority: export the bundle again");
    Validity validity = facts->validity;
    if (const auto end = time_of(X509_CRL_get0_nextUpdate(list.get())))
        validity.end = std::min(validity.end, *end);
    return validity;
}

}  // namespace atrium::keys
