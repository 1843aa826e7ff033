#pragma once

#include "core/keys/certificates.hpp"
#include "core/keys/store.hpp"

#include <optional>
#include <string>

/// The names of the files in a key store. Private to core/keys.
namespace atrium::keys {

inline constexpr int kStoreFormat = 1;
inline constexpr const char* kStoreFile = "store.toml";
inline constexpr const char* kGovernanceFile = "governance.smime";
inline constexpr const char* kCrlFile = "crl.pem";
inline constexpr const char* kTunnelFile = "tunnel.toml";
inline constexpr const char* kMembersFolder = "members";
inline constexpr const char* kBundleEnding = ".bundle";

inline std::string certificate_file(Authority authority) {
    return std::string(authority_text(authority)) + ".pem";
}
inline std::string key_file(Authority authority) {
    return std::string(authority_text(authority)) + ".key";
}

/// What the member `name` needs of the tunnel; nullopt if it has no place there.
std::optional<Tunnel> tunnel_of(const StoredTunnel& tunnel, const std::string& name);
/// Gives a place new keys, but not the hub, whose key all others have. False if there is none.
Expected<bool> renew_place(StoredTunnel& tunnel, const std::string& name);
/// Takes a place out, but not the hub. False if there is none.
bool remove_place(StoredTunnel& tunnel, const std::string& name);

}  // namespace atrium::keys
