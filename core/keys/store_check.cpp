#include "core/keys/store.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

namespace atrium::keys {
namespace {

namespace fs = std::filesystem;

// Files and folders that others can read, each with the command that mends it.
std::vector<std::string> open_modes(const fs::path& folder) {
    std::vector<std::string> problems;
    const auto look_at = [&](const fs::path& path) {
        struct stat info {};
        if (::lstat(path.c_str(), &info) != 0 || S_ISLNK(info.st_mode)) return;
        if ((info.st_mode & 077U) == 0) return;
        problems.push_back(fmt::format("{}: others can read it (mode {:04o}); run `chmod {} '{}'`",
                                       path.string(),
                                       info.st_mode & 07777U,
                                       S_ISDIR(info.st_mode) ? "700" : "600",
                                       path.string()));
    };
    look_at(folder);
    std::error_code failure;
    fs::recursive_directory_iterator entry(folder, failure);
    for (const fs::recursive_directory_iterator end; !failure && entry != end;
         entry.increment(failure))
        look_at(entry->path());
    std::ranges::sort(problems);
    return problems;
}

}  // namespace

std::vector<std::string> problems_of_store(const fs::path& folder, Timestamp now) {
    // of another folder open() says what it is
    std::vector<std::string> problems =
        is_key_store(folder) ? open_modes(folder) : std::vector<std::string>();
    if (!problems.empty()) return problems;  // the rest reads nothing that others could read
    const auto store = KeyStore::open(folder, KeyStore::Access::kRead);
    if (!store) return {store.error().message};
    const auto checked = store->check(now);
    if (!checked) problems.push_back(checked.error().message);
    const auto names = store->names();
    if (!names) return {names.error().message};
    for (const std::string& name : *names) {
        const auto bundle = store->bundle(name);
        const auto entry = bundle ? store->entry_of(*bundle, now) : tl::unexpected(bundle.error());
        if (!entry) {
            problems.push_back(entry.error().message);
            continue;
        }
        const bool is_in_use = entry->state != State::kRevoked && entry->state != State::kExpired;
        if (!is_in_use || !checked) continue;  // each member has the problems of its store
        if (auto fine = check(*bundle, now); !fine)
            problems.push_back(describe(bundle->member) + ": " + fine.error().message);
    }
    return problems;
}

}  // namespace atrium::keys
