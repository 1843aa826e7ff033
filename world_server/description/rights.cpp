#include "world_server/description/rights.hpp"

#include "core/bus/names.hpp"

#include <algorithm>

namespace atrium::world_server {
namespace {

constexpr const char* kAllowed =
    "must be \"everyone\", \"nobody\" or a list of viewers' names, [\"host\"]";

void read_right(config::TableReader& reader, const std::string& key, Right& right) {
    if (!reader.has(key)) return;
    if (!reader.has_array(key)) {
        std::string who;
        reader.read(key, who);
        if (who != "everyone" && who != "nobody") reader.reject(key, kAllowed);
        right = {who == "everyone", {}};
        return;
    }
    reader.read(key, right.names);
    right.everyone = std::ranges::find(right.names, "everyone") != right.names.end();
    for (const std::string& name : right.names) {
        if (!bus::is_valid_name(name)) {
            reader.reject(key, kAllowed);
        }
    }
}

}  // namespace

bool Right::allows(const std::string& sender) const {
    return everyone || std::find(names.begin(), names.end(), sender) != names.end();
}

void read_rights(config::TableReader& reader, Rights& rights) {
    config::TableReader table = reader.table("rights");
    for (const auto& [key, right] : kRights) read_right(table, key, rights.*right);
    table.read("max_per_s", rights.max_per_s, {1.0, 10'000.0});
}

}  // namespace atrium::world_server
