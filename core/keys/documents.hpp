#pragma once

#include "core/base/expected.hpp"
#include "core/keys/certificates.hpp"

#include <string>
#include <string_view>

/// Signed documents: S/MIME texts as `openssl smime -sign -text` writes them, with '\n' at line
/// ends. Cyclone DDS reads governance and permissions in this form.
namespace atrium::keys {

/// Signs `text` (lines that end in '\n') with the permissions authority. Fails with kInvalidData if
/// `authority` is damaged, else with kInternal.
Expected<std::string> sign_document(const std::string& text, const KeyPair& authority);

/// The text of a signed document. Fails with kInvalidData unless `authority` itself signed exactly
/// this text: a certificate that the authority made is not enough.
Expected<std::string> verify_document(std::string_view document,
                                      std::string_view authority_certificate);

}  // namespace atrium::keys
