#include "core/config/spelling.hpp"
#include "core/keys/bundle.hpp"
#include "core/keys/certificates.hpp"
#include "core/keys/store.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <fcntl.h>
#include <time.h>
#include <unistd.h>

#include <cstring>
#include <utility>

namespace atrium::doctor {
namespace {

constexpr std::size_t kMaxFiles = 256;

// "notAfter=Nov 28 01:00:00 2027 GMT" in the output of openssl.
std::optional<Timestamp> date_after(const std::string& output, const std::string& key) {
    for (const std::string& line : lines_of(output)) {
        if (line.rfind(key + "=", 0) != 0) continue;
        std::tm date{};
        const char* text = line.c_str() + key.size() + 1;
        if (strptime(text, "%b %d %H:%M:%S %Y", &date) == nullptr) return std::nullopt;
        return Timestamp{std::int64_t{timegm(&date)} * 1'000'000'000};
    }
    return std::nullopt;
}

bool has_suffix(const std::string& name) {
    for (const char* suffix : {".pem", ".crt", ".cer", ".key", ".bundle", ".invitation"}) {
        if (name.ends_with(suffix)) return true;
    }
    return false;
}

Certificate examine_certificate(const System& system,
                                const std::filesystem::path& file,
                                KeyFacts& keys) {
    Certificate certificate{file, {}, {}};
    const auto output =
        system.run({"openssl", "x509", "-in", file.string(), "-noout", "-startdate", "-enddate"});
    if (!output) return certificate;
    constexpr int kNoSuchProgram = 127;
    if (output->exit_code == kNoSuchProgram) keys.has_openssl = false;
    certificate.begins = date_after(output->text, "notBefore");
    certificate.ends = date_after(output->text, "notAfter");
    return certificate;
}

bool is_certificate(const std::string& text) {
    return text.find("-----BEGIN CERTIFICATE-----") != std::string::npos;
}

bool is_private_key(const std::string& text) {
    return text.find("PRIVATE KEY-----") != std::string::npos;
}

// On the owner's computer bundles lie beside the key store, whose list of revoked keys is newer.
// Empty: no store there has revoked it.
std::filesystem::path store_that_revoked(const keys::Bundle& bundle,
                                         const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const Timestamp now = Timestamp::now();
    std::error_code failure;
    std::filesystem::directory_iterator entry(folder, failure);
    for (const std::filesystem::directory_iterator end; !failure && entry != end;
         entry.increment(failure)) {
        const std::filesystem::path& path = entry->path();
        if (path.extension() != ".keys" || !keys::is_key_store(path)) continue;
        const auto store = keys::KeyStore::open(path, keys::KeyStore::Access::kRead);
        const auto own = store ? store->bundle(bundle.member.name) : Expected<keys::Bundle>();
        if (!store || !own || own->identity_ca != bundle.identity_ca) continue;
        const auto found = store->entry_of(bundle, now);
        if (found && found->state == keys::State::kRevoked) return path.lexically_normal();
    }
    return {};
}

// A bundle, whose first certificate is not that of its member. nullopt: it is none and need not be
// one.
std::optional<Certificate> examine_bundle(const std::filesystem::path& file,
                                          const std::string& text,
                                          mode_t mode,
                                          bool must_be_one) {
    Certificate certificate{file, {}, {}};
    const auto bundle = keys::parse_bundle(text, file.string());
    if (!bundle && !must_be_one) return std::nullopt;
    if (!bundle) {
        certificate.problem = bundle.error().message;
        return certificate;
    }
    certificate.member = keys::describe(bundle->member);
    certificate.member_name = bundle->member.name;
    certificate.is_open = (mode & 077U) != 0;
    if (certificate.is_open)
        certificate.problem = "others can read it, and programs then refuse it";
    const auto facts = keys::facts_of_certificate(bundle->certificate);
    if (!facts) {
        certificate.problem = facts.error().message;
        return certificate;
    }
    certificate.begins = facts->validity.begin;
    certificate.ends = facts->validity.end;
    // what is wrong at any time, not only now
    const auto usable = keys::check(*bundle, facts->validity.begin);
    if (!usable && certificate.problem.empty()) certificate.problem = usable.error().message;
    certificate.revoked_by = store_that_revoked(*bundle, file);
    return certificate;
}

// In a folder; or one file, whatever its name.
std::vector<std::filesystem::path> files_with_keys(const System& files,
                                                   const std::filesystem::path& where) {
    std::error_code error;
    if (std::filesystem::is_regular_file(where, error)) return {where};
    std::vector<std::filesystem::path> found;
    for (const std::string& name : files.names_in(std::filesystem::absolute(where).string())) {
        if (has_suffix(name) && found.size() < kMaxFiles) found.push_back(where / name);
    }
    return found;
}

}  // namespace

FolderFacts collect_folder(const System& system,
                           const std::filesystem::path& folder,
                           std::uint64_t test_bytes) {
    FolderFacts facts;
    facts.folder = folder;
    facts.free_bytes = system.free_bytes(folder).value_or(0);
    const bool has_room = facts.free_bytes > 2 * test_bytes;
    const auto speed = system.write_speed(folder, has_room ? test_bytes : 0);
    if (!speed) {
        facts.problem = speed.error().message;
    } else if (has_room) {
        facts.write_mb_per_s = *speed;
    }
    return facts;
}

KeyFacts collect_keys(const System& system, const std::filesystem::path& where) {
    KeyFacts keys;
    keys.folder = where;
    std::error_code error;
    const bool is_file = std::filesystem::is_regular_file(where, error);
    keys.is_there = is_file || std::filesystem::is_directory(where, error) ||
                    error == std::errc::permission_denied;
    keys.is_readable =
        !keys.is_there ||
        faccessat(AT_FDCWD, where.c_str(), is_file ? R_OK : R_OK | X_OK, AT_EACCESS) == 0;
    if (!keys.is_there) keys.meant = config::ask_which_path(where);
    const System files("/");
    for (const std::filesystem::path& file : files_with_keys(files, where)) {
        const std::string path = std::filesystem::absolute(file).string();
        const auto status = files.status_of(path);
        if (!status || !S_ISREG(status->st_mode)) continue;
        const std::string text = files.read(path).value_or("");
        const auto extension = file.extension();
        const bool must_be_bundle = extension == ".bundle" || extension == ".invitation" ||
                                    (is_file && !is_certificate(text) && !is_private_key(text));
        if (auto bundle = examine_bundle(file, text, status->st_mode, must_be_bundle)) {
            keys.certificates.push_back(std::move(*bundle));
            continue;
        }
        if (is_certificate(text))
            keys.certificates.push_back(examine_certificate(system, file, keys));
        // the services read keys as their group
        if (is_private_key(text) && (status->st_mode & (S_IWGRP | S_IRWXO)) != 0)
            keys.open_keys.push_back(file);
    }
    return keys;
}

}  // namespace atrium::doctor
