#include "tools/doctor/facts/collect.hpp"
#include "tools/doctor/report/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace atrium::doctor {
namespace {

constexpr const char* kUnknown = "unknown";

std::string size_or_unknown(const std::optional<std::uint64_t>& bytes) {
    return bytes ? size_text(*bytes) : kUnknown;
}

std::string describe_host(const SiteHosts& hosts) {
    if (hosts.names.empty()) return "not in a site on several hosts";
    const std::string name = hosts.own.empty() ? kUnknown : hosts.own;
    if (!hosts.is_listed) return name + ", not in the file";
    std::vector<std::string> does;
    if (hosts.has_cameras) does.emplace_back("cameras");
    if (hosts.is_model) does.emplace_back("hull");
    if (hosts.has_regions) does.emplace_back("regions");
    return fmt::format("{}: {}", name, fmt::join(does, ", "));
}

std::string describe_programs(const Facts& facts) {
    std::set<std::string> versions;
    std::size_t count = 0;
    for (const Program& program : facts.programs) {
        if (!program.version.empty()) versions.insert(program.version);
        count += program.is_there ? 1 : 0;
    }
    if (facts.programs.empty()) return "not examined";
    return fmt::format("{} in {}, version {}",
                       count,
                       facts.programs.front().path.parent_path().string(),
                       versions.empty() ? kUnknown : fmt::format("{}", fmt::join(versions, ", ")));
}

std::string describe_card(const NetworkFacts& network) {
    for (const Card& card : network.cards) {
        if (card.name != network.card) continue;
        std::string text = card.name;
        if (!card.addresses.empty())
            text += fmt::format(" ({})", address_text(card.addresses.front().address));
        if (card.mtu > 0) text += fmt::format(", MTU {}", card.mtu);
        if (card.speed_mbit > 0) text += fmt::format(", {} Mbit/s", card.speed_mbit);
        return text;
    }
    return "none";
}

std::string describe_firewall(const NetworkFacts& network) {
    std::string text;
    if (!network.nft_rules.empty()) text = "nftables";
    if (!network.iptables_rules.empty()) text += text.empty() ? "iptables" : ", iptables";
    return text.empty() ? "not readable: needs root and nft or iptables-save" : text;
}

std::string describe_cameras(const Facts& facts) {
    if (!facts.cameras.found) return "not looked for";
    std::string text = fmt::format("{} answer", facts.cameras.found->size());
    for (const FoundCamera& camera : *facts.cameras.found)
        text += fmt::format("; {} {} at {}", camera.name, camera.serial, camera.address);
    return text;
}

std::string describe_clock(const ClockFacts& clock) {
    const std::string daemons = clock.daemons.empty()
                                    ? "no time daemon"
                                    : fmt::format("{}", fmt::join(clock.daemons, ", "));
    if (!clock.is_synchronised) return "unknown, " + daemons;
    return fmt::format("{}, error at most {:.3g} ms, {}",
                       *clock.is_synchronised ? "synchronised" : "not synchronised",
                       clock.chrony ? clock.chrony->bound_ms : clock.max_error_ms,
                       daemons);
}

std::string describe_graphics(const Facts& facts) {
    if (!facts.roles.viewer) return "not examined (--for viewer)";
    const GraphicsFacts& graphics = facts.graphics;
    const std::string nodes =
        graphics.nodes.empty() ? "no GPU" : fmt::format("{}", fmt::join(graphics.nodes, ", "));
    if (!graphics.is_hardware) return nodes;
    return nodes + (*graphics.is_hardware ? ", draws in hardware" : ", draws in software");
}

std::string describe_load(const LoadFacts& load) {
    std::string text = fmt::format("{} cores", load.cores);
    if (load.busy_cores) text += fmt::format(", others use {:.1f}", *load.busy_cores);
    if (!load.governor.empty()) text += ", governor " + load.governor;
    return text;
}

std::string describe_folder(const std::optional<FolderFacts>& folder) {
    if (!folder) return "not examined (--recordings FOLDER)";
    return fmt::format("{}, {} free, writes {:.0f} MB/s",
                       folder->folder.string(),
                       size_text(folder->free_bytes),
                       folder->write_mb_per_s);
}

std::string describe_keys(const std::optional<KeyFacts>& keys) {
    if (!keys) return "not examined (--keys FOLDER)";
    if (!keys->is_readable) return fmt::format("unknown: {} needs root", keys->folder.string());
    constexpr std::size_t kMaxMembers = 8;
    std::vector<std::string> members;
    for (const Certificate& certificate : keys->certificates)
        if (!certificate.member.empty()) members.push_back(certificate.member);
    const std::size_t more = members.size() - std::min(members.size(), kMaxMembers);
    members.resize(members.size() - more);
    if (more > 0) members.push_back(fmt::format("{} more", more));
    return fmt::format("{} certificate{} in {}{}{}",
                       keys->certificates.size(),
                       keys->certificates.size() == 1 ? "" : "s",
                       keys->folder.string(),
                       members.empty() ? "" : ": ",
                       fmt::join(members, ", "));
}

}  // namespace

std::vector<Checked> describe(const Facts& facts) {
    const NetworkFacts& network = facts.network;
    const auto& hears = network.hears_multicast;
    return {
        {"checked for", fmt::format("{}", fmt::join(names_of(facts.roles), ", "))},
        {"file", facts.wishes.file.empty() ? "none" : facts.wishes.file.string()},
        {"host", describe_host(facts.wishes.hosts)},
        {"programs", describe_programs(facts)},
        {"network", facts.wishes.network},
        {"network card", describe_card(network)},
        {"multicast",
         !hears   ? "not tested"
         : *hears ? "heard"
                  : "not heard"},
        {"net.core.rmem_max", size_or_unknown(network.rmem_max)},
        {"net.core.wmem_max", size_or_unknown(network.wmem_max)},
        {"net.ipv4.ipfrag_time",
         network.ipfrag_time_s ? fmt::format("{} s", *network.ipfrag_time_s) : kUnknown},
        {"net.ipv4.ipfrag_high_thresh", size_or_unknown(network.ipfrag_memory)},
        {"firewall", describe_firewall(network)},
        {"cameras", describe_cameras(facts)},
        {"USB cameras", fmt::format("{}", facts.cameras.usb.size())},
        {"rights",
         facts.packages.runs_file ? "those of the service that runs the file, not of this user"
                                  : "those of this user"},
        {"real-time priority",
         facts.realtime_limit ? fmt::format("up to {}", *facts.realtime_limit) : kUnknown},
        {"clock", describe_clock(facts.clock)},
        {"graphics", describe_graphics(facts)},
        {"processor", describe_load(facts.load)},
        {"free memory", size_or_unknown(facts.load.memory_available)},
        {"recordings", describe_folder(facts.recordings)},
        {"keys", describe_keys(facts.keys)},
    };
}

}  // namespace atrium::doctor
