#pragma once

#include "core/keys/certificates.hpp"

#include <string>

/// The names of the files in a key store. Private to core/keys.
namespace atrium::keys {

inline constexpr int kStoreFormat = 1;
inline constexpr const char* kStoreFile = "store.toml";
inline constexpr const char* kGovernanceFile = "governance.smime";
inline constexpr const char* kCrlFile = "crl.pem";
inline constexpr const char* kMembersFolder = "members";
inline constexpr const char* kBundleEnding = ".bundle";

inline std::string certificate_file(Authority authority) {
    return std::string(authority_text(authority)) + ".pem";
}
inline std::string key_file(Authority authority) {
    return std::string(authority_text(authority)) + ".key";
}

}  // namespace atrium::keys
