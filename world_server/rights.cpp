#include "world_server/rights.hpp"

#include "core/bus/checks.hpp"

#include <algorithm>
#include <utility>

namespace atrium::world_server {
namespace {

// Bounds the memory: senders can come and go with any name.
constexpr std::size_t kMaxSenders = 1024;

void read_right(config::TableReader& reader, const std::string& key, Right& right) {
    if (!reader.has(key)) return;
    if (!reader.has_array(key)) {
        std::string who;
        reader.read(key, who, {"everyone", "nobody"});
        right = {who == "everyone", {}};
        return;
    }
    right.everyone = false;
    reader.read(key, right.names);
    for (const std::string& name : right.names) {
        if (!bus::is_valid_name(name)) {
            reader.reject(key, "must be \"everyone\", \"nobody\" or a list of senders' names");
        }
    }
}

}  // namespace

bool Right::allows(const std::string& sender) const {
    return everyone || std::find(names.begin(), names.end(), sender) != names.end();
}

const Right& Rights::of(bus::CommandKind kind) const {
    switch (kind) {
        case bus::CommandKind::kAdd:
            return add;
        case bus::CommandKind::kRemove:
            return remove;
        case bus::CommandKind::kReset:
            return reset;
        case bus::CommandKind::kPush:
            return push;
        case bus::CommandKind::kGrab:
        case bus::CommandKind::kMove:
        case bus::CommandKind::kRelease:
            return grab;
        case bus::CommandKind::kSave:
        case bus::CommandKind::kRestore:
            break;
    }
    return save;
}

const char* to_string(bus::CommandKind kind) {
    constexpr std::array kNames{
        "add", "remove", "reset", "push", "grab", "move", "release", "save", "restore"};
    return kNames[static_cast<std::size_t>(kind)];
}

void read_rights(config::TableReader& reader, Rights& rights) {
    config::TableReader table = reader.table("rights");
    for (const auto& [key, right] : {std::pair<const char*, Right*>{"add", &rights.add},
                                     {"remove", &rights.remove},
                                     {"reset", &rights.reset},
                                     {"push", &rights.push},
                                     {"grab", &rights.grab},
                                     {"save", &rights.save}}) {
        read_right(table, key, *right);
    }
    table.read("max_per_s", rights.max_per_s, {1.0, 10'000.0});
}

bool CommandRates::admit(const std::string& sender, Clock::time_point now) {
    const double burst = std::max(1.0, 0.5 * max_per_s_);
    auto found = budgets_.find(sender);
    if (found == budgets_.end()) {
        if (budgets_.size() >= kMaxSenders) return false;
        found = budgets_.emplace(sender, Budget{burst, now}).first;
    }
    Budget& budget = found->second;
    const double seconds = std::chrono::duration<double>(now - budget.counted).count();
    budget.commands = std::min(burst, budget.commands + max_per_s_ * std::max(0.0, seconds));
    budget.counted = now;
    if (budget.commands < 1.0) return false;
    budget.commands -= 1.0;
    return true;
}

}  // namespace atrium::world_server
