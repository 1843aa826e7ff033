#include "world_server/command_rights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace atrium::world_server {
namespace {

// Bounds the memory: senders can come and go with any name.
constexpr std::size_t kMaxSenders = 1024;

}  // namespace

keys::Right right_for(bus::CommandKind kind) {
    switch (kind) {
        case bus::CommandKind::kAdd:
            return keys::Right::kAdd;
        case bus::CommandKind::kRemove:
            return keys::Right::kRemove;
        case bus::CommandKind::kReset:
            return keys::Right::kReset;
        case bus::CommandKind::kPush:
            return keys::Right::kPush;
        case bus::CommandKind::kGrab:
        case bus::CommandKind::kMove:
        case bus::CommandKind::kRelease:
            return keys::Right::kGrab;
        case bus::CommandKind::kSave:
        case bus::CommandKind::kRestore:
            break;
    }
    return keys::Right::kSave;
}

keys::Right right_for(bus::EditKind kind) {
    switch (kind) {
        case bus::EditKind::kAdd:
            return keys::Right::kAdd;
        case bus::EditKind::kRemove:
            return keys::Right::kRemove;
        case bus::EditKind::kChange:
        case bus::EditKind::kPlace:
        case bus::EditKind::kHold:
        case bus::EditKind::kLetGo:
            return keys::Right::kEdit;
        case bus::EditKind::kSaveWorld:
        case bus::EditKind::kLoadWorld:
            break;
    }
    return keys::Right::kSave;
}

std::optional<std::string> refusal(const Rights& rights,
                                   keys::Right right,
                                   const std::string& sender,
                                   const std::optional<keys::Rights>& proven) {
    // in the order of keys::Right
    const auto& [key, member] = kRights[static_cast<std::size_t>(right)];
    if (proven && !proven->has(right))
        return fmt::format("not allowed: the key of {} does not have the right {}", sender, key);
    if ((rights.*member).allows(sender)) return std::nullopt;
    return fmt::format("not allowed to {} by [rights] {} of the world file", sender, key);
}

const char* to_string(bus::EditKind kind) {
    constexpr std::array kNames{
        "add", "change", "place", "remove", "hold", "let go", "save world", "load world"};
    return kNames[static_cast<std::size_t>(kind)];
}

const char* to_string(bus::CommandKind kind) {
    constexpr std::array kNames{
        "add", "remove", "reset", "push", "grab", "move", "release", "save", "restore"};
    return kNames[static_cast<std::size_t>(kind)];
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
