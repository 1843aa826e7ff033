#include "tools/doctor/checks/firewall_rules.hpp"

#include "tools/doctor/facts/collect.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace atrium::doctor {
namespace {

using nlohmann::json;
using On = Condition::On;
using Verdict = Rule::Verdict;

constexpr std::size_t kMaxRules = 20'000;
constexpr int kMaxDepth = 16;  // of jumps, as in the kernel
constexpr const char* kUdp = "udp";
constexpr std::uint32_t kUdpNumber = 17;
constexpr const char* kNew = "new";

using AddressRange = std::pair<std::uint32_t, std::uint32_t>;

AddressRange network_range(std::uint32_t address, unsigned prefix) {
    const std::uint32_t host =
        prefix == 0 ? std::numeric_limits<std::uint32_t>::max()
                    : (prefix >= 32 ? 0 : std::numeric_limits<std::uint32_t>::max() >> prefix);
    return {address & ~host, address | host};
}

std::string text_of(const json& object, const char* key) {
    const auto found = object.find(key);
    return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

std::optional<std::uint32_t> number_of(const json& value) {
    if (value.is_number_unsigned() && value.get<std::uint64_t>() <= 65535)
        return value.get<std::uint32_t>();
    return value.is_string() ? parse_address(value.get<std::string>()) : std::nullopt;
}

// A number, an address, {"range": [a, b]}, {"prefix": ...}, {"set": [...]} or words. False: other.
bool read_values(const json& value, Condition& condition) {
    if (value.is_array())
        return std::all_of(value.begin(), value.end(), [&](const json& one) {
            return read_values(one, condition);
        });
    if (const auto number = number_of(value)) {
        condition.ranges.emplace_back(*number, *number);
        return true;
    }
    if (value.is_string()) {
        condition.words.push_back(value.get<std::string>());
        return true;
    }
    if (!value.is_object() || value.empty()) return false;
    if (value.contains("set")) return read_values(value["set"], condition);
    if (value.contains("range") && value["range"].is_array() && value["range"].size() == 2) {
        const auto first = number_of(value["range"][0]);
        const auto last = number_of(value["range"][1]);
        if (!first || !last) return false;
        condition.ranges.emplace_back(*first, *last);
        return true;
    }
    if (value.contains("prefix") && value["prefix"].is_object()) {
        const auto address = parse_address(text_of(value["prefix"], "addr"));
        const json length = value["prefix"].value("len", json());
        if (!address || !length.is_number_unsigned() || length.get<std::uint64_t>() > 32)
            return false;
        condition.ranges.push_back(network_range(*address, length.get<unsigned>()));
        return true;
    }
    return false;
}

On subject_of(const json& left) {
    if (!left.is_object()) return On::kOther;
    if (left.contains("meta")) {
        const std::string key = left["meta"].is_object() ? text_of(left["meta"], "key") : "";
        if (key == "iif" || key == "iifname") return On::kCard;
        return key == "l4proto" ? On::kProtocol : On::kOther;
    }
    if (left.contains("ct"))
        return left["ct"].is_object() && text_of(left["ct"], "key") == "state" ? On::kState
                                                                               : On::kOther;
    if (!left.contains("payload") || !left["payload"].is_object()) return On::kOther;
    const std::string protocol = text_of(left["payload"], "protocol");
    const std::string field = text_of(left["payload"], "field");
    if (protocol == "ip" && field == "daddr") return On::kAddress;
    if (protocol == "ip" && field == "protocol") return On::kProtocol;
    if (field == "dport") return On::kTo;
    return field == "sport" ? On::kFrom : On::kOther;
}

void read_match(const json& match, Rule& rule) {
    Condition condition;
    if (match.is_object() && match.contains("left") && match.contains("right")) {
        condition.on = subject_of(match["left"]);
        const std::string op = text_of(match, "op");
        condition.is_negated = op == "!=";
        const bool is_known = op == "==" || op == "!=" || op == "in";
        if (!is_known || !read_values(match["right"], condition)) condition.on = On::kOther;
        // a port of one protocol implies this protocol
        const json& left = match["left"];
        if (left.is_object() && left.contains("payload") && left["payload"].is_object()) {
            const std::string protocol = text_of(left["payload"], "protocol");
            if (protocol != "ip" && protocol != "th")
                rule.conditions.push_back({On::kProtocol, false, {}, {protocol}});
        }
    }
    rule.conditions.push_back(std::move(condition));
}

// False for the usual map of connections that are established, related or invalid.
bool concerns_new(const json& map) {
    if (!map.is_object() || !map.contains("key") || subject_of(map["key"]) != On::kState)
        return true;
    return map.dump(-1, ' ', true, json::error_handler_t::replace).find("\"new\"") !=
           std::string::npos;
}

Rule read_nft_rule(const json& expressions) {
    Rule rule;
    if (!expressions.is_array()) return rule;
    for (const json& expression : expressions) {
        if (!expression.is_object() || expression.empty()) continue;
        const std::string kind = expression.begin().key();
        const json& content = expression.begin().value();
        if (kind == "match") {
            read_match(content, rule);
        } else if (kind == "accept") {
            rule.verdict = Verdict::kAccept;
        } else if (kind == "drop" || kind == "reject") {
            rule.verdict = Verdict::kDrop;
        } else if (kind == "return") {
            rule.verdict = Verdict::kReturn;
        } else if (kind == "jump" || kind == "goto") {
            rule.verdict = Verdict::kJump;
            rule.target = content.is_object() ? text_of(content, "target") : "";
        } else if (kind == "vmap") {
            if (concerns_new(content)) {
                rule.conditions.push_back({});
                rule.verdict = Verdict::kAccept;  // in doubt
            }
        } else if (kind != "counter" && kind != "log" && kind != "comment") {
            rule.conditions.push_back({});  // limit, xt and others: may hold or not
        }
    }
    return rule;
}

enum class Holds : std::uint8_t { kYes, kNo, kMaybe };

bool is_card(const std::string& pattern, const std::string& card) {
    if (!pattern.empty() && (pattern.back() == '*' || pattern.back() == '+'))
        return card.rfind(pattern.substr(0, pattern.size() - 1), 0) == 0;
    return pattern == card;
}

Holds holds(const Condition& condition, const Datagram& datagram) {
    const auto in_ranges = [&](std::uint32_t value) {
        return std::any_of(condition.ranges.begin(), condition.ranges.end(), [&](const auto& one) {
            return one.first <= value && value <= one.second;
        });
    };
    const auto has_word = [&](const std::string& word) {
        return std::find(condition.words.begin(), condition.words.end(), word) !=
               condition.words.end();
    };
    bool is_so = false;
    switch (condition.on) {
        case On::kProtocol:

            is_so = has_word(kUdp) || in_ranges(kUdpNumber);
            break;
        case On::kFrom:
            is_so = in_ranges(datagram.from_port);
            break;
        case On::kTo:
            is_so = in_ranges(datagram.to_port);
            break;
        case On::kAddress:
            if (datagram.to == 0) return Holds::kMaybe;
            is_so = in_ranges(datagram.to);
            break;
        case On::kState:
            is_so = has_word(kNew) || has_word("NEW");
            break;
        case On::kCard:
            if (datagram.card.empty() && !has_word("lo")) return Holds::kMaybe;
            is_so = std::any_of(
                condition.words.begin(), condition.words.end(), [&](const std::string& one) {
                    return is_card(one, datagram.card);
                });
            break;
        case On::kOther:
            return Holds::kMaybe;
    }
    return is_so != condition.is_negated ? Holds::kYes : Holds::kNo;
}

Holds holds(const Rule& rule, const Datagram& datagram) {
    Holds all = Holds::kYes;
    for (const Condition& condition : rule.conditions) {
        const Holds one = holds(condition, datagram);
        if (one == Holds::kNo) return Holds::kNo;
        if (one == Holds::kMaybe) all = Holds::kMaybe;
    }
    return all;
}

const Chain* find_chain(const RuleSet& rules, const Chain& from, const std::string& name) {
    for (const Chain& chain : rules.chains) {
        if (chain.name == name && chain.table == from.table && chain.family == from.family)
            return &chain;
    }
    return nullptr;
}

// kNone: no rule decided, or the chain may have returned before it dropped. In doubt it accepts.
Verdict walk(const RuleSet& rules,
             const Chain& chain,
             const Datagram& datagram,
             int depth,
             std::size_t& num_left) {
    bool may_have_returned = false;
    for (const Rule& rule : chain.rules) {
        if (num_left == 0) return Verdict::kAccept;
        --num_left;
        const Holds held = holds(rule, datagram);
        if (held == Holds::kNo || rule.verdict == Verdict::kNone) continue;
        Verdict verdict = rule.verdict;
        if (verdict == Verdict::kJump) {
            const Chain* next = find_chain(rules, chain, rule.target);
            if (next == nullptr || depth >= kMaxDepth) return Verdict::kAccept;
            verdict = walk(rules, *next, datagram, depth + 1, num_left);
            if (verdict == Verdict::kNone) continue;
        }
        if (verdict == Verdict::kAccept) return verdict;
        if (held == Holds::kMaybe) {
            may_have_returned |= verdict == Verdict::kReturn;
            continue;
        }
        return verdict == Verdict::kReturn || may_have_returned ? Verdict::kNone : verdict;
    }
    return Verdict::kNone;
}

Condition iptables_condition(On on, bool is_negated, const std::string& values) {
    Condition condition{on, is_negated, {}, {}};
    std::string rest = values;
    std::replace(rest.begin(), rest.end(), ',', ' ');
    for (const std::string& value : words_of(rest)) {
        const std::size_t colon = value.find(':');
        const auto first = parse_number(value.substr(0, colon));
        const auto last =
            colon == std::string::npos ? first : parse_number(value.substr(colon + 1));
        if (on == On::kAddress) {
            const std::size_t slash = value.find('/');
            const auto address = parse_address(value.substr(0, slash));
            const auto prefix =
                slash == std::string::npos ? 32 : parse_number(value.substr(slash + 1));
            if (!address || !prefix || *prefix > 32) return {};
            condition.ranges.push_back(network_range(*address, static_cast<unsigned>(*prefix)));
        } else if ((on == On::kFrom || on == On::kTo) && first && last && *last <= 65535) {
            condition.ranges.emplace_back(*first, *last);
        } else {
            condition.words.push_back(value);
        }
    }
    return condition;
}

// The words after "-A CHAIN".
Rule read_iptables_rule(const std::vector<std::string>& words) {
    static const std::map<std::string, On> kOptions{{"-p", On::kProtocol},
                                                    {"-i", On::kCard},
                                                    {"-d", On::kAddress},
                                                    {"--dport", On::kTo},
                                                    {"--dports", On::kTo},
                                                    {"--sport", On::kFrom},
                                                    {"--sports", On::kFrom},
                                                    {"--state", On::kState},
                                                    {"--ctstate", On::kState}};
    static const std::map<std::string, Verdict> kTargets{{"ACCEPT", Verdict::kAccept},
                                                         {"DROP", Verdict::kDrop},
                                                         {"REJECT", Verdict::kDrop},
                                                         {"RETURN", Verdict::kReturn},
                                                         {"LOG", Verdict::kNone}};
    Rule rule;
    bool is_negated = false;
    for (std::size_t i = 2; i < words.size(); ++i) {
        const std::string& option = words[i];
        const std::string value = i + 1 < words.size() ? words[i + 1] : "";
        if (option == "!") {
            is_negated = true;
            continue;
        }
        if (const auto known = kOptions.find(option); known != kOptions.end()) {
            rule.conditions.push_back(iptables_condition(known->second, is_negated, value));
            ++i;
        } else if (option == "-j" || option == "-g") {
            const auto target = kTargets.find(value);
            rule.verdict = target == kTargets.end() ? Verdict::kJump : target->second;
            rule.target = value;
            break;  // what follows are options of the target
        } else if (option == "-m") {
            ++i;  // the options of the match follow
        } else {
            rule.conditions.push_back({});
        }
        is_negated = false;
    }
    return rule;
}

}  // namespace

RuleSet parse_nft(const std::string& text) {
    RuleSet rules;
    const json document = json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!document.is_object() || !document.contains("nftables") ||
        !document["nftables"].is_array()) {
        return rules;
    }
    std::size_t num_rules = 0;
    for (const json& entry : document["nftables"]) {
        if (!entry.is_object() || entry.empty() || !entry.begin().value().is_object()) continue;
        const json& content = entry.begin().value();
        const std::string family = text_of(content, "family");
        if (family != "ip" && family != "inet") continue;  // others do not see IPv4
        rules.has_firewalld |= text_of(content, "table") == "firewalld";
        if (entry.contains("chain")) {
            rules.chains.push_back({family,
                                    text_of(content, "table"),
                                    text_of(content, "name"),
                                    text_of(content, "hook") == "input",
                                    text_of(content, "policy") == "drop",
                                    {}});
        } else if (entry.contains("rule") && ++num_rules <= kMaxRules) {
            for (Chain& chain : rules.chains) {
                if (chain.family == family && chain.table == text_of(content, "table") &&
                    chain.name == text_of(content, "chain"))
                    chain.rules.push_back(read_nft_rule(content.value("expr", json())));
            }
        }
    }
    return rules;
}

RuleSet parse_iptables(const std::string& text) {
    RuleSet rules;
    bool is_filter = false;
    std::size_t num_rules = 0;
    for (const std::string& line : lines_of(text)) {
        if (line.rfind('*', 0) == 0) is_filter = line == "*filter";
        const std::vector<std::string> words = words_of(line);
        if (!is_filter || words.size() < 2) continue;
        if (line[0] == ':') {
            const std::string name = words[0].substr(1);
            rules.chains.push_back({"", "filter", name, name == "INPUT", words[1] == "DROP", {}});
        } else if (words[0] == "-A" && ++num_rules <= kMaxRules) {
            for (Chain& chain : rules.chains) {
                if (chain.name == words[1]) chain.rules.push_back(read_iptables_rule(words));
            }
        }
    }
    return rules;
}

const Chain* dropped_by(const RuleSet& rules, const Datagram& datagram) {
    for (const Chain& chain : rules.chains) {
        if (!chain.is_input) continue;
        std::size_t num_left = 1'000'000;  // chains may jump in circles
        const Verdict verdict = walk(rules, chain, datagram, 0, num_left);
        if (verdict == Verdict::kDrop || (verdict == Verdict::kNone && chain.drops_by_policy))
            return &chain;
    }
    return nullptr;
}

}  // namespace atrium::doctor
