#include "core/bus/authentication.hpp"

#include "core/bus/authentication_internal.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <vector>

namespace atrium::bus {

using authentication::finalize;
using authentication::guid_text;
using authentication::init;
using authentication::log_cut;
using authentication::process;
using authentication::Process;

namespace {

constexpr const char* kOurPlugin = "libatrium_authentication.so";
constexpr const char* kCyclonesPlugin = "libdds_security_auth.so";

// Beside Cyclone's library, where Debian and others put the plugins.
std::filesystem::path cyclones_plugin() {
    Dl_info info{};
    const auto address = reinterpret_cast<const void*>(&dds_create_domain);
    if (::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
    std::error_code error;
    const auto folder = std::filesystem::canonical(info.dli_fname, error).parent_path();
    for (const char* beside : {"libddsc0debian", "."}) {
        const auto file = folder / beside / kCyclonesPlugin;
        if (std::filesystem::exists(file, error)) return file;
    }
    return {};
}

// In the next folder lib/atrium upwards from the program: /usr/lib/atrium, or that of the build.
std::filesystem::path our_plugin() {
    std::error_code error;
    auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    while (!error && folder.has_relative_path()) {
        const auto file = folder / "lib" / "atrium" / kOurPlugin;
        if (std::filesystem::exists(file, error)) return file;
        folder = folder.parent_path();
    }
    return {};
}

tl::unexpected<Error> not_loaded(const std::string& what) {
    return make_error(
        ErrorKind::kNotFound,
        fmt::format("cannot encrypt: {}; install Atrium and libddsc0debian again", what));
}

template <typename Function>
Function* symbol(void* library, const char* name) {
    return reinterpret_cast<Function*>(::dlsym(library, name));
}

}  // namespace

Expected<std::string> install_authentication() {
    static std::mutex installing;
    const std::lock_guard lock(installing);
    Process& all = process();
    if (!all.path.empty()) return all.path;
    const auto theirs = cyclones_plugin();
    if (theirs.empty())
        return not_loaded(fmt::format("{} is not beside libddsc.so", kCyclonesPlugin));
    const auto ours = our_plugin();
    if (ours.empty())
        return not_loaded(
            fmt::format("{} is in no folder lib/atrium above the program", kOurPlugin));
    // Both stay loaded until the process ends: Cyclone's threads may be in them.
    void* const their_library = ::dlopen(theirs.c_str(), RTLD_NOW);
    if (their_library == nullptr) return not_loaded(::dlerror());
    void* const our_library = ::dlopen(ours.c_str(), RTLD_NOW);
    if (our_library == nullptr) return not_loaded(::dlerror());
    all.init = symbol<int(const char*, void**, void*)>(their_library, "init_authentication");
    all.finalize = symbol<int(void*)>(their_library, "finalize_authentication");
    auto* const set = symbol<void(decltype(&init), decltype(&finalize))>(
        our_library, "atrium_set_authentication");
    if (all.init == nullptr || all.finalize == nullptr || set == nullptr)
        return not_loaded("the plugins are of other versions");
    set(&init, &finalize);
    all.path = ours.string();
    return all.path;
}

void refuse_keys(const std::string& world, const std::set<std::string>& serials) {
    struct Cut {
        const dds_security_authentication_listener* listener;
        const authentication::Plugin* plugin;
        authentication::Identity identity;
        std::string name;
    };
    std::vector<Cut> cuts;
    Process& all = process();
    {
        const std::lock_guard lock(all.mutex);
        all.refused[world].insert(serials.begin(), serials.end());
        for (const auto& [plugin, instance] : all.instances) {
            for (const auto& [identity, peer] : instance.peers) {
                if (peer.world == world && serials.contains(peer.serial))
                    cuts.push_back({instance.listener, plugin, identity, peer.name});
            }
        }
    }
    for (const Cut& cut : cuts) {
        log_cut(cut.name, "its key is revoked");
        if (cut.listener != nullptr) cut.listener->on_revoke_identity(cut.plugin, cut.identity);
    }
}

std::string proven_name(const dds_guid_t& participant) {
    return proven_name_in(guid_text(participant.v));
}

std::string proven_name_in(const std::string& line) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    for (const auto& [plugin, instance] : all.instances) {
        for (const auto& [identity, peer] : instance.peers) {
            const auto guid = instance.guids.find(identity);
            if (guid != instance.guids.end() && line.find(guid->second) != std::string::npos)
                return peer.name;
        }
    }
    return {};
}

}  // namespace atrium::bus
