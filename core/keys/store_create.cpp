#include "core/base/write_check.hpp"
#include "core/keys/documents.hpp"
#include "core/keys/permissions.hpp"
#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"
#include "core/keys/store_files_internal.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace atrium::keys {
namespace {

namespace fs = std::filesystem;

Expected<void> write_new_store(const fs::path& folder,
                               const std::string& world,
                               Validity validity) {
    auto identity = make_authority(Authority::kIdentity, world, validity);
    if (!identity) return tl::unexpected(identity.error());
    auto permissions = make_authority(Authority::kPermissions, world, validity);
    if (!permissions) return tl::unexpected(permissions.error());
    auto governance = sign_document(governance_xml(), *permissions);
    if (!governance) return tl::unexpected(governance.error());
    auto crl = make_crl(*identity, {}, validity);
    if (!crl) return tl::unexpected(crl.error());
    const std::array<std::pair<std::string, std::string>, 7> files{
        {{certificate_file(Authority::kIdentity), identity->certificate},
         {key_file(Authority::kIdentity), identity->private_key},
         {certificate_file(Authority::kPermissions), permissions->certificate},
         {key_file(Authority::kPermissions), permissions->private_key},
         {kGovernanceFile, *governance},
         {kCrlFile, *crl},
         {kStoreFile,
          fmt::format("# The keys of world {}. Keep this folder secret, and a copy of it elsewhere."
                      "\nformat = {}\nworld = \"{}\"\n",
                      world,
                      kStoreFormat,
                      world)}}};
    for (const auto& [name, text] : files) {
        if (auto written = write_private_file(folder / name, text, Existing::kKeep); !written)
            return written;
    }
    return {};
}

}  // namespace

Expected<KeyStore> KeyStore::create(const fs::path& folder,
                                    const std::string& world,
                                    int days,
                                    Timestamp now) {
    if (auto fine = check_key_name(world, "the world"); !fine) return tl::unexpected(fine.error());
    const auto exists = [&] {
        return make_error(ErrorKind::kConfiguration,
                          folder.string() +
                              ": exists already; give another folder with --keys, or "
                              "add members to this one");
    };
    struct stat info {};
    if (::lstat(folder.c_str(), &info) == 0) return exists();
    // complete under another name before it appears
    fs::path plain = folder.lexically_normal();
    if (!plain.has_filename()) plain = plain.parent_path();
    const fs::path temporary = fmt::format("{}.{}.new", plain.string(), ::getpid());
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    if (::mkdir(temporary.c_str(), 0700) != 0 ||
        ::mkdir((temporary / kMembersFolder).c_str(), 0700) != 0)
        return tl::unexpected(cannot_write(plain, "create", errno));
    auto written = write_new_store(temporary, world, validity_from(now, days));
    if (written && ::rename(temporary.c_str(), plain.c_str()) != 0) {
        const int error = errno;
        fs::remove_all(temporary, ignored);
        if (error == EEXIST || error == ENOTEMPTY || error == ENOTDIR) return exists();
        return tl::unexpected(cannot_write(plain, "create", error));
    }
    if (!written) {
        fs::remove_all(temporary, ignored);
        return tl::unexpected(written.error());
    }
    return open(plain, Access::kWrite);
}

}  // namespace atrium::keys
