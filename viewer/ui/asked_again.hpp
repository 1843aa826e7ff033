#pragma once

#include "viewer/ui/keys.hpp"

#include <optional>
#include <utility>

namespace atrium::viewer {

/// The key that must be pressed again within three seconds, because what it does cannot be undone.
class AskedAgain {
public:
    static constexpr double kPatienceS = 3.0;

    /// The action that the viewer asks about, if any.
    std::optional<Action> action(double now_s) const {
        return now_s - at_s_ < kPatienceS ? action_ : std::nullopt;
    }
    /// True at the second press; the first one asks.
    bool is_confirmed(Action pressed, double now_s) {
        const bool is_second = action(now_s) == pressed;
        action_ = is_second ? std::nullopt : std::optional(pressed);
        at_s_ = now_s;
        return is_second;
    }
    /// Another key than the one that is asked about takes the question back.
    void pressed(Action other) {
        if (action_ != other) action_.reset();
    }

    void take_back() { action_.reset(); }

private:
    std::optional<Action> action_;
    double at_s_ = 0.0;
};

}  // namespace atrium::viewer
