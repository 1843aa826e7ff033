#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/keys/store.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace atrium::keys_tool {

/// The options of all commands; each uses some of them.
struct Options {
    std::filesystem::path keys;  // folder of the store; empty: see find_store
    std::string kind;
    std::string name;  // of a world for `init`, else of a member
    std::optional<std::string> rights;
    std::optional<int> days;
    std::string reason = "lost";
    std::filesystem::path output;
    bool replace = false;
    bool json = false;
    std::filesystem::path bundle;  // for `check`; empty: the store
    std::string hub;               // for `invite`; empty: as before
};

/// What a command prints, and its exit code: 1 if what it looked at is not as it should be.
struct Outcome {
    std::string text;
    int exit_code = 0;
};

/// Each runs one command at the time `now`. Errors are those of core/keys, and kConfiguration for
/// options.
Expected<Outcome> init(const Options& options, Timestamp now);
Expected<Outcome> add(const Options& options, Timestamp now);
Expected<Outcome> list(const Options& options, Timestamp now);
Expected<Outcome> revoke(const Options& options, Timestamp now);
Expected<Outcome> renew(const Options& options, Timestamp now);
Expected<Outcome> export_bundle(const Options& options, Timestamp now);
Expected<Outcome> check(const Options& options, Timestamp now);
/// Adds the member if there is none of that name, gives it a place in the tunnel, and writes its
/// bundle with both.
Expected<Outcome> invite(const Options& options, Timestamp now);

// shared by the commands
/// The member that `kind`, `name` and `rights` of the options describe, of that world.
Expected<keys::Member> member_of(const Options& options, const std::string& world);
Expected<keys::KeyStore> open_store(const Options& options, keys::KeyStore::Access access);
/// Refuses "-": it would become a file of that name.
Expected<void> check_output(const Options& options);
/// "atrium keys REST", to copy, for the same store.
std::string command(const Options& options, const std::string& rest);
/// "viewer bob of world playroom with the rights grab,push, valid until 2027-11-24"
std::string described(const keys::Entry& entry);

}  // namespace atrium::keys_tool
