#include "core/bus/authentication.hpp"

#include "core/bus/authentication_internal.hpp"
#include "core/bus/cyclone_entities.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <type_traits>
#include <vector>

namespace atrium::bus {

using authentication::Finalize;
using authentication::guid_text;
using authentication::Init;
using authentication::kRevoked;
using authentication::log_cut;
using authentication::process;
using authentication::Process;

namespace {

constexpr const char* kOurPlugins = "libatrium_security.so";
constexpr std::array kCyclonesPlugins{"libdds_security_auth.so", "libdds_security_crypto.so"};
constexpr std::array kPluginNames{"authentication", "crypto"};

// Beside Cyclone's library, where Debian and others put the plugins.
std::filesystem::path cyclones_plugin(const char* name) {
    Dl_info info{};
    const auto address = reinterpret_cast<const void*>(&dds_create_domain);
    if (::dladdr(address, &info) == 0 || info.dli_fname == nullptr) return {};
    std::error_code error;
    const auto folder = std::filesystem::canonical(info.dli_fname, error).parent_path();
    for (const char* beside : {"libddsc0debian", "."}) {
        const auto file = folder / beside / name;
        if (std::filesystem::exists(file, error)) return file;
    }
    return {};
}

// In the next folder lib/atrium upwards from the program: /usr/lib/atrium, or that of the build.
std::filesystem::path our_plugins() {
    std::error_code error;
    auto folder = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    while (!error && folder.has_relative_path()) {
        const auto file = folder / "lib" / "atrium" / kOurPlugins;
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

Expected<std::string> install_security() {
    static std::mutex installing;
    const std::lock_guard lock(installing);
    Process& all = process();
    if (!all.path.empty()) return all.path;
    // All stay loaded until the process ends: Cyclone's threads may be in them.
    for (std::size_t i = 0; i < kCyclonesPlugins.size(); ++i) {
        const auto theirs = cyclones_plugin(kCyclonesPlugins[i]);
        if (theirs.empty())
            return not_loaded(fmt::format("{} is not beside libddsc.so", kCyclonesPlugins[i]));
        void* const library = ::dlopen(theirs.c_str(), RTLD_NOW);
        if (library == nullptr) return not_loaded(::dlerror());
        const std::string name = kPluginNames[i];
        all.init[i] = symbol<std::remove_pointer_t<Init>>(library, ("init_" + name).c_str());
        all.finalize[i] =
            symbol<std::remove_pointer_t<Finalize>>(library, ("finalize_" + name).c_str());
        if (all.init[i] == nullptr || all.finalize[i] == nullptr)
            return not_loaded(fmt::format("{} is of another version", theirs.string()));
    }
    const auto ours = our_plugins();
    if (ours.empty())
        return not_loaded(
            fmt::format("{} is in no folder lib/atrium above the program", kOurPlugins));
    void* const library = ::dlopen(ours.c_str(), RTLD_NOW);
    if (library == nullptr) return not_loaded(::dlerror());
    auto* const set = symbol<void(const Init*, const Finalize*)>(library, "atrium_set_security");
    if (set == nullptr) return not_loaded(fmt::format("{} is of another version", ours.string()));
    const std::array<Init, 2> init{authentication::init, authentication::init_crypto};
    const std::array<Finalize, 2> finalize{authentication::finalize,
                                           authentication::finalize_crypto};
    set(init.data(), finalize.data());
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
                if (peer.world != world || !serials.contains(peer.serial)) continue;
                cuts.push_back({instance.listener, plugin, identity, peer.name});
                const auto remote = instance.remotes.find(identity);
                if (remote != instance.remotes.end())
                    authentication::note_refusal(remote->second.text, peer.name, kRevoked);
            }
        }
    }
    for (const Cut& cut : cuts) {
        log_cut(cut.name, kRevoked);
        if (cut.listener != nullptr) cut.listener->on_revoke_identity(cut.plugin, cut.identity);
    }
}

void forget_participants(std::uint32_t domain, const std::vector<dds_guid_t>& participants) {
    if (participants.empty()) return;
    ddsi_domaingv* inside = nullptr;
    {
        Process& all = process();
        const std::lock_guard lock(all.mutex);
        for (const auto& [plugin, instance] : all.instances)
            if (instance.domain == domain) inside = plugin->gv;
    }
    if (inside == nullptr) return;
    for (const dds_guid_t& participant : participants)
        atrium_forget_participant(inside, participant.v);
}

Standing standing_of(const dds_guid_t& participant) {
    const std::string text = guid_text(participant.v);
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    Standing best = Standing::kNoKeys;
    for (const auto& [plugin, instance] : all.instances) {
        const auto alike = instance.by_text.equal_range(text);
        for (auto one = alike.first; one != alike.second; ++one) {
            const bool is_refused = instance.remotes.at(one->second).is_refused;
            best = std::max(best,
                            instance.peers.contains(one->second) ? Standing::kProven
                            : is_refused                         ? Standing::kRefused
                                                                 : Standing::kWaits);
        }
    }
    return best;
}

std::string refusal_of(const dds_guid_t& participant) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    const auto found = all.refusals.find(guid_text(participant.v));
    return found == all.refusals.end() ? std::string() : found->second;
}

std::string proven_name(const dds_guid_t& participant) {
    return proven_name_in(guid_text(participant.v));
}

std::string proven_name_in(const std::string& line) {
    Process& all = process();
    const std::lock_guard lock(all.mutex);
    for (const auto& [plugin, instance] : all.instances) {
        for (const auto& [identity, peer] : instance.peers) {
            const auto found = instance.remotes.find(identity);
            if (found != instance.remotes.end() &&
                line.find(found->second.text) != std::string::npos)
                return peer.name;
        }
    }
    return {};
}

}  // namespace atrium::bus
