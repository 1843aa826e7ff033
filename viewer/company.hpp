#pragma once

#include "core/app/log.hpp"
#include "core/bus/messages.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Warns once where neither a world server nor a site has been in the world: its name may be
/// misspelt, and the picture would only show an empty floor.
class Company {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds kPatience{3};

    explicit Company(std::string world) : world_(std::move(world)) {}

    /// `present` are those who are there at `now`; `is_over`: there is no more time to come.
    /// Returns whether it warned.
    bool look(const std::vector<bus::Presence>& present, Clock::time_point now, bool is_over) {
        begin_ = std::min(begin_, now);
        is_known_ = is_known_ || std::ranges::any_of(present, [](const bus::Presence& member) {
                        return member.kind == bus::ProgramKind::kWorldServer ||
                               member.kind == bus::ProgramKind::kSiteNode;
                    });
        if (is_known_ || (!is_over && now - begin_ < kPatience)) return false;
        is_known_ = true;
        app::log::warn("nobody_there world={} no world server and no site yet; is that its name?",
                       world_);
        return true;
    }

private:
    std::string world_;
    Clock::time_point begin_ = Clock::time_point::max();
    bool is_known_ = false;  // that somebody is there, or that nobody is
};

}  // namespace atrium::viewer
