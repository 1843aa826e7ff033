#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <chrono>
#include <map>
#include <optional>
#include <string>

namespace atrium::bus {

/// Who may have a name, decided from what is known of the others that want it. No network and no
/// clock of its own; not thread-safe.
///
/// A process first asks for its name, while it listens to who else is there, and then holds it.
/// Who asks is refused by one that holds the name and shows that it is alive, by writing its
/// Presence again when it hears of the one who asks. What a holder wrote before the two found each
/// other shows nothing, and its answer may be among that: who hears of a holder only once asks
/// again. One that holds it and stays silent was killed, or is cut off: it is waited for until DDS
/// has lost it. Of two who ask at once the older goes
/// first; of two who hold it, for each started while the network between them was cut, the older
/// stays. Older is who has the earlier start time or, where they are the same, the lower instance:
/// both see it alike.
class NameClaim {
public:
    using Clock = std::chrono::steady_clock;

    /// For others to be found, and to be heard from.
    static constexpr std::chrono::milliseconds kListen{600};
    /// In which DDS loses one that was killed.
    static constexpr std::chrono::milliseconds kLease{2000};
    /// Between two questions to a holder that is silent.
    static constexpr std::chrono::milliseconds kAskAgain{200};

    NameClaim(const Presence& own, Clock::time_point now)
        : own_(own), begin_(now), asked_at_(now) {}

    void see(const Presence& other, Clock::time_point now);
    void gone(const Presence& other);

    enum class Verdict { kWait, kHold, kRefused };
    /// Once kHold was returned, only kHold and kRefused are; the latter then means that the name is
    /// lost.
    Verdict decide(Clock::time_point now);

    /// Whom the last verdict was about; none: nobody.
    const Presence* rival() const { return rival_ ? &*rival_ : nullptr; }
    /// True where the last verdict was to wait for a silent holder, every kAskAgain: write the
    /// Presence again.
    bool should_ask(Clock::time_point now);
    /// True once after each question for a name that is held: write the Presence again. Of one that
    /// asks more often than every half kAskAgain only some count.
    bool take_question();

private:
    struct Other {
        Presence presence;
        Clock::time_point seen_at;  // first as it holds the name, or as it last asked
        bool is_alive = false;      // wrote while we listened
    };
    bool is_rival(const Presence& other) const;

    Presence own_;
    Clock::time_point begin_;
    Clock::time_point asked_at_;
    bool is_holder_ = false;
    bool was_asked_ = false;
    std::map<std::uint64_t, Other> others_;
    std::optional<Presence> rival_;
};

/// "site_node 'lab' on host alpha, pid 17, since 2026-05-04T10:00:00Z".
std::string describe(const Presence& presence);

}  // namespace atrium::bus
