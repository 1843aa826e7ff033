#include "core/bus/network_settings.hpp"

#include "core/base/split_list.hpp"
#include "core/bus/authentication.hpp"
#include "core/bus/builtin_files.hpp"
#include "core/bus/network_file.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <pugixml.hpp>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

namespace atrium::bus {

namespace {

// Cyclone's default if the file does not set SocketReceiveBufferSize.
constexpr std::size_t kDefaultReceiveBufferBytes = 1U << 20U;

// A datagram has at most 65507 bytes. Encryption adds 100, and 20 more for each receiver.
constexpr std::size_t kMaxSecuredMessageBytes = 62000;
constexpr std::size_t kMaxSecuredFragmentBytes = 61000;

Expected<std::string> resolve(const std::string& host) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int status = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
    if (status != 0) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("bus.peers: '{}' cannot be resolved ({}); use an IPv4 "
                                      "address or a host name that this host can resolve",
                                      host,
                                      ::gai_strerror(status)));
    }
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    ::freeaddrinfo(found);
    char text[INET_ADDRSTRLEN];
    return std::string(::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text));
}

/// Finds a card that is up; `source` names the key or file that asks for it.
Expected<NetworkCard> find_card(const std::string& name, const std::string& source) {
    std::string there;
    for (const NetworkCard& card : network_cards()) {
        if (card.name == name && card.is_up) return card;
        if (card.is_up) there += fmt::format(" {} ({})", card.name, card.address);
    }
    return make_error(
        ErrorKind::kConfiguration,
        fmt::format("{}: '{}' is missing, down or without an IPv4 address; available:{}",
                    source,
                    name,
                    there.empty() ? " none, `ip link set lo up` brings up at least lo" : there));
}

/// The card of the default route; without one, the first card that is up and not loopback.
std::optional<NetworkCard> usual_card() {
    std::string wanted;
    std::ifstream routes("/proc/net/route");
    for (std::string line; std::getline(routes, line);) {
        std::istringstream fields(line);
        std::string name;
        std::string destination;
        if (fields >> name >> destination && destination == "00000000" && wanted.empty())
            wanted = name;
    }
    std::optional<NetworkCard> first;
    for (const NetworkCard& card : network_cards()) {
        if (!card.is_up || card.is_loopback) continue;
        if (card.name == wanted) return card;
        if (!first) first = card;
    }
    return first;
}

pugi::xml_node child(pugi::xml_node parent, const char* name) {
    const pugi::xml_node found = parent.child(name);
    return found ? found : parent.append_child(name);
}

/// Reads and changes the one <Domain> of a file.
class DomainElement {
public:
    explicit DomainElement(const std::string& xml) {
        // keep the line ends between the elements, for the line numbers in Cyclone's errors
        document_.load_string(xml.c_str(), pugi::parse_default | pugi::parse_ws_pcdata);
        domain_ = child(document_.document_element(), "Domain");
    }

    std::string named_card() const {
        const std::string name = card_name();
        if (!name.empty()) return name;
        const pugi::xml_node general = domain_.child("General");
        const pugi::xml_node card = general.child("Interfaces").child("NetworkInterface");
        if (card.attribute("address")) return card.attribute("address").value();
        return general.child("NetworkInterfaceAddress").text().get();
    }

    /// The name of the card, if the settings have its name and not its address.
    std::string card_name() const {
        return domain_.child("General")
            .child("Interfaces")
            .child("NetworkInterface")
            .attribute("name")
            .value();
    }

    /// False if the settings are for another domain: Cyclone would ignore them.
    bool is_for(std::uint32_t domain) const {
        const std::string_view id = domain_.attribute("Id").value();
        return id.empty() || id == "any" || id == std::to_string(domain);
    }

    std::string id() const { return domain_.attribute("Id").value(); }

    void set_card(const std::string& name) {
        pugi::xml_node general = child(domain_, "General");
        const pugi::xml_attribute former =
            general.child("Interfaces").child("NetworkInterface").attribute("multicast");
        const std::string multicast = former.value();
        general.remove_child("Interfaces");
        general.remove_child("NetworkInterfaceAddress");
        pugi::xml_node card = general.prepend_child("Interfaces").append_child("NetworkInterface");
        card.append_attribute("name") = name.c_str();
        if (!multicast.empty()) card.append_attribute("multicast") = multicast.c_str();
    }

    void add_peer(const std::string& address) {
        pugi::xml_node peers = child(child(domain_, "Discovery"), "Peers");
        for (const pugi::xml_node& peer : peers.children("Peer")) {
            if (address == peer.attribute("Address").value()) return;
        }
        peers.append_child("Peer").append_attribute("Address") = address.c_str();
    }

    std::vector<std::string> peers() const {
        std::vector<std::string> addresses;
        for (const pugi::xml_node& peer :
             domain_.child("Discovery").child("Peers").children("Peer"))
            addresses.emplace_back(peer.attribute("Address").value());
        return addresses;
    }

    bool uses_multicast() const {
        const pugi::xml_node allowed = domain_.child("General").child("AllowMulticast");
        const std::string_view text = allowed.text().get();
        return !allowed || (text != "false" && text != "none");
    }

    std::size_t receive_buffer_bytes() const {
        return bytes_of(domain_.child("Internal")
                            .child("SocketReceiveBufferSize")
                            .attribute("max")
                            .value())
            .value_or(kDefaultReceiveBufferBytes);
    }

    bool has_security() const { return domain_.child("Security") || domain_.child("DDSSecurity"); }

    void set_security(const keys::Bundle& keys, const std::string& plugins) {
        pugi::xml_node security = domain_.append_child("Security");
        pugi::xml_node auth = security.append_child("Authentication");
        add_library(auth, plugins, "init_authentication", "finalize_authentication");
        add_data(auth, "IdentityCA", keys.identity_ca);
        add_data(auth, "IdentityCertificate", keys.certificate);
        add_data(auth, "PrivateKey", keys.private_key);
        add_data(auth, "CRL", keys.crl);
        pugi::xml_node access = security.append_child("AccessControl");
        add_library(access, "dds_security_ac", "init_access_control", "finalize_access_control");
        add_data(access, "PermissionsCA", keys.permissions_ca);
        add_data(access, "Governance", keys.governance);
        add_data(access, "Permissions", keys.permissions);
        pugi::xml_node crypto = security.append_child("Cryptographic");
        add_library(crypto, plugins, "init_crypto", "finalize_crypto");
        // What encryption adds must fit the largest datagram of UDP, also for many receivers.
        pugi::xml_node general = child(domain_, "General");
        limit(general, "MaxMessageSize", kMaxSecuredMessageBytes);
        limit(general, "FragmentSize", kMaxSecuredFragmentBytes);
        calm_down();
    }

    std::string text() const {
        std::ostringstream stream;
        document_.document_element().print(stream, "", pugi::format_raw);
        return stream.str();
    }

private:
    static std::optional<double> milliseconds_of(const std::string& text) {
        std::istringstream stream(text);
        double number = 0.0;
        std::string unit;
        if (!(stream >> number >> unit)) return std::nullopt;
        return unit == "s" ? 1e3 * number : unit == "ms" ? number : 1e-3 * number;
    }

    static std::optional<std::size_t> bytes_of(const std::string& text) {
        std::istringstream stream(text);
        double number = 0.0;
        std::string unit;
        if (!(stream >> number)) return std::nullopt;
        stream >> unit;
        const double factor = unit == "MB" || unit == "MiB"   ? 1 << 20
                              : unit == "kB" || unit == "KiB" ? 1 << 10
                                                              : 1;
        return static_cast<std::size_t>(number * factor);
    }

    // Until two programs have proven their keys, only announcements keep them in each other's
    // lists, and what one sends the other is not read. The short intervals of open worlds then lose
    // participants in the middle of a handshake, and more than a dozen programs fill a host with
    // heartbeats that nobody answers. Writers still lose their liveliness after a second.
    void calm_down() {
        child(child(domain_, "Discovery"), "LeaseDuration").text().set("10s");
        pugi::xml_node internal = child(domain_, "Internal");
        pugi::xml_node heartbeats = child(internal, "HeartbeatInterval");
        heartbeats.text().set("100ms");
        for (const auto& [name, value] :
             {std::pair("min", "5ms"), std::pair("minsched", "20ms"), std::pair("max", "8s")}) {
            heartbeats.remove_attribute(name);
            heartbeats.append_attribute(name) = value;
        }
        // of a link with a long round trip it is longer already
        pugi::xml_node delay = child(internal, "NackDelay");
        if (milliseconds_of(delay.text().get()).value_or(0.0) < 10.0) delay.text().set("10ms");
    }

    static void limit(pugi::xml_node general, const char* name, std::size_t max) {
        const auto bytes = bytes_of(general.child(name).text().get());
        if (bytes && *bytes > max)
            general.child(name).text().set((std::to_string(max) + " B").c_str());
    }

    static void add_library(pugi::xml_node plugin,
                            const std::string& path,
                            const char* init,
                            const char* finalize) {
        pugi::xml_node library = plugin.append_child("Library");
        library.append_attribute("path") = path.c_str();
        library.append_attribute("initFunction") = init;
        library.append_attribute("finalizeFunction") = finalize;
    }

    static void add_data(pugi::xml_node plugin, const char* name, const std::string& text) {
        plugin.append_child(name).text().set(("data:," + text).c_str());
    }

    pugi::xml_document document_;
    pugi::xml_node domain_;
};

bool is_this_host(const std::string& address) {
    if (address.rfind("127.", 0) == 0) return true;
    const auto cards = network_cards();
    return std::any_of(cards.begin(), cards.end(), [&](const NetworkCard& card) {
        return card.address == address;
    });
}

Expected<void> enter_card(const BusOptions& options,
                          bool is_builtin,
                          DomainElement& domain,
                          NetworkSettings& settings) {
    settings.card = domain.named_card();
    if (!options.interface.empty()) {
        const auto card = find_card(options.interface, "bus.interface");
        if (!card) return tl::unexpected(card.error());
        if (options.network == "loopback" && !card->is_loopback) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("bus.interface: bus.network = loopback uses no network "
                                          "card; add --network lan to use {}",
                                          card->name));
        }
        settings.card = card->name;
        domain.set_card(card->name);
    } else if (!domain.card_name().empty()) {
        const auto card = find_card(domain.card_name(), settings.source);
        if (!card) return tl::unexpected(card.error());
    } else if (settings.card.empty() && is_builtin) {
        if (const auto card = usual_card()) {
            settings.card = card->name;
            domain.set_card(card->name);
        }
    }
    for (const NetworkCard& card : network_cards()) {
        if (card.name != settings.card && card.address != settings.card) continue;
        settings.card = card.name;
        settings.address = card.address;
        break;
    }
    return {};
}

Expected<void> enter_peers(const BusOptions& options,
                           bool is_builtin,
                           DomainElement& domain,
                           NetworkSettings& settings) {
    for (const std::string& host : split_list(options.peers)) {
        const auto address = resolve(host);
        if (!address) return tl::unexpected(address.error());
        const bool is_remote = !is_this_host(*address);
        settings.has_remote_peers |= is_remote;
        if (is_remote && options.network == "loopback") {
            settings.unreachable_peers.push_back(host);
        } else {
            domain.add_peer(*address);
        }
    }
    // without multicast, programs of this host are found only as peers
    if (is_builtin && !settings.multicast && !settings.address.empty())
        domain.add_peer(settings.address);
    settings.peers = domain.peers();
    return {};
}

}  // namespace

std::vector<NetworkCard> network_cards() {
    std::vector<NetworkCard> cards;
    ifaddrs* list = nullptr;
    if (::getifaddrs(&list) != 0) return cards;
    for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
        if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
        sockaddr_in address{};
        std::memcpy(&address, entry->ifa_addr, sizeof address);
        char text[INET_ADDRSTRLEN];
        cards.push_back({entry->ifa_name,
                         ::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text),
                         (entry->ifa_flags & IFF_UP) != 0,
                         (entry->ifa_flags & IFF_LOOPBACK) != 0});
    }
    ::freeifaddrs(list);
    return cards;
}

Expected<NetworkSettings> load_network_settings(const BusOptions& options) {
    const auto builtin =
        std::find_if(kBuiltinNetworks.begin(), kBuiltinNetworks.end(), [&](const auto& network) {
            return network.kind == options.network;
        });
    const bool is_builtin = builtin != kBuiltinNetworks.end();
    NetworkSettings settings;
    settings.kind = options.network;
    settings.source = is_builtin ? "network " + options.network : options.network;
    const auto xml = is_builtin ? parse_network_file(builtin->xml, settings.source)
                                : load_network_file(options.network);
    if (!xml) return tl::unexpected(xml.error());
    DomainElement domain(*xml);
    if (!domain.is_for(options.domain)) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: <Domain Id=\"{}\"> does not apply to domain {}: write Id=\"any\", or "
                        "--bus.domain {}",
                        settings.source,
                        domain.id(),
                        options.domain,
                        domain.id()));
    }
    settings.multicast = domain.uses_multicast();
    settings.receive_buffer_bytes = domain.receive_buffer_bytes();
    if (auto entered = enter_card(options, is_builtin, domain, settings); !entered)
        return tl::unexpected(entered.error());
    if (auto entered = enter_peers(options, is_builtin, domain, settings); !entered)
        return tl::unexpected(entered.error());
    if (options.keys) {
        if (domain.has_security())
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("{}: has <Security>, and --security gives keys as well; take one of "
                            "both out",
                            settings.source));
        const auto plugins = install_security();
        if (!plugins) return tl::unexpected(plugins.error());
        domain.set_security(*options.keys, *plugins);
    }
    settings.is_secured = options.keys != nullptr || domain.has_security();
    settings.xml = domain.text();
    return settings;
}

}  // namespace atrium::bus
