#include "tools/doctor/checks/checks.hpp"
#include "tools/doctor/facts/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::doctor {
namespace {

constexpr int kJumboMtu = 8000;  // less than this is small
constexpr int kWantedMtu = 9000;
constexpr double kFilling = 0.9;                  // of a link, with the heads of the packets
constexpr std::uint64_t kRealtime = 10;           // capture.cameras.realtime_priority
constexpr std::uint32_t kLinkLocal = 0xA9FE0000;  // 169.254.0.0/16

bool is_link_local(std::uint32_t address) { return (address & 0xFFFF0000U) == kLinkLocal; }

bool has_link_local(const Card& card) {
    return std::any_of(card.addresses.begin(), card.addresses.end(), [](const CardAddress& one) {
        return is_link_local(one.address);
    });
}

bool has_gige(const Facts& facts) {
    return facts.cameras.found && std::any_of(facts.cameras.found->begin(),
                                              facts.cameras.found->end(),
                                              [](const FoundCamera& one) { return one.is_gige; });
}

// The addresses of cameras that answer or that the file names.
std::vector<std::uint32_t> camera_addresses(const Facts& facts) {
    std::vector<std::uint32_t> addresses;
    const auto add = [&](const std::string& text) {
        if (const auto address = parse_address(text)) addresses.push_back(*address);
    };
    for (const SiteCamera& camera : facts.wishes.cameras) add(camera.address);
    if (facts.cameras.found) {
        for (const FoundCamera& camera : *facts.cameras.found) add(camera.address);
    }
    return addresses;
}

std::string address_of_camera(const Facts& facts, const SiteCamera& camera) {
    if (!camera.address.empty() || !facts.cameras.found) return camera.address;
    for (const FoundCamera& found : *facts.cameras.found) {
        if (found.serial == camera.serial) return found.address;
    }
    return "";
}

// A host of a site on several hosts may have only one of the two.
std::string list_command(const Facts& facts) {
    const bool has_only_cameras = !is_there(facts, "site_node") && is_there(facts, "camera_node");
    return path_of(facts, has_only_cameras ? "camera_node" : "site_node") + " --list-cameras";
}

void check_presence(const Facts& facts, Findings& findings) {
    if (!facts.cameras.found) return;
    const std::string list = list_command(facts);
    if (facts.cameras.found->empty()) {
        const Card* card = likely_camera_card(facts);
        std::string cure;
        if (card != nullptr && !card->is_up)
            cure += fmt::format("sudo ip link set dev {} up && ", shell_word(card->name));
        if (card != nullptr && !has_link_local(*card))
            cure += fmt::format("sudo ip address add 169.254.0.1/16 dev {} && ",
                                shell_word(card->name));
        findings.push_back(make_finding(
            "no_camera",
            "No camera answers: check its power and cable; a GigE Vision camera without a fixed "
            "address is in the network 169.254.0.0/16.",
            cure + list));
        return;
    }
    for (const SiteCamera& wanted : facts.wishes.cameras) {
        if (wanted.serial.empty() && wanted.address.empty()) continue;
        const bool is_there = std::any_of(
            facts.cameras.found->begin(), facts.cameras.found->end(), [&](const FoundCamera& one) {
                return wanted.serial.empty() ? one.address == wanted.address
                                             : one.serial == wanted.serial;
            });
        if (is_there) continue;
        findings.push_back(make_finding(
            "camera_missing",
            fmt::format("Camera '{}' ({}) does not answer; {} others do.",
                        wanted.name,
                        wanted.serial.empty() ? wanted.address : "serial " + wanted.serial,
                        facts.cameras.found->size()),
            wanted.address.empty()
                ? list
                : fmt::format("ping -c 3 {}; {}", shell_word(wanted.address), list)));
    }
}

void check_mtu(const Facts& facts, Findings& findings) {
    const std::vector<const Card*> cards = camera_cards(facts);
    const auto raise = [](const Card& card) {
        return fmt::format("sudo ip link set dev {} mtu {}", shell_word(card.name), kWantedMtu);
    };
    const auto is_shared = [&](const Card& card) { return card.name == facts.network.card; };
    const auto warning = [&](const Card& card) {
        return is_shared(card) ? " All hosts and switches of its network need it, too." : "";
    };
    const auto keep = [&](const Card& card) {
        if (is_shared(card)) return std::string();
        return write_line(fmt::format("ACTION==\"add\", SUBSYSTEM==\"net\", {}, ATTR{{mtu}}=\"{}\"",
                                      card.mac.empty() ? "KERNEL==\"" + card.name + "\""
                                                       : "ATTR{address}==\"" + card.mac + "\"",
                                      kWantedMtu),
                          "/etc/udev/rules.d/91-atrium-mtu-" + card.name + ".rules");
    };
    const Card* smallest = nullptr;
    const Card* largest = nullptr;
    for (const Card* card : cards) {
        if (card->mtu == 0) continue;
        if (smallest == nullptr || card->mtu < smallest->mtu) smallest = card;
        if (largest == nullptr || card->mtu > largest->mtu) largest = card;
    }
    if (smallest == nullptr) return;
    if (largest->mtu >= kJumboMtu && smallest->mtu < kJumboMtu) {
        findings.push_back(make_finding(
            "mtu_mixed",
            fmt::format("The MTU of {} is {}, that of {} is {}: cameras at {} send many small "
                        "packets; all cards with cameras want {}.{}",
                        smallest->name,
                        smallest->mtu,
                        largest->name,
                        largest->mtu,
                        smallest->name,
                        kWantedMtu,
                        warning(*smallest)),
            raise(*smallest),
            keep(*smallest)));
        return;
    }
    for (const Card* card : cards) {
        if (card->mtu == 0 || card->mtu >= kJumboMtu) continue;
        findings.push_back(make_finding(
            "mtu_small",
            fmt::format(
                "The MTU of {}, which has cameras, is {}; they want {} (jumbo frames, also in "
                "the switch): small packets cost processor time and are lost sooner.{}",
                card->name,
                card->mtu,
                kWantedMtu,
                warning(*card)),
            raise(*card),
            keep(*card)));
    }
}

void check_bandwidth(const Facts& facts, Findings& findings) {
    for (const Card& card : facts.network.cards) {
        const double asked = camera_mbit_per_s(facts, card);
        const double has = kFilling * card.speed_mbit;
        if (asked <= 0.0 || has <= 0.0 || asked <= has) continue;
        const double rate = std::max(1.0, std::floor(facts.wishes.rate_hz * has / asked));
        findings.push_back(make_finding(
            "cameras_exceed_link",
            fmt::format("The cameras at {} send {:.0f} Mbit/s at {:g} Hz; its link of {} Mbit/s "
                        "carries {:.0f}{}.",
                        card.name,
                        asked,
                        facts.wishes.rate_hz,
                        card.speed_mbit,
                        has,
                        same_rate_on_all(facts.wishes)),
            capture_program(facts) + fmt::format(" --capture.rate_hz {:g}", rate)));
    }
}

void check_reverse_path(const Facts& facts, Findings& findings) {
    const std::vector<std::uint32_t> addresses = camera_addresses(facts);
    if (std::none_of(addresses.begin(), addresses.end(), is_link_local)) return;
    const bool is_routed =
        std::any_of(facts.network.cards.begin(), facts.network.cards.end(), has_link_local);
    if (is_routed) return;
    const Card* card = likely_camera_card(facts);
    if (card == nullptr || card->rp_filter != 1) return;
    const std::string name = fmt::format("net/ipv4/conf/{}/rp_filter", card->name);
    findings.push_back(make_finding(
        "reverse_path_strict",
        fmt::format("rp_filter of {} is 1 (strict) and the card has no address in 169.254.0.0/16, "
                    "where cameras are: the kernel drops their packets; 2 (loose) keeps them.",
                    card->name),
        set_sysctl(name, "2"),
        keep_sysctl(name, "2")));
}

// Which program takes the pictures, the file says. Without one, each may: one with the right is
// enough.
void check_packet_sockets(const Facts& facts, Findings& findings) {
    if (!has_gige(facts) || facts.user.has_net_raw || facts.packages.runs_file) return;
    const Wishes& wishes = facts.wishes;
    std::string names;
    std::string files;
    for (const Program& program : facts.programs) {
        const bool takes_pictures = program.name == "site_node" ? wishes.hosts.names.empty()
                                    : program.name == "camera_node"
                                        ? wishes.file.empty() || wishes.hosts.has_cameras
                                        : false;
        if (!takes_pictures || !program.has_net_raw) continue;
        if (*program.has_net_raw) return;
        names += (names.empty() ? "" : " and ") + program.name;
        files += " cap_net_raw+ep " + shell_word(program.path.string());
    }
    if (names.empty()) return;
    findings.push_back(make_finding(
        "no_packet_socket",
        fmt::format("{} may not open packet sockets (no cap_net_raw): the kernel's UDP loses more "
                    "packets of GigE Vision cameras.",
                    names),
        "sudo setcap" + files));
}

void check_rights(const Facts& facts, Findings& findings) {
    check_packet_sockets(facts, findings);
    if (!facts.realtime_limit || *facts.realtime_limit >= kRealtime || facts.user.has_sys_nice ||
        facts.packages.runs_file)
        return;
    findings.push_back(make_finding(
        "no_realtime",
        fmt::format("{} may use real-time priority {} at most; threads that receive pictures ask "
                    "for {}. Log in again afterwards.",
                    facts.user.name,
                    *facts.realtime_limit,
                    kRealtime),
        write_line(fmt::format("{} - rtprio {}", facts.user.name, 2 * kRealtime),
                   "/etc/security/limits.d/60-atrium.conf")));
}

}  // namespace

std::string capture_program(const Facts& facts) {
    const SiteHosts& hosts = facts.wishes.hosts;
    const std::string file = shell_word(facts.wishes.file.string());
    if (hosts.names.empty()) return path_of(facts, "site_node") + " --config " + file;
    return fmt::format(
        "{} --config {} --host {}", path_of(facts, "camera_node"), file, shell_word(hosts.own));
}

std::string same_rate_on_all(const Wishes& wishes) {
    return wishes.hosts.names.empty() ? "" : "; all hosts of the site need the same rate";
}

const Card* likely_camera_card(const Facts& facts) {
    const Card* likely = nullptr;
    for (const Card& card : facts.network.cards) {
        if (card.is_loopback || !card.is_wired) continue;
        if (likely == nullptr || likely->name == facts.network.card) likely = &card;
    }
    return likely;
}

std::vector<const Card*> camera_cards(const Facts& facts) {
    std::vector<const Card*> cards;
    if (!facts.cameras.found) return cards;
    for (const FoundCamera& camera : *facts.cameras.found) {
        const Card* card = camera.is_gige ? card_towards(facts.network, camera.address) : nullptr;
        if (card != nullptr && std::find(cards.begin(), cards.end(), card) == cards.end())
            cards.push_back(card);
    }
    return cards;
}

double camera_mbit_per_s(const Facts& facts, const Card& card) {
    double mbit = 0.0;
    if (facts.wishes.source != "cameras") return 0.0;
    for (const SiteCamera& camera : facts.wishes.cameras) {
        if (card_towards(facts.network, address_of_camera(facts, camera)) != &card) continue;
        mbit += 8.0 * camera.megapixels * camera.bytes_per_pixel * facts.wishes.rate_hz;
    }
    return mbit;
}

Findings check_cameras(const Facts& facts) {
    Findings findings;
    if (!facts.roles.camera) return findings;
    check_presence(facts, findings);
    check_mtu(facts, findings);
    check_bandwidth(facts, findings);
    check_reverse_path(facts, findings);
    check_rights(facts, findings);
    for (Finding& finding : check_usb_cameras(facts)) findings.push_back(std::move(finding));
    return findings;
}

}  // namespace atrium::doctor
