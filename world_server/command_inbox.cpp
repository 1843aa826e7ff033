#include "world_server/command_inbox.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMaxCommands = 256;  // queued for the next tick
constexpr std::size_t kMaxLeft = 1024;     // equals the number of senders with a budget

}  // namespace

std::optional<std::string> CommandInbox::put(bus::SceneCommand&& command,
                                             CommandRates::Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    // count first: a command that is not allowed costs its sender as much
    if (!rates_.admit(command.sender, now)) {
        return fmt::format("more than {:g} commands a second", rights_.max_per_s);
    }
    if (const auto why =
            refusal(rights_, right_for(command.kind), command.sender, command.proven_rights))
        return fmt::format("{}: {}", to_string(command.kind), *why);
    if (content_.commands.size() >= kMaxCommands) return "too many commands at once";
    content_.commands.push_back(std::move(command));
    return std::nullopt;
}

std::optional<std::string> CommandInbox::admit(const bus::SceneEdit& edit,
                                               CommandRates::Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    if (!rates_.admit(edit.sender, now))
        return fmt::format("more than {:g} commands a second", rights_.max_per_s);
    return refusal(rights_, right_for(edit.kind), edit.sender, edit.proven_rights);
}

bool CommandInbox::put_prepared(PreparedEdit edit) {
    const std::lock_guard lock(mutex_);
    if (content_.edits.size() >= kMaxCommands) return false;
    content_.edits.push_back(std::move(edit));
    return true;
}

void CommandInbox::leave(const std::string& sender) {
    const std::lock_guard lock(mutex_);
    rates_.forget(sender);
    if (content_.left.size() < kMaxLeft) content_.left.insert(sender);
}

CommandInbox::Content CommandInbox::take_all() {
    const std::lock_guard lock(mutex_);
    return std::exchange(content_, {});
}

}  // namespace atrium::world_server
