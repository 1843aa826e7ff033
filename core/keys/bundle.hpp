#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/keys/member.hpp"
#include "core/keys/tunnel.hpp"
#include "core/keys/validity.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace atrium::keys {

/// Ten times the largest bundle without revoked certificates.
inline constexpr std::size_t kMaxBundleBytes = std::size_t{256} << 10U;

/// All that one member needs to join its world, in one file. Texts are PEM, or S/MIME for
/// `governance` and `permissions`, as Cyclone DDS takes them after "data:,". Never log
/// `private_key`.
struct Bundle {
    Member member;
    std::string identity_ca;         // certificate of the identity authority
    std::string permissions_ca;      // certificate of the permissions authority
    std::string certificate;         // of the member
    std::string private_key;         // unencrypted PKCS#8
    std::string crl;                 // revoked certificates of the identity authority
    std::string governance;          // signed by the permissions authority
    std::string permissions;         // signed by the permissions authority
    std::optional<Tunnel> tunnel{};  // of a place that reaches the others through WireGuard
};

/// The text of a bundle's file: TOML with literal strings.
std::string bundle_text(const Bundle& bundle);

/// Parses the text of a file; untrusted bytes. `name` stands for the file in errors, which contain
/// nothing of the text. Fails with kInvalidData. The result has valid names; nothing else is
/// checked.
Expected<Bundle> parse_bundle(const std::string& text, const std::string& name);

/// True if the text is a bundle, or begins as one: it may be cut off.
bool is_bundle(const std::string& text);

/// Reads a bundle that only its owner can read (core/keys/private_file.hpp), at most
/// kMaxBundleBytes large. Errors name the file: those of read_private_file and parse_bundle. Of a
/// file that is no bundle the mode does not matter.
Expected<Bundle> read_bundle(const std::filesystem::path& file);

/// Checks that a member can join its world with this bundle at the time `now`: certificates,
/// private key, revocation, signatures, governance, permissions and rights, and that all of them
/// belong together. Returns the time in which all are valid. Fails with kInvalidData and one
/// sentence with the cure.
Expected<Validity> check(const Bundle& bundle, Timestamp now);

}  // namespace atrium::keys
