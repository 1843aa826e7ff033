#include "world_server/command_inbox.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMaxCommands = 256;  // queued for the next tick
constexpr std::size_t kMaxLeft = 1024;     // equals the number of senders with a budget

std::string not_allowed(const std::string& sender, const char* right) {
    return fmt::format("not allowed to {} by [rights] {} of the world file", sender, right);
}

}  // namespace

std::optional<std::string> CommandInbox::put(bus::SceneCommand&& command,
                                             CommandRates::Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    // count first: a command that is not allowed costs its sender as much
    if (!rates_.admit(command.sender, now)) {
        return fmt::format("more than {:g} commands a second", rights_.max_per_s);
    }
    if (!right_to(rights_, command.kind).allows(command.sender)) {
        return fmt::format("{}: {}",
                           to_string(command.kind),
                           not_allowed(command.sender, right_name(command.kind)));
    }
    if (content_.commands.size() >= kMaxCommands) return "too many commands at once";
    content_.commands.push_back(std::move(command));
    return std::nullopt;
}

std::optional<std::string> CommandInbox::admit(const bus::SceneEdit& edit,
                                               CommandRates::Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    if (!rates_.admit(edit.sender, now))
        return fmt::format("more than {:g} commands a second", rights_.max_per_s);
    if (right_to(rights_, edit.kind).allows(edit.sender)) return std::nullopt;
    return not_allowed(edit.sender, right_name(edit.kind));
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
