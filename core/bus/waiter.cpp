#include "core/bus/endpoints.hpp"

#include <vector>

namespace atrium::bus {

struct Waiter::Impl {
    std::shared_ptr<Participant::Impl> participant;
    std::vector<std::shared_ptr<void>> readers;  // their conditions must outlive the wait set
    Entity woken;                                // guard condition of `wake`
    Entity wait_set;                             // destroyed first
};

Expected<Waiter> Waiter::create(const Participant& participant) {
    auto impl = std::make_shared<Impl>();
    impl->participant = participant.impl();
    const dds_entity_t parent = impl->participant->participant.get();
    auto woken = own(dds_create_guardcondition(parent), "a guard condition");
    if (!woken) return tl::unexpected(woken.error());
    impl->woken = std::move(*woken);
    auto wait_set = own(dds_create_waitset(parent), "a wait set");
    if (!wait_set) return tl::unexpected(wait_set.error());
    impl->wait_set = std::move(*wait_set);
    if (const auto result = dds_waitset_attach(impl->wait_set.get(), impl->woken.get(), 0);
        result < 0)
        return make_error(ErrorKind::kInternal,
                          fmt::format("wait set: {}", dds_strretcode(result)));
    Waiter waiter;
    waiter.impl_ = std::move(impl);
    return waiter;
}

template <typename Message>
void Waiter::add(const Reader<Message>& reader) {
    impl_->readers.push_back(reader.impl_);
    dds_waitset_attach(impl_->wait_set.get(), reader.impl_->anything.get(), 0);
}

bool Waiter::wait(std::chrono::milliseconds timeout) {
    const dds_return_t num_triggered = dds_waitset_wait(
        impl_->wait_set.get(), nullptr, 0, std::chrono::nanoseconds(timeout).count());
    bool was_woken = false;
    dds_take_guardcondition(impl_->woken.get(), &was_woken);
    return num_triggered > 0 && !was_woken;
}

void Waiter::wake() { dds_set_guardcondition(impl_->woken.get(), true); }

template void Waiter::add(const Reader<SiteDescription>&);
template void Waiter::add(const Reader<SiteMesh>&);
template void Waiter::add(const Reader<CameraTexture>&);
template void Waiter::add(const Reader<CameraSilhouette>&);
template void Waiter::add(const Reader<SiteOrders>&);
template void Waiter::add(const Reader<ClockAnswer>&);
template void Waiter::add(const Reader<CameraNodeStatus>&);
template void Waiter::add(const Reader<RegionOrder>&);
template void Waiter::add(const Reader<RegionMeshes>&);
template void Waiter::add(const Reader<RegionNodeStatus>&);
template void Waiter::add(const Reader<SitePlacement>&);
template void Waiter::add(const Reader<SceneObject>&);
template void Waiter::add(const Reader<SoftBody>&);
template void Waiter::add(const Reader<SoftBodyState>&);
template void Waiter::add(const Reader<Scenery>&);
template void Waiter::add(const Reader<SceneState>&);
template void Waiter::add(const Reader<PersonProxy>&);
template void Waiter::add(const Reader<ObjectProxy>&);
template void Waiter::add(const Reader<SceneCommand>&);
template void Waiter::add(const Reader<SceneEdit>&);
template void Waiter::add(const Reader<EditResult>&);
template void Waiter::add(const Reader<SavedWorlds>&);
template void Waiter::add(const Reader<RoomRecordOrder>&);
template void Waiter::add(const Reader<RoomRecording>&);
template void Waiter::add(const Reader<SiteStatus>&);
template void Waiter::add(const Reader<WorldStatus>&);
template void Waiter::add(const Reader<ViewerStatus>&);
template void Waiter::add(const Reader<StreamFeedback>&);
template void Waiter::add(const Reader<Presence>&);
template void Waiter::add(const Reader<RevokedKeys>&);

}  // namespace atrium::bus
