#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// The rules for packets that come in, of nftables or iptables, as far as they decide about UDP.
namespace atrium::doctor {

/// One condition of a rule.
struct Condition {
    enum class On : std::uint8_t { kProtocol, kFrom, kTo, kCard, kState, kAddress, kOther };
    On on = On::kOther;
    bool is_negated = false;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;  // ports, addresses
    std::vector<std::string> words;                               // protocols, cards, states
};

struct Rule {
    enum class Verdict : std::uint8_t { kNone, kAccept, kDrop, kJump, kReturn };
    std::vector<Condition> conditions;
    Verdict verdict = Verdict::kNone;
    std::string target;  // chain of a jump
};

struct Chain {
    std::string family;  // "ip", "inet"; empty: iptables
    std::string table;
    std::string name;
    bool is_input = false;  // packets to this host start here
    bool drops_by_policy = false;
    std::vector<Rule> rules;
};

struct RuleSet {
    std::vector<Chain> chains;
    bool has_firewalld = false;
};

/// A datagram of a new connection.
struct Datagram {
    std::uint32_t to = 0;  // address
    std::uint32_t from_port = 0;
    std::uint32_t to_port = 0;
    std::string card;  // it comes in by; empty: any
};

/// The JSON of `nft -j list ruleset`. Anything else gives no chains.
RuleSet parse_nft(const std::string& json);
/// The text of `iptables-save`: the table filter.
RuleSet parse_iptables(const std::string& text);

/// The chain that certainly drops the datagram; nullptr if it may pass. Conditions that are not
/// understood may hold or not.
const Chain* dropped_by(const RuleSet& rules, const Datagram& datagram);

}  // namespace atrium::doctor
