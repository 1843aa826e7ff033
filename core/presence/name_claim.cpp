#include "core/presence/name_claim.hpp"

#include "core/bus/names.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <tuple>

namespace atrium::presence {

namespace {

using bus::Presence;

// Limit on data from untrusted senders: rivals for one name. More are ignored.
constexpr std::size_t kMaxOthers = 64;

bool is_older(const Presence& a, const Presence& b) {
    return std::tie(a.start_time.ns, a.instance) < std::tie(b.start_time.ns, b.instance);
}

}  // namespace

bool NameClaim::is_rival(const Presence& other) const {
    return other.kind == own_.kind && other.name == own_.name && other.instance != own_.instance;
}

void NameClaim::see(const Presence& other, Clock::time_point now) {
    if (!is_rival(other)) return;
    const auto found = others_.find(other.instance);
    if (found == others_.end()) {
        if (others_.size() >= kMaxOthers) return;
        others_.emplace(other.instance, Other{other, now});
        was_asked_ |= is_holder_ && !other.is_holder;
        return;
    }
    Other& known = found->second;
    if (other.is_holder && !known.presence.is_holder) known.seen_at = now;
    if (!other.is_holder && now - known.seen_at >= kAskAgain / 2) {
        known.seen_at = now;
        was_asked_ |= is_holder_;
    }
    known.is_alive = true;
    known.presence = other;
}

void NameClaim::gone(const Presence& other) { others_.erase(other.instance); }

NameClaim::Verdict NameClaim::decide(Clock::time_point now) {
    rival_.reset();
    bool waits = now - begin_ < kListen;
    for (const auto& [instance, other] : others_) {
        const Presence& presence = other.presence;
        const bool has_precedence = presence.is_holder ? !is_holder_ || is_older(presence, own_)
                                                       : !is_holder_ && is_older(presence, own_);
        if (!has_precedence) continue;
        rival_ = presence;
        if (presence.is_holder && (is_holder_ || other.is_alive || now - other.seen_at >= kLease))
            return Verdict::kRefused;
        waits = true;
    }
    if (is_holder_) return Verdict::kHold;
    if (waits) return Verdict::kWait;
    is_holder_ = true;
    // answer the processes that claimed the name before this one held it
    was_asked_ = !others_.empty();
    return Verdict::kHold;
}

bool NameClaim::should_ask(Clock::time_point now) {
    if (!rival_ || !rival_->is_holder || is_holder_ || now - asked_at_ < kAskAgain) return false;
    asked_at_ = now;
    return true;
}

bool NameClaim::take_question() { return std::exchange(was_asked_, false); }

std::string describe(const Presence& presence) {
    const std::time_t start = presence.start_time.ns / 1'000'000'000;
    return fmt::format("{} '{}' on host {}, pid {}, since {:%Y-%m-%dT%H:%M:%S}Z",
                       bus::kind_name(presence.kind),
                       presence.name,
                       presence.host,
                       presence.pid,
                       fmt::gmtime(start));
}

}  // namespace atrium::presence
