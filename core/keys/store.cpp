#include "core/keys/store.hpp"

#include "core/base/looked_up.hpp"
#include "core/base/write_check.hpp"
#include "core/config/table_reader.hpp"
#include "core/keys/documents.hpp"
#include "core/keys/permissions.hpp"
#include "core/keys/private_file.hpp"
#include "core/keys/store_files_internal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>

namespace atrium::keys {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20U;
constexpr std::chrono::hours kSoon{24 * 30};

// The lock of the folder itself: it ends with the process, and no file is left over.
Expected<Descriptor> locked(const fs::path& folder, KeyStore::Access access) {
    Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened.get() < 0)
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: cannot be opened: {}{}; give the folder that `atrium "
                                      "keys init` made with --keys",
                                      folder.string(),
                                      std::strerror(errno),
                                      errno == ENOENT ? looked_up_from(folder) : ""));
    // first: nobody may be told to close another folder, such as /etc
    if (!is_key_store(folder))
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: is no key store: it has no {}; give the folder that "
                                      "`atrium keys init` made with --keys",
                                      folder.string(),
                                      kStoreFile));
    struct stat info {};
    if (::fstat(opened.get(), &info) != 0 || (info.st_mode & 077U) != 0)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: others can open the folder of the private keys (mode "
                                      "{:04o}); run `chmod 700 '{}'`",
                                      folder.string(),
                                      info.st_mode & 07777U,
                                      folder.string()));
    const int kind = access == KeyStore::Access::kWrite ? LOCK_EX : LOCK_SH;
    if (::flock(opened.get(), kind | LOCK_NB) != 0)
        return make_error(
            ErrorKind::kUnavailable,
            folder.string() + ": another `atrium keys` works in it; try again when it has ended");
    return opened;
}

// No certificate is valid longer than the authority that signed it.
Validity within(Validity validity, Timestamp end) {
    return {validity.begin, std::min(validity.end, end)};
}

State state_at(Timestamp now, const Validity& validity, bool is_revoked) {
    if (is_revoked) return State::kRevoked;
    if (now < validity.begin) return State::kNotYetValid;
    if (now >= validity.end) return State::kExpired;
    return validity.end - now < kSoon ? State::kExpiresSoon : State::kValid;
}

tl::unexpected<Error> in_file(const fs::path& file, const Error& error) {
    return make_error(error.kind, file.string() + ": " + error.message);
}

}  // namespace

std::string_view state_text(State state) {
    constexpr std::array<std::string_view, 5> kTexts{
        "valid", "expires soon", "expired", "not valid yet", "revoked"};
    return kTexts[static_cast<std::size_t>(state)];
}

bool is_key_store(const fs::path& folder) {
    struct stat info {};
    return ::stat((folder / kStoreFile).c_str(), &info) == 0 && S_ISREG(info.st_mode);
}

Expected<KeyStore> KeyStore::open(const fs::path& folder, Access access) {
    auto lock = locked(folder, access);
    if (!lock) return tl::unexpected(lock.error());
    KeyStore store(folder, std::move(*lock));
    if (auto read = store.read_files(); !read) return tl::unexpected(read.error());
    return store;
}

Expected<void> KeyStore::read_files() {
    const fs::path store_file = folder_ / kStoreFile;
    const auto text = read_private_file(store_file, kMaxFileBytes);
    if (!text) return tl::unexpected(text.error());
    auto reader = config::TableReader::parse(*text, store_file.string());
    if (!reader) return tl::unexpected(reader.error());
    std::int64_t format = 0;
    reader->read("format", format);
    reader->read("world", world_);
    if (auto fine = reader->finish(); !fine) return fine;
    if (format != kStoreFormat)
        return make_error(ErrorKind::kInvalidData,
                          store_file.string() +
                              ": was made by another version of Atrium; install that version here");
    if (auto fine = check_key_name(world_, "the world"); !fine)
        return in_file(store_file, fine.error());
    const std::array<std::pair<std::string, std::string&>, 6> files{
        {{certificate_file(Authority::kIdentity), identity_.certificate},
         {key_file(Authority::kIdentity), identity_.private_key},
         {certificate_file(Authority::kPermissions), permissions_.certificate},
         {key_file(Authority::kPermissions), permissions_.private_key},
         {kGovernanceFile, governance_},
         {kCrlFile, crl_}}};
    for (const auto& [name, content] : files) {
        auto read = read_private_file(folder_ / name, kMaxFileBytes);
        if (!read) return tl::unexpected(read.error());
        content = std::move(*read);
    }
    auto revoked = read_crl(crl_, identity_.certificate);
    if (!revoked) return in_file(folder_ / kCrlFile, revoked.error());
    revoked_ = std::move(*revoked);
    end_ = Timestamp{std::numeric_limits<std::int64_t>::max()};
    for (const KeyPair* authority : {&identity_, &permissions_}) {
        const auto facts = facts_of_certificate(authority->certificate);
        if (!facts) return in_file(folder_, facts.error());
        end_ = std::min(end_, facts->validity.end);
    }
    return read_tunnel_file();
}

Expected<void> KeyStore::check(Timestamp now) const {
    const std::pair<Authority, const KeyPair&> authorities[] = {
        {Authority::kIdentity, identity_}, {Authority::kPermissions, permissions_}};
    for (const auto& [authority, pair] : authorities) {
        const fs::path file = folder_ / certificate_file(authority);
        if (auto fine = check_authority(authority, pair.certificate, world_, now); !fine)
            return in_file(file, fine.error());
        if (auto fine = check_key(pair.private_key, pair.certificate); !fine)
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: {}; restore it from a copy of the key store",
                                          (folder_ / key_file(authority)).string(),
                                          fine.error().message));
    }
    auto governance = verify_document(governance_, permissions_.certificate);
    if (!governance)
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: {}; restore it from a copy of the key store",
                                      (folder_ / kGovernanceFile).string(),
                                      governance.error().message));
    return {};
}

fs::path KeyStore::file_of(const std::string& name) const {
    return folder_ / kMembersFolder / (name + kBundleEnding);
}

Expected<std::vector<std::string>> KeyStore::names() const {
    std::vector<std::string> names;
    std::error_code failure;
    fs::directory_iterator entry(folder_ / kMembersFolder, failure);
    for (const fs::directory_iterator end; !failure && entry != end; entry.increment(failure)) {
        const fs::path& file = entry->path();
        if (file.extension() == kBundleEnding) names.push_back(file.stem().string());
    }
    if (failure)
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{}: cannot be read: {}; restore it from a copy of the key "
                                      "store",
                                      (folder_ / kMembersFolder).string(),
                                      failure.message()));
    std::ranges::sort(names);
    return names;
}

Expected<Bundle> KeyStore::bundle(const std::string& name) const {
    if (auto fine = check_key_name(name, "the member"); !fine) return tl::unexpected(fine.error());
    std::error_code failure;
    if (!fs::exists(file_of(name), failure))
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("world {} has no member '{}'; `atrium keys list` shows all", world_, name));
    auto bundle = read_bundle(file_of(name));
    if (!bundle) return bundle;
    if (bundle->member.name != name || bundle->member.world != world_)
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: is the bundle of {}; restore it from a copy of the key "
                                      "store",
                                      file_of(name).string(),
                                      describe(bundle->member)));
    bundle->identity_ca = identity_.certificate;
    bundle->permissions_ca = permissions_.certificate;
    bundle->governance = governance_;
    bundle->crl = crl_;
    bundle->tunnel = tunnel_of(tunnel_, name);
    return bundle;
}

Expected<Entry> KeyStore::entry_of(const Bundle& bundle, Timestamp now) const {
    const auto facts = facts_of_certificate(bundle.certificate);
    if (!facts) return in_file(file_of(bundle.member.name), facts.error());
    Entry entry{bundle.member, facts->validity, State::kValid, std::nullopt};
    const auto revoked = std::ranges::find(revoked_, facts->serial, &Revocation::serial);
    if (revoked != revoked_.end()) entry.revocation = *revoked;
    entry.state = state_at(now, entry.validity, entry.revocation.has_value());
    return entry;
}

Expected<std::vector<Entry>> KeyStore::entries(Timestamp now) const {
    const auto all = names();
    if (!all) return tl::unexpected(all.error());
    std::vector<Entry> entries;
    for (const std::string& name : *all) {
        const auto read = bundle(name);
        if (!read) return tl::unexpected(read.error());
        auto entry = entry_of(*read, now);
        if (!entry) return tl::unexpected(entry.error());
        entries.push_back(std::move(*entry));
    }
    return entries;
}

Expected<Bundle> KeyStore::make_bundle(const Member& member, int days, Timestamp now) const {
    if (auto fine = check(now); !fine) return tl::unexpected(fine.error());
    const Validity validity = within(validity_from(now, days), end_);
    auto made = make_certificate(identity_, member, validity);
    if (!made) return tl::unexpected(made.error());
    auto permissions = sign_document(permissions_xml(member, validity), permissions_);
    if (!permissions) return tl::unexpected(permissions.error());
    return Bundle{.member = member,
                  .identity_ca = identity_.certificate,
                  .permissions_ca = permissions_.certificate,
                  .certificate = std::move(made->certificate),
                  .private_key = std::move(made->private_key),
                  .crl = crl_,
                  .governance = governance_,
                  .permissions = std::move(*permissions)};
}

Expected<Entry> KeyStore::add(const Member& member, int days, Timestamp now) {
    if (auto fine = keys::check(member); !fine) return tl::unexpected(fine.error());
    const auto all = entries(now);
    if (!all) return tl::unexpected(all.error());
    for (const Entry& other : *all) {
        const std::string& taken = other.member.name;
        if (taken == member.name)
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("the name {} is taken by a {}; choose another one, or run `atrium keys "
                            "renew {}` for a new key",
                            taken,
                            kind_text(other.member.kind),
                            taken));
        // the programs of a site's hosts are named SITE.HOST
        const bool is_host =
            (other.member.kind == Kind::kSite && member.name.starts_with(taken + ".")) ||
            (member.kind == Kind::kSite && taken.starts_with(member.name + "."));
        if (is_host)
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("the names {} and {} could be those of a site and of one "
                                          "of its hosts; choose another name",
                                          taken,
                                          member.name));
    }
    auto made = make_bundle(member, days, now);
    if (!made) return tl::unexpected(made.error());
    if (auto written =
            write_private_file(file_of(member.name), bundle_text(*made), Existing::kKeep);
        !written)
        return tl::unexpected(written.error());
    return entry_of(*made, now);
}

Expected<void> KeyStore::write_crl(const std::vector<Revocation>& revoked, Timestamp now) {
    const Validity validity{validity_from(now, 1).begin, end_};
    auto crl = make_crl(identity_, revoked, validity);
    if (!crl) return tl::unexpected(crl.error());
    if (auto written = write_private_file(folder_ / kCrlFile, *crl, Existing::kReplace); !written)
        return written;
    crl_ = std::move(*crl);
    revoked_ = revoked;
    return {};
}

Expected<Entry> KeyStore::revoke(const std::string& name, Reason reason, Timestamp now) {
    const auto old = bundle(name);
    if (!old) return tl::unexpected(old.error());
    if (auto fine = check(now); !fine) return tl::unexpected(fine.error());
    const auto entry = entry_of(*old, now);
    if (!entry) return entry;
    if (entry->state == State::kRevoked)
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{} is revoked already; `atrium keys renew {}` gives it a new "
                        "key",
                        name,
                        name));
    const auto facts = facts_of_certificate(old->certificate);
    if (!facts) return tl::unexpected(facts.error());
    std::vector<Revocation> revoked = revoked_;
    revoked.push_back({facts->serial, now, reason});
    if (auto written = write_crl(revoked, now); !written) return tl::unexpected(written.error());
    if (reason != Reason::kReplaced && remove_place(tunnel_, name)) {
        if (auto written = write_tunnel_file(); !written) return tl::unexpected(written.error());
    }
    return entry_of(*old, now);
}

Expected<Entry> KeyStore::renew(const std::string& name,
                                std::optional<Rights> rights,
                                int days,
                                Timestamp now) {
    const auto old = bundle(name);
    if (!old) return tl::unexpected(old.error());
    Member member = old->member;
    if (rights) member.rights = *rights;
    if (auto fine = keys::check(member); !fine) return tl::unexpected(fine.error());
    const auto entry = entry_of(*old, now);
    if (!entry) return entry;
    auto made = make_bundle(member, days, now);
    if (!made) return tl::unexpected(made.error());
    // first: a crash in between must not leave a valid key that nobody knows of
    if (entry->state != State::kRevoked) {
        if (auto revoked = revoke(name, Reason::kReplaced, now); !revoked) return revoked;
    }
    made->crl = crl_;
    if (auto written = write_private_file(file_of(name), bundle_text(*made), Existing::kReplace);
        !written)
        return tl::unexpected(written.error());
    const auto changed = renew_place(tunnel_, name);
    if (!changed) return tl::unexpected(changed.error());
    if (*changed) {
        if (auto written = write_tunnel_file(); !written) return tl::unexpected(written.error());
    }
    return entry_of(*made, now);
}

}  // namespace atrium::keys
