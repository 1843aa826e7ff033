#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/keys/certificates.hpp"
#include "core/keys/validity.hpp"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pkcs7.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>

/// Owners of OpenSSL objects, and PEM to and from them. Private to core/keys.
namespace atrium::keys {

template <auto kFree>
struct Freed {
    template <typename T>
    void operator()(T* object) const {
        kFree(object);
    }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using PrivateKey = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;
using RevocationList = std::unique_ptr<X509_CRL, Freed<X509_CRL_free>>;
using Signature = std::unique_ptr<PKCS7, Freed<PKCS7_free>>;

/// Empties OpenSSL's list of errors of this thread when a function ends: Cyclone DDS, in the same
/// process, would report them as its own.
class NoErrorsLeft {
public:
    NoErrorsLeft() = default;
    NoErrorsLeft(const NoErrorsLeft&) = delete;
    NoErrorsLeft& operator=(const NoErrorsLeft&) = delete;
    ~NoErrorsLeft() { ERR_clear_error(); }
};

/// A BIO that reads `text`, which must outlive it.
Bio reading(std::string_view text);
/// A BIO that collects what is written, and its content.
Bio collecting();
std::string collected(const Bio& bio);

/// Each parses exactly one object, written as `to_pem` writes it, without anything before or after.
/// They return null for other bytes, and for keys that are not on P-256.
Certificate parse_certificate(std::string_view pem);
PrivateKey parse_private_key(std::string_view pem);

/// An authority that signs.
struct Signer {
    Certificate certificate;
    PrivateKey key;
};
/// Fails with kInvalidData if one of both texts is damaged. `authority` names it in the error.
Expected<Signer> signer_of(const KeyPair& pair, std::string_view authority);
RevocationList parse_revocation_list(std::string_view pem);

/// Private keys as unencrypted PKCS#8. Empty if OpenSSL fails.
std::string to_pem(X509* certificate);
std::string to_pem(EVP_PKEY* key);
std::string to_pem(X509_CRL* list);

/// RFC 2253 text, as Cyclone DDS makes it.
std::string name_text(const X509_NAME* name);

/// Whole seconds; nullopt if OpenSSL cannot read the time.
std::optional<Timestamp> time_of(const ASN1_TIME* time);
bool set_time(ASN1_TIME* time, Timestamp value);

/// The failure of a call that does not depend on its input.
tl::unexpected<Error> openssl_failed(const char* what);

}  // namespace atrium::keys
