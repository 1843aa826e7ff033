#include "core/config/table_reader.hpp"
#include "core/keys/private_file.hpp"
#include "core/keys/store.hpp"
#include "core/keys/store_files_internal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace atrium::keys {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTunnelFileBytes = std::size_t{256} << 10U;

tl::unexpected<Error> unfit(const std::string& what) {
    return make_error(ErrorKind::kConfiguration, what);
}

// The place that a member has, or would have.
std::ptrdiff_t index_of(const StoredTunnel& tunnel, const std::string& name) {
    return std::ranges::find(tunnel.places, name, &Place::name) - tunnel.places.begin();
}

// The first address of the subnet that no place has; empty: all are taken.
std::string free_address(const StoredTunnel& tunnel) {
    const std::string& hub = tunnel.places.front().address;
    const std::string subnet = hub.substr(0, hub.rfind('.') + 1);
    std::set<std::string> taken;
    for (const Place& place : tunnel.places) taken.insert(place.address);
    for (std::size_t last = 1; last <= kMaxPlaces; ++last) {
        std::string address = subnet + std::to_string(last);
        if (!taken.contains(address)) return address;
    }
    return {};
}

}  // namespace

std::optional<Tunnel> tunnel_of(const StoredTunnel& tunnel, const std::string& name) {
    const auto at = static_cast<std::size_t>(index_of(tunnel, name));
    if (at >= tunnel.places.size()) return std::nullopt;
    return Tunnel{tunnel.hub, name, tunnel.private_keys[at], tunnel.places};
}

Expected<bool> renew_place(StoredTunnel& tunnel, const std::string& name) {
    const auto at = index_of(tunnel, name);
    if (at == 0 || at >= std::ssize(tunnel.places)) return false;
    const auto keys = make_tunnel_keys();
    if (!keys) return tl::unexpected(keys.error());
    tunnel.places[static_cast<std::size_t>(at)].public_key = keys->public_key;
    tunnel.private_keys[static_cast<std::size_t>(at)] = keys->private_key;
    return true;
}

bool remove_place(StoredTunnel& tunnel, const std::string& name) {
    const auto at = index_of(tunnel, name);
    if (at == 0 || at >= std::ssize(tunnel.places)) return false;
    tunnel.places.erase(tunnel.places.begin() + at);
    tunnel.private_keys.erase(tunnel.private_keys.begin() + at);
    return true;
}

Expected<void> KeyStore::read_tunnel_file() {
    const fs::path file = folder_ / kTunnelFile;
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return {};
    const auto text = read_private_file(file, kMaxTunnelFileBytes);
    if (!text) return tl::unexpected(text.error());
    const auto damaged = [&](const std::string& why) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{}: {}; restore it from a copy of the key store", file.string(), why));
    };
    auto reader = config::TableReader::parse(*text, file.string());
    if (!reader) return damaged("is damaged");
    std::vector<std::string> private_keys;
    reader->read("private_keys", private_keys);
    config::TableReader table = reader->table("tunnel");
    auto tunnel = read_tunnel(table);
    if (!tunnel) return damaged(tunnel.error().message);
    if (!reader->finish() || private_keys.size() != tunnel->places.size() ||
        !std::ranges::all_of(private_keys, is_tunnel_key))
        return damaged("is damaged");
    tunnel_ = {tunnel->hub, std::move(tunnel->places), std::move(private_keys)};
    return {};
}

Expected<void> KeyStore::write_tunnel_file() const {
    std::string text = "private_keys = [\n";
    for (const std::string& key : tunnel_.private_keys) text += fmt::format("    \"{}\",\n", key);
    text += "]\n" + tunnel_text(*tunnel_of(tunnel_, tunnel_.places.front().name));
    return write_private_file(folder_ / kTunnelFile, text, Existing::kReplace);
}

Expected<void> KeyStore::add_place(const std::string& name, const std::string& hub) {
    const auto members = names();
    if (!members) return tl::unexpected(members.error());
    if (std::ranges::find(*members, name) == members->end())
        return unfit(
            fmt::format("world {} has no member '{}'; `atrium keys list` shows all", world_, name));
    StoredTunnel tunnel = tunnel_;
    if (!hub.empty()) tunnel.hub = hub;
    if (tunnel.hub.empty())
        return unfit(
            "the tunnel has no hub yet: give the address of the world server's host, as "
            "others reach it over the internet, with --hub HOST");
    const auto add = [&tunnel](const std::string& member,
                               const std::string& address) -> Expected<void> {
        const auto keys = make_tunnel_keys();
        if (!keys) return tl::unexpected(keys.error());
        tunnel.places.push_back({member, address, keys->public_key});
        tunnel.private_keys.push_back(keys->private_key);
        return {};
    };
    if (tunnel.places.empty()) {
        std::string world_server;
        for (const std::string& member : *members) {
            const auto read = bundle(member);
            if (!read) return tl::unexpected(read.error());
            if (read->member.kind == Kind::kWorld) world_server = member;
        }
        if (world_server.empty())
            return unfit(
                "the hub of the tunnel is the world server, which has no keys yet: run "
                "`atrium keys add world` before");
        const auto subnet = draw_subnet();
        if (!subnet) return tl::unexpected(subnet.error());
        if (auto added = add(world_server, *subnet + ".1"); !added) return added;
    }
    if (index_of(tunnel, name) == std::ssize(tunnel.places)) {
        const std::string address = free_address(tunnel);
        if (address.empty()) return unfit("all addresses of the tunnel are taken");
        if (auto added = add(name, address); !added) return added;
    }
    tunnel_ = std::move(tunnel);
    return write_tunnel_file();
}

}  // namespace atrium::keys
