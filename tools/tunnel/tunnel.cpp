#include "tools/tunnel/tunnel.hpp"

#include "core/base/fnv1a.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::tunnel_tool {
namespace {

bool has_card(const std::string& card, const Run& run) {
    const auto shown = run({"ip", "link", "show", "dev", card}, {});
    return shown && shown->exit_code == 0;
}

// A banner comes first.
std::string last_line(std::string text) {
    text.resize(text.find_last_not_of('\n') + 1);
    text.erase(0, text.rfind('\n') + 1);
    return text.substr(0, 200);
}

tl::unexpected<Error> no_wireguard(const std::string& why) {
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("this host has no WireGuard ({}); run `apt install "
                                  "wireguard-tools`, and if its kernel has no WireGuard `apt "
                                  "install wireguard-go`",
                                  why));
}

// wg quotes lines that it cannot read.
std::string without_keys_of(std::string_view input, std::string text) {
    constexpr std::string_view kLabel = "PrivateKey = ";
    const std::size_t label = input.find(kLabel);
    if (label == std::string_view::npos) return text;
    const std::size_t begin = label + kLabel.size();
    const std::string_view key = input.substr(begin, input.find('\n', begin) - begin);
    if (key.empty()) return text;
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at))
        text.replace(at, key.size(), "...");
    return text;
}

// In the kernel, or else in user space.
Expected<void> make_card(const std::string& card, const Run& run) {
    const auto made = run({"ip", "link", "add", "dev", card, "type", "wireguard"}, {});
    if (made && made->exit_code == 0) return {};
    if (made && made->text.find("Operation not permitted") != std::string::npos)
        return make_error(ErrorKind::kUnavailable,
                          "only root may change the network: put sudo before this command");
    const auto started = run({"wireguard-go", card}, {});
    if (!started || started->exit_code == kNoSuchProgram)
        return no_wireguard("neither in the kernel nor wireguard-go");
    if (started->exit_code != 0) return no_wireguard("wireguard-go: " + last_line(started->text));
    return {};
}

// Another place's keys on this card would throw that place out.
Expected<void> check_place(const keys::Tunnel& tunnel, const std::string& card, const Run& run) {
    const auto shown = run({"ip", "-4", "-o", "address", "show", "dev", card}, {});
    const std::string text = shown ? shown->text : std::string();
    const bool has_address = text.find("inet ") != std::string::npos;
    if (!has_address || text.find("inet " + tunnel.own().address + "/") != std::string::npos)
        return {};
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("{} is up for another place than {}; a second program on this "
                                  "host needs no second tunnel: start it with --join FILE; or run "
                                  "`atrium tunnel down` with this host's file before",
                                  card,
                                  tunnel.name));
}

// What comes out of the tunnel goes back into it, to this host, or nowhere.
Expected<void> pass_on_between_spokes(const keys::Tunnel& tunnel,
                                      const std::string& card,
                                      const Run& run) {
    const std::string table = std::to_string(hub_table(card));
    const std::vector<std::vector<std::string>> commands{
        {"sysctl", "-q", "-w", fmt::format("net/ipv4/conf/{}/forwarding=1", card)},
        {"ip", "route", "replace", tunnel.subnet(), "dev", card, "table", table},
        {"ip", "route", "replace", "unreachable", "default", "table", table}};
    for (const auto& command : commands)
        if (auto done = run_or_fail(run, command); !done) return tl::unexpected(done.error());
    const auto rules = run_or_fail(run, {"ip", "rule", "show", "iif", card});
    if (!rules) return tl::unexpected(rules.error());
    if (!rules->empty()) return {};
    auto added = run_or_fail(run, {"ip", "rule", "add", "iif", card, "lookup", table});
    return added ? Expected<void>() : tl::unexpected(added.error());
}

}  // namespace

int hub_table(const std::string& card) {
    Fnv1a hash;
    hash.add(card);
    return 51820 + static_cast<int>(hash.value() % 10000);
}

Expected<std::string> run_or_fail(const Run& run,
                                  const std::vector<std::string>& command,
                                  std::string_view input) {
    const auto output = run(command, input);
    if (output && output->exit_code == 0) return output->text;
    if (output && output->exit_code == kNoSuchProgram)
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("there is no program {}; run `apt install wireguard-tools "
                                      "iproute2 procps`",
                                      command.front()));
    std::string said =
        output ? without_keys_of(input, output->text).substr(0, 300) : std::string("no answer");
    for (char& c : said)
        if (c < ' ' || c > '~') c = ' ';
    const bool is_denied = said.find("not permitted") != std::string::npos ||
                           said.find("ermission denied") != std::string::npos;
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("`{}` failed: {}{}",
                                  fmt::join(command, " "),
                                  said,
                                  is_denied ? "; only root may change the network: put sudo before "
                                              "this command"
                                            : ""));
}

Expected<void> bring_up(const keys::Tunnel& tunnel, const std::string& card, const Run& run) {
    if (has_card(card, run)) {
        if (auto ours = check_place(tunnel, card, run); !ours) return ours;
    } else if (auto made = make_card(card, run); !made) {
        return made;
    }
    const auto configured =
        run_or_fail(run, {"wg", "syncconf", card, "/dev/stdin"}, keys::wireguard_text(tunnel));
    if (!configured) return tl::unexpected(configured.error());
    const std::vector<std::vector<std::string>> commands{
        {"ip", "address", "replace", tunnel.own().address + "/24", "dev", card},
        {"ip", "link", "set", "dev", card, "mtu", std::to_string(kTunnelMtu), "up"}};
    for (const auto& command : commands)
        if (auto done = run_or_fail(run, command); !done) return tl::unexpected(done.error());
    return tunnel.is_hub() ? pass_on_between_spokes(tunnel, card, run) : Expected<void>();
}

Expected<void> take_down(const keys::Tunnel& tunnel, const std::string& card, const Run& run) {
    if (tunnel.is_hub()) {
        // gone with the card, or never there
        const std::string table = std::to_string(hub_table(card));
        run({"ip", "rule", "del", "iif", card, "lookup", table}, {});
        run({"ip", "route", "flush", "table", table}, {});
    }
    if (!has_card(card, run)) return {};
    auto removed = run_or_fail(run, {"ip", "link", "delete", "dev", card});
    return removed ? Expected<void>() : tl::unexpected(removed.error());
}

}  // namespace atrium::tunnel_tool
