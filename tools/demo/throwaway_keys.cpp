#include "tools/demo/throwaway_keys.hpp"

#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"

#include <system_error>

namespace atrium::demo {
namespace {

constexpr int kDays = 60;  // none is near its end: that is warned about

Expected<void> add(keys::KeyStore& store,
                   const keys::Member& member,
                   const std::filesystem::path& file) {
    if (auto added = store.add(member, kDays, Timestamp::now()); !added)
        return tl::unexpected(added.error());
    const auto bundle = store.bundle(member.name);
    if (!bundle) return tl::unexpected(bundle.error());
    return keys::write_private_file(file, keys::bundle_text(*bundle), keys::Existing::kKeep);
}

}  // namespace

Expected<ThrowawayKeys> ThrowawayKeys::create(const std::filesystem::path& folder,
                                              const std::string& world,
                                              const std::vector<DemoSite>& sites) {
    ThrowawayKeys keys(folder);
    auto store = keys::KeyStore::create(folder, world, kDays, Timestamp::now());
    if (!store) return tl::unexpected(store.error());
    std::vector<std::pair<keys::Member, std::string>> members{
        {{world, keys::Kind::kWorld, world, {}}, "world"},
        {{world, keys::Kind::kViewer, "viewer", {}}, "viewer"},
        {{world, keys::Kind::kMonitor, "demo", {keys::Right::kReset}}, "demo"}};
    members[1].first.rights = keys::Rights::all();
    for (const DemoSite& site : sites)
        members.push_back({{world, keys::Kind::kSite, site.name, {}}, site.name});
    for (const auto& [member, program] : members)
        if (auto added = add(*store, member, keys.bundle_of(program)); !added)
            return tl::unexpected(added.error());
    return keys;
}

ThrowawayKeys::~ThrowawayKeys() {
    std::error_code failed;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, failed);
}

std::filesystem::path ThrowawayKeys::bundle_of(const std::string& program) const {
    return folder_ / (program + ".bundle");
}

}  // namespace atrium::demo
