#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"
#include "core/keys/bundle.hpp"
#include "core/keys/certificates.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::keys {

inline constexpr int kMaxDays = 36500;
inline constexpr int kMemberDays = 365;
inline constexpr int kAuthorityDays = 3650;

enum class State : std::uint8_t {
    kValid,
    kExpiresSoon,  // in less than 30 days
    kExpired,
    kNotYetValid,  // the clock is wrong, or was when the keys were made
    kRevoked,
};
/// "valid", "expires soon", "expired", "not valid yet" or "revoked".
std::string_view state_text(State state);

/// One member of a key store.
struct Entry {
    Member member;
    Validity validity;
    State state = State::kValid;
    std::optional<Revocation> revocation;  // if the state is kRevoked
};

/// A tunnel with the private keys of all places.
struct StoredTunnel {
    std::string hub;            // empty: there is no tunnel
    std::vector<Place> places;  // first the hub
    std::vector<std::string> private_keys;
};

/// The keys of all members of one world and its two authorities: a folder on the owner's computer.
///
///     store.toml           format and world
///     identity.pem, .key   the authorities: certificate and private key
///     permissions.pem, .key
///     governance.smime     signed
///     crl.pem              revoked certificates
///     members/NAME.bundle  what NAME had when its key was made
///     tunnel.toml          keys and addresses of all places, if there is a tunnel
///
/// Files have mode 0600 and are replaced atomically. The object holds a lock on the folder: one
/// writer, or several readers. Errors name the file and the cure: kNotFound and kConfiguration of
/// read_private_file, kInvalidData for damaged files, kUnavailable if another program holds the
/// lock or a file cannot be written.
class KeyStore {
public:
    enum class Access : std::uint8_t { kRead, kWrite };

    /// Makes the folder with two new authorities, valid for `days` (1..kMaxDays). Fails with
    /// kConfiguration if it exists. A crash leaves no incomplete store.
    static Expected<KeyStore> create(const std::filesystem::path& folder,
                                     const std::string& world,
                                     int days,
                                     Timestamp now);
    static Expected<KeyStore> open(const std::filesystem::path& folder, Access access);

    const std::string& world() const { return world_; }
    /// When the authorities expire: no member is valid longer.
    Timestamp end() const { return end_; }

    /// Makes the keys of a new member, valid for `days` (1..kMaxDays) at most. Fails with
    /// kConfiguration if the name is taken by a member of any kind, or by a host of a site.
    Expected<Entry> add(const Member& member, int days, Timestamp now);
    /// Puts the member's certificate on the list of revoked ones. Others refuse the member when
    /// they have the new list.
    Expected<Entry> revoke(const std::string& name, Reason reason, Timestamp now);
    /// Gives the member a new key, also of the tunnel if it has a place there and is not the hub,
    /// and revokes the old one. Rights stay without `rights`.
    Expected<Entry> renew(const std::string& name,
                          std::optional<Rights> rights,
                          int days,
                          Timestamp now);

    /// Gives a member a place in the tunnel, with a new key, and makes the tunnel if there is none:
    /// its hub is the member of kind world, which must exist. `hub` as parse_hub returns it; empty:
    /// that of the tunnel. A member that has a place keeps it. kConfiguration for no hub, no member
    /// or no free address.
    Expected<void> add_place(const std::string& name, const std::string& hub);

    /// The hub of the tunnel as parse_hub returns it; empty: there is no tunnel.
    const std::string& hub() const { return tunnel_.hub; }

    /// What a member needs, with the current list of revoked certificates, and the tunnel if it has
    /// a place there.
    Expected<Bundle> bundle(const std::string& name) const;
    /// The state of a member whose bundle is from this store.
    Expected<Entry> entry_of(const Bundle& bundle, Timestamp now) const;
    /// All members by name.
    Expected<std::vector<Entry>> entries(Timestamp now) const;

    /// Checks the authorities, the list and the signatures of the store at the time `now`, not the
    /// members. Fails with kInvalidData.
    Expected<void> check(Timestamp now) const;
    /// The names of all members.
    Expected<std::vector<std::string>> names() const;

private:
    KeyStore(std::filesystem::path folder, Descriptor lock)
        : folder_(std::move(folder)), lock_(std::move(lock)) {}

    std::filesystem::path file_of(const std::string& name) const;
    Expected<void> read_files();
    Expected<void> read_tunnel_file();
    Expected<void> write_tunnel_file() const;
    Expected<Bundle> make_bundle(const Member& member, int days, Timestamp now) const;
    Expected<void> write_crl(const std::vector<Revocation>& revoked, Timestamp now);

    std::filesystem::path folder_;
    Descriptor lock_;
    std::string world_;
    KeyPair identity_;
    KeyPair permissions_;
    std::string governance_;
    std::string crl_;
    std::vector<Revocation> revoked_;
    StoredTunnel tunnel_;
    Timestamp end_;
};

/// True if the folder has the file that each key store has.
bool is_key_store(const std::filesystem::path& folder);

/// Checks a whole key store: also modes of files, and every member. Returns one sentence with the
/// cure for each problem; none if all is well. Expired and revoked members are no problems.
std::vector<std::string> problems_of_store(const std::filesystem::path& folder, Timestamp now);

}  // namespace atrium::keys
