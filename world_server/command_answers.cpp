#include "world_server/command_answers.hpp"

#include "world_server/command_rights.hpp"
#include "world_server/edit_worker.hpp"

#include <fmt/format.h>

#include <string_view>

namespace atrium::world_server {
namespace {

constexpr std::chrono::milliseconds kAnswerPeriod{250};
constexpr std::size_t kMaxAnswered = 4096;  // senders can come and go with any name

// Empty: a command without answer.
std::string_view what_was_not(bus::CommandKind kind) {
    switch (kind) {
        case bus::CommandKind::kGrab:
            return "not pulled";
        case bus::CommandKind::kPush:
            return "not pushed";
        case bus::CommandKind::kReset:
            return "not reset";
        default:
            return {};
    }
}

bus::EditResult answer_to(const std::string& sender,
                          std::uint32_t object,
                          bool is_done,
                          const std::string& text) {
    bus::SceneEdit without_number;
    without_number.sender = sender;
    without_number.target = object;
    return result_of(without_number, is_done, text);
}

}  // namespace

bool CommandAnswers::is_due(const std::string& sender,
                            bus::CommandKind kind,
                            Clock::time_point now) {
    const std::lock_guard lock(mutex_);
    const auto found = answered_.find({sender, kind});
    if (found == answered_.end()) {
        if (answered_.size() >= kMaxAnswered) return false;
        answered_.emplace(std::pair(sender, kind), now);
        return true;
    }
    if (now - found->second < kAnswerPeriod) return false;
    found->second = now;
    return true;
}

std::optional<bus::EditResult> CommandAnswers::refused(const std::string& sender,
                                                       bus::CommandKind kind,
                                                       std::uint32_t target,
                                                       const std::string& why,
                                                       Clock::time_point now) {
    const std::string_view what = what_was_not(kind);
    if (what.empty() || !is_due(sender, kind, now)) return std::nullopt;
    const std::string name = fmt::format("{}: ", to_string(kind));
    const std::string reason = why.starts_with(name) ? why.substr(name.size()) : why;
    return answer_to(sender,
                     kind == bus::CommandKind::kReset ? 0 : target,
                     false,
                     fmt::format("{}: {}", what, reason));
}

std::optional<bus::EditResult> CommandAnswers::done(const std::string& sender,
                                                    bus::CommandKind kind,
                                                    Clock::time_point now) {
    if (kind != bus::CommandKind::kReset || !is_due(sender, kind, now)) return std::nullopt;
    return answer_to(sender, 0, true, "all objects were reset");
}

void CommandAnswers::forget(const std::string& sender) {
    const std::lock_guard lock(mutex_);
    std::erase_if(answered_, [&](const auto& entry) { return entry.first.first == sender; });
}

std::size_t CommandAnswers::num_remembered() const {
    const std::lock_guard lock(mutex_);
    return answered_.size();
}

}  // namespace atrium::world_server
