#include "core/keys/openssl_internal.hpp"

#include <openssl/pem.h>

#include <ctime>
#include <limits>

namespace atrium::keys {
namespace {

// Without it OpenSSL asks for a password on the terminal.
int no_password(char*, int, int, void*) { return 0; }

bool is_on_p256(EVP_PKEY* key) {
    char group[32];
    return key != nullptr && EVP_PKEY_is_a(key, "EC") == 1 &&
           EVP_PKEY_get_group_name(key, group, sizeof(group), nullptr) == 1 &&
           std::string_view(group) == "prime256v1";
}

}  // namespace

Bio reading(std::string_view text) {
    if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) return nullptr;
    return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
}

Bio collecting() { return Bio(BIO_new(BIO_s_mem())); }

std::string collected(const Bio& bio) {
    char* data = nullptr;
    const long size = BIO_get_mem_data(bio.get(), &data);
    return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string();
}

Certificate parse_certificate(std::string_view pem) {
    const NoErrorsLeft clean;
    const Bio in = reading(pem);
    if (!in) return nullptr;
    Certificate certificate(PEM_read_bio_X509(in.get(), nullptr, no_password, nullptr));
    if (!certificate || to_pem(certificate.get()) != pem) return nullptr;
    return is_on_p256(X509_get0_pubkey(certificate.get())) ? std::move(certificate) : nullptr;
}

PrivateKey parse_private_key(std::string_view pem) {
    const NoErrorsLeft clean;
    const Bio in = reading(pem);
    if (!in) return nullptr;
    PrivateKey key(PEM_read_bio_PrivateKey(in.get(), nullptr, no_password, nullptr));
    if (!is_on_p256(key.get()) || to_pem(key.get()) != pem) return nullptr;
    // the file holds both halves: they must belong together
    const std::unique_ptr<EVP_PKEY_CTX, Freed<EVP_PKEY_CTX_free>> context(
        EVP_PKEY_CTX_new(key.get(), nullptr));
    return context && EVP_PKEY_pairwise_check(context.get()) == 1 ? std::move(key) : nullptr;
}

Expected<Signer> signer_of(const KeyPair& pair, std::string_view authority) {
    Signer signer{parse_certificate(pair.certificate), parse_private_key(pair.private_key)};
    if (!signer.certificate || !signer.key)
        return make_error(ErrorKind::kInvalidData,
                          "the " + std::string(authority) +
                              " authority is damaged: restore the key store from a copy");
    return signer;
}

RevocationList parse_revocation_list(std::string_view pem) {
    const NoErrorsLeft clean;
    const Bio in = reading(pem);
    if (!in) return nullptr;
    RevocationList list(PEM_read_bio_X509_CRL(in.get(), nullptr, no_password, nullptr));
    return list && to_pem(list.get()) == pem ? std::move(list) : nullptr;
}

std::string to_pem(X509* certificate) {
    const Bio out = collecting();
    return out && PEM_write_bio_X509(out.get(), certificate) == 1 ? collected(out) : std::string();
}

std::string to_pem(EVP_PKEY* key) {
    const Bio out = collecting();
    const bool is_written = out && PEM_write_bio_PKCS8PrivateKey(
                                       out.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1;
    return is_written ? collected(out) : std::string();
}

std::string to_pem(X509_CRL* list) {
    const Bio out = collecting();
    return out && PEM_write_bio_X509_CRL(out.get(), list) == 1 ? collected(out) : std::string();
}

std::string name_text(const X509_NAME* name) {
    const Bio out = collecting();
    if (!out || X509_NAME_print_ex(out.get(), name, 0, XN_FLAG_RFC2253) < 0) return {};
    return collected(out);
}

std::optional<Timestamp> time_of(const ASN1_TIME* time) {
    std::tm parts{};
    if (time == nullptr || ASN1_TIME_to_tm(time, &parts) != 1) return std::nullopt;
    const std::time_t seconds = timegm(&parts);
    // beyond it nanoseconds overflow
    constexpr std::int64_t kMax_s = std::numeric_limits<std::int64_t>::max() / 1'000'000'000 - 1;
    if (seconds < 0 || seconds > kMax_s) return std::nullopt;
    return Timestamp{static_cast<std::int64_t>(seconds) * 1'000'000'000};
}

bool set_time(ASN1_TIME* time, Timestamp value) {
    return ASN1_TIME_set(time, static_cast<std::time_t>(value.ns / 1'000'000'000)) != nullptr;
}

tl::unexpected<Error> openssl_failed(const char* what) {
    char reason[256] = "out of memory or randomness";
    if (const unsigned long code = ERR_get_error(); code != 0)
        ERR_error_string_n(code, reason, sizeof(reason));
    ERR_clear_error();
    return make_error(ErrorKind::kInternal,
                      std::string("OpenSSL cannot ") + what + " (" + reason + "); try again");
}

}  // namespace atrium::keys
