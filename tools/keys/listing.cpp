#include "tools/keys/listing.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace atrium::keys_tool {
namespace {

using keys::Entry;
using keys::Kind;

bool has_rights(const keys::Member& member) {
    return member.kind == Kind::kViewer || member.kind == Kind::kMonitor;
}

std::string shown_state(const Entry& entry) {
    std::string text(keys::state_text(entry.state));
    if (entry.revocation)
        text += fmt::format(" ({}, {})",
                            keys::reason_text(entry.revocation->reason),
                            keys::day_text(entry.revocation->at));
    return text;
}

}  // namespace

std::string shown_rights(const keys::Member& member) {
    return has_rights(member) ? keys::rights_text(member.rights) : "-";
}

std::string list_text(const std::string& world, std::span<const Entry> entries) {
    if (entries.empty())
        return fmt::format("world {} has no members; `atrium keys add` adds one\n", world);
    using Row = std::array<std::string, 5>;
    std::vector<Row> rows{{"NAME", "KIND", "RIGHTS", "VALID UNTIL", "STATE"}};
    for (const Entry& entry : entries)
        rows.push_back({entry.member.name,
                        std::string(keys::kind_text(entry.member.kind)),
                        shown_rights(entry.member),
                        keys::day_text(entry.validity.end),
                        shown_state(entry)});
    std::array<std::size_t, 4> widths{};
    for (const Row& row : rows)
        for (std::size_t i = 0; i < widths.size(); ++i)
            widths[i] = std::max(widths[i], row[i].size());
    std::string text = fmt::format("World {}\n", world);
    for (const Row& row : rows) {
        for (std::size_t i = 0; i < widths.size(); ++i)
            text += fmt::format("{:<{}}  ", row[i], widths[i]);
        text += row.back() + "\n";
    }
    return text;
}

std::string list_json(const std::string& world, std::span<const Entry> entries) {
    nlohmann::ordered_json members = nlohmann::ordered_json::array();
    for (const Entry& entry : entries) {
        nlohmann::ordered_json member;
        member["name"] = entry.member.name;
        member["kind"] = keys::kind_text(entry.member.kind);
        if (has_rights(entry.member)) member["rights"] = keys::rights_text(entry.member.rights);
        member["valid_from"] = keys::time_text(entry.validity.begin);
        member["valid_until"] = keys::time_text(entry.validity.end);
        member["state"] = keys::state_text(entry.state);
        if (entry.revocation) {
            member["revoked_at"] = keys::time_text(entry.revocation->at);
            member["reason"] = keys::reason_text(entry.revocation->reason);
        }
        members.push_back(std::move(member));
    }
    nlohmann::ordered_json all;
    all["world"] = world;
    all["members"] = std::move(members);
    return all.dump(2) + "\n";
}

}  // namespace atrium::keys_tool
