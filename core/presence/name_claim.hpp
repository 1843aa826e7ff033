#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace atrium::presence {

/// Decides whether this process may hold a name, from the Presence samples of the other processes.
/// Uses neither network nor clock; not thread-safe.
///
/// A process first claims its name while it listens for others, then holds it. A holder that is
/// alive makes the claim fail: it writes its Presence again when it receives the claim. A sample
/// that it wrote before the two processes discovered each other does not prove that it is alive.
/// Its reply can be lost in the same way, so a claimant that received only one sample asks again.
/// A silent holder was killed or is cut off: the claimant waits until DDS has lost it. If DDS still
/// has it after kLease, the claim fails.
///
/// Of two claimants the older goes first. Of two holders, which started while the network between
/// them was cut, the older stays. Older means the earlier start time or, at a tie, the lower
/// instance: both processes come to the same result.
class NameClaim {
public:
    using Clock = std::chrono::steady_clock;

    /// Time to discover other processes and to receive their samples.
    static constexpr std::chrono::milliseconds kListen{600};
    /// Time in which DDS loses a killed process.
    static constexpr std::chrono::milliseconds kLease{2000};
    /// Period in which a claimant asks a silent holder again.
    static constexpr std::chrono::milliseconds kAskAgain{200};

    NameClaim(const bus::Presence& own, Clock::time_point now)
        : own_(own), begin_(now), asked_at_(now) {}

    /// Call it with each sample received from another process.
    void see(const bus::Presence& other, Clock::time_point now);
    /// Call it when the instance of another process has ended.
    void gone(const bus::Presence& other);

    enum class Verdict { kWait, kHold, kRefused };
    /// After the first kHold it returns only kHold or kRefused; kRefused then means that the name
    /// is lost.
    Verdict decide(Clock::time_point now);

    /// The process that the last verdict was about; null if there was none.
    const bus::Presence* rival() const { return rival_ ? &*rival_ : nullptr; }
    /// True every kAskAgain while the last verdict is to wait for a silent holder. The caller then
    /// writes its Presence again.
    bool should_ask(Clock::time_point now);
    /// True once after a claim to the name that this process holds. The caller then writes its
    /// Presence again. Repeated claims of one process count at most once per half kAskAgain.
    bool take_question();

private:
    struct Other {
        bus::Presence presence;
        Clock::time_point seen_at;  // first sample as a holder, or last claim
        bool is_alive = false;      // wrote again after its first sample
    };
    bool is_rival(const bus::Presence& other) const;

    bus::Presence own_;
    Clock::time_point begin_;
    Clock::time_point asked_at_;
    bool is_holder_ = false;
    bool was_asked_ = false;
    std::map<std::uint64_t, Other> others_;
    std::optional<bus::Presence> rival_;
};

/// Describes a program: "site 'lab' on host alpha, pid 17, since 2026-05-04T10:00:00Z".
std::string describe(const bus::Presence& presence);

}  // namespace atrium::presence
