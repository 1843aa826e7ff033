#include "viewer/receive/world_membership.hpp"

#include "core/presence/join_world.hpp"

#include <utility>

namespace atrium::viewer {

Expected<void> WorldMembership::join(const bus::Participant& participant,
                                     const std::string& viewer,
                                     std::stop_token stop) {
    auto member = presence::join_world(
        participant,
        bus::ProgramKind::kViewer,
        viewer,
        [this](const Error& error) {
            const std::lock_guard lock(mutex_);
            name_ = tl::unexpected(error);
        },
        stop);
    if (!member) return tl::unexpected(member.error());
    membership_ = std::move(*member);
    return {};
}

Expected<void> WorldMembership::check_name() const {
    const std::lock_guard lock(mutex_);
    return name_;
}

std::vector<std::string> WorldMembership::sites_other_than(
    const std::set<std::string>& known) const {
    std::vector<std::string> sites;
    for (const bus::Presence& member : membership_->present()) {
        if (member.kind == bus::ProgramKind::kSiteNode && !known.contains(member.name))
            sites.push_back(member.name);
    }
    return sites;
}

}  // namespace atrium::viewer
