#include "tools/tunnel/tunnel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace atrium::tunnel_tool {
namespace {

// A line of `wg show CARD dump` for a peer.
struct PeerState {
    std::string allowed;           // addresses
    std::string endpoint;          // as this host sees it
    std::int64_t handshake_s = 0;  // since 1970; 0: never
    std::uint64_t received = 0;
    std::uint64_t sent = 0;
};

struct CardState {
    std::string public_key;
    std::map<std::string, PeerState> peers;  // by public key
};

CardState state_of(const std::string& dump) {
    CardState card;
    std::istringstream lines(dump);
    std::string line;
    std::getline(lines, line);
    std::string private_key;
    std::istringstream(line) >> private_key >> card.public_key;
    while (std::getline(lines, line)) {
        std::istringstream fields(line);
        std::string key;
        std::string shared;
        PeerState state;
        if (fields >> key >> shared >> state.endpoint >> state.allowed >> state.handshake_s >>
            state.received >> state.sent)
            card.peers.emplace(key, state);
    }
    return card;
}

std::string heard_text(const PeerState& state, Timestamp now) {
    if (state.handshake_s == 0) return "never";
    const auto ago = std::max<std::int64_t>(0, now.ns / 1'000'000'000 - state.handshake_s);
    return fmt::format("{} s ago", ago);
}

}  // namespace

Expected<std::string> describe(const keys::Tunnel& tunnel,
                               const std::string& card,
                               Timestamp now,
                               const Run& run) {
    const auto dump = run({"wg", "show", card, "dump"}, {});
    if (!dump || dump->exit_code != 0)
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("the tunnel {} is not up, or only root may look at it: run `sudo atrium "
                        "tunnel up FILE`",
                        card));
    auto [public_key, states] = state_of(dump->text);
    if (public_key != tunnel.own().public_key)
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("the tunnel {} is up with other keys than those of {} in this file: for "
                        "another place, or from before `atrium keys renew`; run `sudo atrium "
                        "tunnel up FILE`",
                        card,
                        tunnel.name));
    std::string text = fmt::format("{}: {} of {}, hub {}\n{:<20}{:<16}{:<24}{:<14}{:>10}{:>10}\n",
                                   card,
                                   tunnel.own().address,
                                   tunnel.name,
                                   tunnel.hub,
                                   "place",
                                   "address",
                                   "seen at",
                                   "handshake",
                                   "in [kB]",
                                   "out [kB]");
    for (const keys::Place& place : tunnel.places) {
        if (place.name == tunnel.name) continue;
        const auto found = states.find(place.public_key);
        if (found == states.end()) {
            text += fmt::format(
                "{:<20}{:<16}{}\n",
                place.name,
                place.address,
                tunnel.is_hub() ? "not configured: run `atrium tunnel up`" : "through the hub");
            continue;
        }
        const PeerState& state = found->second;
        text += fmt::format("{:<20}{:<16}{:<24}{:<14}{:>10}{:>10}\n",
                            place.name,
                            place.address,
                            state.endpoint == "(none)" ? "-" : state.endpoint,
                            heard_text(state, now),
                            state.received / 1000,
                            state.sent / 1000);
        states.erase(found);
    }
    for (const auto& [key, state] : states)
        text += fmt::format("{:<20}{:<16}{}\n",
                            "?",
                            state.allowed.substr(0, state.allowed.find('/')),
                            "not in this file (revoked, or renewed): run `atrium tunnel up`");
    return text;
}

}  // namespace atrium::tunnel_tool
