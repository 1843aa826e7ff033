#include "world_server/command_rights.hpp"

#include <algorithm>
#include <array>

namespace atrium::world_server {
namespace {

// Bounds the memory: senders can come and go with any name.
constexpr std::size_t kMaxSenders = 1024;

}  // namespace

const Right& right_to(const Rights& rights, bus::CommandKind kind) {
    switch (kind) {
        case bus::CommandKind::kAdd:
            return rights.add;
        case bus::CommandKind::kRemove:
            return rights.remove;
        case bus::CommandKind::kReset:
            return rights.reset;
        case bus::CommandKind::kPush:
            return rights.push;
        case bus::CommandKind::kGrab:
        case bus::CommandKind::kMove:
        case bus::CommandKind::kRelease:
            return rights.grab;
        case bus::CommandKind::kSave:
        case bus::CommandKind::kRestore:
            break;
    }
    return rights.save;
}

const Right& right_to(const Rights& rights, bus::EditKind kind) {
    switch (kind) {
        case bus::EditKind::kAdd:
            return rights.add;
        case bus::EditKind::kRemove:
            return rights.remove;
        case bus::EditKind::kChange:
        case bus::EditKind::kPlace:
        case bus::EditKind::kHold:
        case bus::EditKind::kLetGo:
            return rights.edit;
        case bus::EditKind::kSaveWorld:
        case bus::EditKind::kLoadWorld:
            break;
    }
    return rights.save;
}

const char* right_name(bus::CommandKind kind) {
    switch (kind) {
        case bus::CommandKind::kAdd:
            return "add";
        case bus::CommandKind::kRemove:
            return "remove";
        case bus::CommandKind::kReset:
            return "reset";
        case bus::CommandKind::kPush:
            return "push";
        case bus::CommandKind::kGrab:
        case bus::CommandKind::kMove:
        case bus::CommandKind::kRelease:
            return "grab";
        case bus::CommandKind::kSave:
        case bus::CommandKind::kRestore:
            break;
    }
    return "save";
}

const char* right_name(bus::EditKind kind) {
    switch (kind) {
        case bus::EditKind::kAdd:
            return "add";
        case bus::EditKind::kRemove:
            return "remove";
        case bus::EditKind::kSaveWorld:
        case bus::EditKind::kLoadWorld:
            return "save";
        default:
            return "edit";
    }
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
