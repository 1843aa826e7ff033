#pragma once

#include "core/app/log.hpp"
#include "core/bus/messages.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Warns once if neither a world server nor a site has joined the world. The world's name may be
/// misspelt; the picture would show an empty floor without a reason.
class EmptyWorldWarning {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kPatience{3};

    /// Checks the programs `present` at `now`. `is_over`: the run ends, so nobody else can come.
    /// `place` says where this viewer is (bus::Participant::place). Returns whether it warned.
    bool update(const std::vector<bus::Presence>& present,
                const std::string& place,
                Clock::time_point now,
                bool is_over) {
        begin_ = std::min(begin_, now);
        has_met_others_ =
            has_met_others_ || std::ranges::any_of(present, [](const bus::Presence& member) {
                return member.kind == bus::ProgramKind::kWorldServer ||
                       member.kind == bus::ProgramKind::kSiteNode;
            });
        is_known_ = is_known_ || has_met_others_;
        if (is_known_ || (!is_over && now - begin_ < kPatience)) return false;
        is_known_ = true;
        app::log::warn(
            "nobody_there {} no world server and no site yet; world, domain and network must be "
            "the same in all programs, and all need keys of this world, or none; `viewer` without "
            "a world lists those that it hears",
            place);
        return true;
    }

    /// Whether a world server or a site was ever present.
    bool has_met_others() const { return has_met_others_; }

private:
    bool has_met_others_ = false;
    Clock::time_point begin_ = Clock::time_point::max();
    bool is_known_ = false;  // somebody is there, or the warning was given
};

}  // namespace atrium::viewer
