#include "core/keys/documents.hpp"

#include "core/keys/openssl_internal.hpp"

#include <algorithm>

namespace atrium::keys {
namespace {

// The signature counts lines with "\r\n" at their ends: readers put them there again.
std::string without_returns(std::string text) {
    std::erase(text, '\r');
    return text;
}

// As sign_document makes it: one signer, SHA-256, the text not inside. PKCS7_verify of OpenSSL 3.0
// leaks memory on signatures with digests that it does not know.
bool has_one_signer(PKCS7* signature) {
    if (!PKCS7_type_is_signed(signature) || signature->d.sign == nullptr) return false;
    const PKCS7_SIGNED* const content = signature->d.sign;
    if (content->contents == nullptr || PKCS7_get_detached(signature) == 0) return false;
    if (sk_X509_ALGOR_num(content->md_algs) != 1 ||
        sk_PKCS7_SIGNER_INFO_num(content->signer_info) != 1)
        return false;
    return OBJ_obj2nid(sk_X509_ALGOR_value(content->md_algs, 0)->algorithm) == NID_sha256;
}

}  // namespace

Expected<std::string> sign_document(const std::string& text, const KeyPair& authority) {
    const NoErrorsLeft clean;
    const auto signer = signer_of(authority, "permissions");
    if (!signer) return tl::unexpected(signer.error());
    const Bio in = reading(text);
    const Bio out = collecting();
    if (!in || !out) return openssl_failed("sign a document");
    constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT | PKCS7_STREAM;
    const Signature signature(
        PKCS7_sign(signer->certificate.get(), signer->key.get(), nullptr, in.get(), kFlags));
    if (!signature || SMIME_write_PKCS7(out.get(), signature.get(), in.get(), kFlags) != 1)
        return openssl_failed("sign a document");
    return without_returns(collected(out));
}

Expected<std::string> verify_document(std::string_view document,
                                      std::string_view authority_certificate) {
    const NoErrorsLeft clean;
    const Certificate authority = parse_certificate(authority_certificate);
    if (!authority)
        return make_error(ErrorKind::kInvalidData,
                          "the certificate of the permissions authority is damaged");
    const Bio in = reading(document);
    const Bio out = collecting();
    if (!in || !out) return openssl_failed("check a document");
    BIO* content = nullptr;
    const Signature signature(SMIME_read_PKCS7(in.get(), &content));
    const Bio signed_content(content);
    if (!signature || !signed_content || !has_one_signer(signature.get()))
        return make_error(ErrorKind::kInvalidData, "is no signed document");
    const std::unique_ptr<STACK_OF(X509), void (*)(STACK_OF(X509)*)> signers(
        sk_X509_new_null(), [](STACK_OF(X509) * stack) { sk_X509_free(stack); });
    if (!signers || sk_X509_push(signers.get(), authority.get()) <= 0)
        return openssl_failed("check a document");
    // NOINTERN: the certificates inside the document do not count; NOVERIFY: the authority is given
    constexpr int kFlags = PKCS7_TEXT | PKCS7_NOVERIFY | PKCS7_NOINTERN;
    if (PKCS7_verify(
            signature.get(), signers.get(), nullptr, signed_content.get(), out.get(), kFlags) != 1)
        return make_error(
            ErrorKind::kInvalidData,
            "is not signed by the permissions authority of the world, or was changed");
    return without_returns(collected(out));
}

}  // namespace atrium::keys
