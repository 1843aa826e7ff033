#include "viewer/receive/edit_link.hpp"

#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::size_t kMaxResults = 256;  // waiting for the drawing thread

}  // namespace

EditLink::EditLink(bus::Writer<bus::SceneEdit> edits,
                   bus::Reader<bus::EditResult> results,
                   bus::Reader<bus::SavedWorlds> saved_worlds,
                   std::string viewer)
    : edits_(std::move(edits)),
      results_(std::move(results)),
      saved_worlds_(std::move(saved_worlds)),
      viewer_(std::move(viewer)) {}

Expected<EditLink> EditLink::create(const bus::Participant& participant,
                                    bus::Waiter& waiter,
                                    std::string viewer) {
    auto edits = bus::Writer<bus::SceneEdit>::create(participant);
    if (!edits) return tl::unexpected(edits.error());
    auto results = bus::Reader<bus::EditResult>::create(participant);
    if (!results) return tl::unexpected(results.error());
    auto saved_worlds = bus::Reader<bus::SavedWorlds>::create(participant);
    if (!saved_worlds) return tl::unexpected(saved_worlds.error());
    waiter.add(*results);
    waiter.add(*saved_worlds);
    return EditLink(
        std::move(*edits), std::move(*results), std::move(*saved_worlds), std::move(viewer));
}

bus::TakeReport EditLink::receive() {
    bus::TakeReport report = results_.take([this](bus::EditResult&& result) {
        const std::lock_guard lock(*mutex_);
        if (result.sender == viewer_ && news_.results.size() < kMaxResults)
            news_.results.push_back(std::move(result));
        else if (result.sender != viewer_ && result.is_done && result.object != 0 &&
                 news_.of_others.size() < kMaxResults)
            news_.of_others.push_back(std::move(result));
    });
    const bus::TakeReport of_lists = saved_worlds_.take(
        [this](bus::SavedWorlds&& saved) {
            const std::lock_guard lock(*mutex_);
            news_.saved_worlds = std::move(saved);
            news_.is_server_gone = false;
        },
        [this](const bus::SavedWorlds&) {
            const std::lock_guard lock(*mutex_);
            news_.saved_worlds.reset();
            news_.is_server_gone = true;
        });
    if (report.num_rejected == 0) report.first_rejection = of_lists.first_rejection;
    report.num_rejected += of_lists.num_rejected;
    return report;
}

EditNews EditLink::take() {
    const std::lock_guard lock(*mutex_);
    return std::exchange(news_, {});
}

}  // namespace atrium::viewer
