#include "tools/keys/next_steps.hpp"

#include <fmt/format.h>

#include <vector>

namespace atrium::keys_tool {
namespace {

using keys::Bundle;
using keys::KeyStore;
using keys::Kind;

// The file that a member's program was started with, as `export_command` names it.
std::string file_for(const Bundle& bundle) {
    return bundle.member.name + (bundle.tunnel ? ".invitation" : ".bundle");
}

// What the members have whose keys others accept now, without `except`.
std::vector<Bundle> bundles_in_use(const KeyStore& store,
                                   const std::string& except,
                                   Timestamp now) {
    std::vector<Bundle> bundles;
    const auto entries = store.entries(now);
    if (!entries) return bundles;
    for (const keys::Entry& entry : *entries) {
        const bool is_used =
            entry.state == keys::State::kValid || entry.state == keys::State::kExpiresSoon;
        if (!is_used || entry.member.name == except) continue;
        if (auto bundle = store.bundle(entry.member.name)) bundles.push_back(std::move(*bundle));
    }
    return bundles;
}

// Bundles carry the list of revoked certificates: the world server tells it to all others.
std::string spread_list(const Options& options,
                        const KeyStore& store,
                        const std::string& except,
                        Timestamp now) {
    std::string to_world_server;
    std::string to_all;
    for (const Bundle& bundle : bundles_in_use(store, except, now)) {
        const std::string line = "  " + export_command(options, bundle, " --replace") + "\n";
        to_all += line;
        if (bundle.member.kind != Kind::kWorld) continue;
        to_world_server += line;
        if (bundle.tunnel)
            to_world_server += fmt::format(
                "and there, for the tunnel:\n  sudo atrium tunnel up {}\n", file_for(bundle));
    }
    if (!to_world_server.empty())
        return "Bring the new list of revoked keys to the world server, over the file that it was "
               "started with. Two seconds later it and all others refuse the old key:\n" +
               to_world_server;
    if (to_all.empty()) return {};
    return "Others refuse the old key when their bundles have the new list of revoked keys: "
           "export them again, over the files that their programs were started with:\n" +
           to_all;
}

std::string invite_command(const Options& options, const keys::Member& member) {
    return command(
        options, fmt::format("invite {} {} --replace", keys::kind_text(member.kind), member.name));
}

}  // namespace

std::string export_command(const Options& options, const Bundle& bundle, const char* more) {
    return command(options,
                   fmt::format("export {} -o {}{}", bundle.member.name, file_for(bundle), more));
}

std::string steps_after_renewal(const Options& options,
                                const KeyStore& store,
                                const Bundle& renewed,
                                Timestamp now) {
    const std::string& name = renewed.member.name;
    std::string text = fmt::format("next: {}\n", export_command(options, renewed, " --replace")) +
                       without_tunnel(options, store, renewed);
    if (renewed.member.kind == Kind::kWorld)
        // it tells the list in its new file at once, also that its own old key is on it
        return text +
               "Bring it to the host of the world server, over the file that it was started with, "
               "and start the world server again at once: a running one keeps its old key, which "
               "all others refuse two seconds after the copy.\n";
    text += fmt::format(
        "Bring it to the host of {}, over the file that its program was started with{}, and start "
        "that program again: a running one keeps its old key.\n",
        name,
        renewed.tunnel ? fmt::format(", run `sudo atrium tunnel up {}` there", file_for(renewed))
                       : std::string());
    return text + spread_list(options, store, name, now);
}

std::string steps_after_revocation(const Options& options,
                                   const KeyStore& store,
                                   const Bundle& revoked,
                                   Timestamp now) {
    const std::string& name = revoked.member.name;
    const bool lost_its_place = revoked.tunnel && !revoked.tunnel->is_hub();
    return spread_list(options, store, name, now) +
           fmt::format("A new key for it: {}\n", command(options, "renew " + name)) +
           (lost_its_place ? fmt::format("and then a new place in the tunnel: {}\n",
                                         invite_command(options, revoked.member))
                           : std::string());
}

std::string without_tunnel(const Options& options, const KeyStore& store, const Bundle& bundle) {
    if (bundle.tunnel || store.hub().empty()) return {};
    return fmt::format("It has no tunnel: {} has no place in that of this world. For one: {}\n",
                       bundle.member.name,
                       invite_command(options, bundle.member));
}

}  // namespace atrium::keys_tool
