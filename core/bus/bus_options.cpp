#include "core/bus/bus_options.hpp"

#include "core/bus/limits.hpp"
#include "core/bus/network_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace atrium::bus {
namespace {

constexpr const char* kVariable = "ATRIUM_SECURITY";
// A script's variable that is not set must not open the world.
constexpr const char* kGiveKeys = "give a bundle of `atrium keys`, or `none` for an open world";

}  // namespace

void declare(BusOptions& options, config::OptionSet& set) {
    set.add("bus.world",
            options.world,
            "name of the shared world; programs of different worlds do not exchange data");
    set.add_alias("world");
    set.add("bus.domain",
            options.domain,
            "DDS domain; each domain uses its own UDP ports",
            {0, kMaxDomain});
    set.add_word_or_path("bus.network",
                         options.network,
                         "network of the other programs: loopback (this host), lan (wired), wifi, "
                         "wan (routed), or the path of a Cyclone DDS file",
                         {"loopback", "lan", "wifi", "wan"});
    set.add_alias("network");
    set.add("bus.peers",
            options.peers,
            "additional hosts to discover, \"a,b\"; for wan and networks without multicast");
    set.add_alias("peers");
    set.add("bus.interface",
            options.interface,
            "network card, for example eth0; empty: the card of the default route");
    set.add_alias("interface");
    set.add("bus.profiles_file",
            options.profiles_file,
            "QoS profiles (DDS-XML); empty: the built-in copy of qos/profiles.xml");
    set.add_word_or_path(
        "bus.security",
        options.security,
        "keys of this program: a bundle of `atrium keys`; the world is then closed "
        "to all without keys; not given: $ATRIUM_SECURITY",
        {"none"});
    set.add_alias("security");
    set.refuse_empty(kGiveKeys);
    set.add("bus.join",
            options.join,
            "invitation of `atrium keys invite`: the keys, and the way through the internet");
    set.add_alias("join");
    set.refuse_empty("give an invitation of `atrium keys invite`, or leave the option out");
}

namespace {

// Where the bundle is, and what says so, for errors.
struct KeySource {
    std::string file;  // empty: a world without keys
    const char* name = "bus.security";
};

Expected<KeySource> source_of_keys(const BusOptions& options) {
    const auto file_or_none = [](const std::string& text) {
        return text == "none" ? std::string() : text;
    };
    if (!options.join.empty()) return KeySource{options.join, "bus.join"};
    if (!options.security.empty()) return KeySource{file_or_none(options.security)};
    if (const char* file = std::getenv(kVariable); file != nullptr) {
        if (*file == '\0')
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}: the variable is empty: {}; or unset it", kVariable, kGiveKeys));
        return KeySource{file_or_none(file), kVariable};
    }
    const char* credentials = std::getenv("CREDENTIALS_DIRECTORY");
    if (credentials == nullptr) return KeySource{};
    const std::filesystem::path file = std::filesystem::path(credentials) / "bundle";
    std::error_code error;
    return KeySource{std::filesystem::exists(file, error) ? file.string() : std::string()};
}

tl::unexpected<Error> wrong_keys(const KeySource& source, const std::string& what) {
    return make_error(ErrorKind::kConfiguration, fmt::format("{}: {}", source.name, what));
}

Expected<void> enter_tunnel(BusOptions& options,
                            const std::string& file,
                            const keys::Bundle& bundle) {
    if (!bundle.tunnel)
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("bus.join: {} has no tunnel: take a file of `atrium keys "
                                      "invite`, or give this one with --security",
                                      file));
    const std::string card = keys::tunnel_card(bundle.member.world);
    const auto cards = network_cards();
    const bool is_up = std::ranges::any_of(
        cards, [&](const NetworkCard& known) { return known.name == card && known.is_up; });
    if (!is_up)
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("bus.join: the tunnel {} is not up: run `sudo atrium tunnel "
                                      "up '{}'`",
                                      card,
                                      file));
    options.network = "wan";
    options.interface = card;
    for (const keys::Place& place : bundle.tunnel->places) {
        if (place.name == bundle.member.name) continue;
        options.peers += (options.peers.empty() ? "" : ",") + place.address;
    }
    return {};
}

}  // namespace

Expected<void> enter_keys(BusOptions& options) {
    if (options.keys) return {};
    const auto source = source_of_keys(options);
    if (!source) return tl::unexpected(source.error());
    const auto& [file, key] = *source;
    if (file.empty()) return {};
    if (!options.join.empty() && !options.security.empty() && options.security != options.join)
        return make_error(ErrorKind::kConfiguration,
                          "bus.join: --security is given as well; an invitation has the keys, so "
                          "leave --security out");
    const auto bundle = keys::read_bundle(file);
    if (!bundle)
        return make_error(bundle.error().kind, fmt::format("{}: {}", key, bundle.error().message));
    const keys::Member& member = bundle->member;
    if (const auto fine = keys::check(*bundle, Timestamp::now()); !fine)
        return make_error(fine.error().kind,
                          fmt::format("{}: {}: {}", key, file, fine.error().message));
    const std::string& world = options.world;
    if (!world.empty() && world != BusOptions().world && world != member.world)
        return wrong_keys(*source,
                          fmt::format("{} has keys of the world '{}', and --world is '{}'; leave "
                                      "--world out, or take keys of that world",
                                      file,
                                      member.world,
                                      world));
    if (!options.join.empty()) {
        if (auto entered = enter_tunnel(options, file, *bundle); !entered) return entered;
    }
    options.world = member.world;
    options.security = std::filesystem::absolute(file).string();
    options.keys = std::make_shared<const keys::Bundle>(*bundle);
    return {};
}

Expected<void> enter_keys(BusOptions& options, keys::Kind kind, std::string& name) {
    const auto found = source_of_keys(options);
    if (auto entered = enter_keys(options); !entered || !options.keys) return entered;
    const KeySource source = found ? *found : KeySource{};
    const keys::Member& member = options.keys->member;
    if (member.kind != kind) {
        const bool has_name = kind != keys::Kind::kWorld;
        return wrong_keys(
            source,
            fmt::format(
                "{} has the keys of {}, this program needs those of a {}: `atrium keys add {}{}`",
                options.security,
                describe(member),
                kind_text(kind),
                kind_text(kind),
                has_name ? " NAME" : ""));
    }
    if (name.empty()) name = member.name;
    if (name != member.name)
        return wrong_keys(source,
                          fmt::format("{} has the keys of {}, and this program is named '{}'; take "
                                      "the keys of '{}', or the name '{}'",
                                      options.security,
                                      describe(member),
                                      name,
                                      name,
                                      member.name));
    return {};
}

}  // namespace atrium::bus
