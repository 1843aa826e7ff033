#include "core/bus/endpoints.hpp"

#include "core/bus/checks.hpp"

namespace atrium::bus {

namespace {

template <typename Message>
Expected<Entity> create_topic(const Participant::Impl& participant) {
    return own(dds_create_topic(participant.participant.get(),
                                &Topic<Message>::kDescriptor,
                                Topic<Message>::kName,
                                nullptr,
                                nullptr),
               fmt::format("topic {}", Topic<Message>::kName));
}

// In a world with keys, all topics but those of the world server: only it can write in its
// partition.
template <typename Message>
bool is_guarded(const Participant::Impl& participant) {
    return participant.keys != nullptr &&
           keys::author_of(Topic<Message>::kName) != keys::Author::kWorld;
}

// Enters what the author's key allows, where a message has room for it.
template <typename Message>
void enter_rights(Message& message, const Authors* authors, const dds_sample_info_t& info) {
    if constexpr (requires { message.proven_rights; }) {
        if (authors == nullptr) return;
        const auto author = authors->find(info.publication_handle);
        message.proven_rights = author ? author->rights : keys::Rights();
    }
}

void reject(TakeReport& report, const Error& why) {
    if (report.num_rejected++ == 0) report.first_rejection = why.message;
}

}  // namespace

template <typename Message>
Expected<Writer<Message>> Writer<Message>::create(const Participant& participant,
                                                  const std::string& part) {
    auto impl = std::make_shared<Impl>();
    impl->participant = participant.impl();
    auto topic = create_topic<Message>(*impl->participant);
    if (!topic) return tl::unexpected(topic.error());
    impl->topic = std::move(*topic);
    const auto& profile = impl->participant->profiles.find(Topic<Message>::kProfile)->second;
    const auto partitions = impl->participant->partitions(Topic<Message>::kName, part, false);
    if (!partitions) return tl::unexpected(partitions.error());
    dds_entity_t publisher = impl->participant->publisher.get();
    if (*partitions != std::vector{impl->participant->world}) {
        auto own_publisher = own(
            dds_create_publisher(
                impl->participant->participant.get(), partition_qos(*partitions).get(), nullptr),
            "a publisher");
        if (!own_publisher) return tl::unexpected(own_publisher.error());
        impl->publisher = std::move(*own_publisher);
        publisher = impl->publisher.get();
    }
    auto writer =
        own(dds_create_writer(
                publisher, impl->topic.get(), make_writer_qos(profile.writer).get(), nullptr),
            fmt::format("a writer of {}", Topic<Message>::kName));
    if (!writer) return tl::unexpected(writer.error());
    impl->writer = std::move(*writer);
    impl->watched = impl->participant->peers.watch({Topic<Message>::kName,
                                                    impl->topic.get(),
                                                    impl->writer.get(),
                                                    *partitions,
                                                    profile.writer,
                                                    /*is_reader=*/false});
    Writer result;
    result.impl_ = std::move(impl);
    return result;
}

template <typename Message>
Expected<std::size_t> Writer<Message>::write(const Message& message) {
    if (auto result = check(message); !result) return tl::unexpected(std::move(result.error()));
    const std::lock_guard lock(impl_->mutex);
    to_wire(message, impl_->scratch, impl_->wire);
    const dds_return_t result = dds_write(impl_->writer.get(), &impl_->wire);
    if (result == DDS_RETCODE_TIMEOUT) {
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("{}: a reader does not keep up", Topic<Message>::kName));
    }
    if (result == DDS_RETCODE_OUT_OF_RESOURCES) {
        return make_error(
            ErrorKind::kUnavailable,
            fmt::format("{}: more instances than the QoS profile '{}' allows; dispose some",
                        Topic<Message>::kName,
                        Topic<Message>::kProfile));
    }
    if (result < 0) {
        return make_error(
            ErrorKind::kInternal,
            fmt::format("{}: write: {}", Topic<Message>::kName, dds_strretcode(result)));
    }
    return payload_bytes(message);
}

template <typename Message>
Expected<void> Writer<Message>::dispose(const Message& key_holder) {
    const std::lock_guard lock(impl_->mutex);
    typename Topic<Message>::Wire key{};
    key_to_wire(key_holder, key);
    if (const auto valid = key_from_wire<Message>(key); !valid)
        return tl::unexpected(valid.error());
    // Dispose tells the readers; unregister frees the instance in the writer.
    dds_return_t result = dds_dispose(impl_->writer.get(), &key);
    if (result >= 0) result = dds_unregister_instance(impl_->writer.get(), &key);
    if (result < 0) {
        return make_error(
            ErrorKind::kInternal,
            fmt::format("{}: dispose: {}", Topic<Message>::kName, dds_strretcode(result)));
    }
    return {};
}

template <typename Message>
int Writer<Message>::num_readers() const {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(impl_->writer.get(), &status);
    return static_cast<int>(status.current_count);
}

template <typename Message>
Expected<Reader<Message>> Reader<Message>::create(const Participant& participant,
                                                  const std::string& part) {
    auto impl = std::make_shared<Impl>();
    impl->participant = participant.impl();
    auto topic = create_topic<Message>(*impl->participant);
    if (!topic) return tl::unexpected(topic.error());
    impl->topic = std::move(*topic);
    const auto& profile = impl->participant->profiles.find(Topic<Message>::kProfile)->second;
    const auto partitions = impl->participant->partitions(Topic<Message>::kName, part, true);
    if (!partitions) return tl::unexpected(partitions.error());
    dds_entity_t subscriber = impl->participant->subscriber.get();
    if (*partitions != std::vector{impl->participant->world}) {
        auto own_subscriber = own(
            dds_create_subscriber(
                impl->participant->participant.get(), partition_qos(*partitions).get(), nullptr),
            "a subscriber");
        if (!own_subscriber) return tl::unexpected(own_subscriber.error());
        impl->subscriber = std::move(*own_subscriber);
        subscriber = impl->subscriber.get();
    }
    const QosPointer qos = make_reader_qos(profile.reader);
    if (is_guarded<Message>(*impl->participant))
        impl->authors = std::make_shared<Authors>(impl->participant->world, Topic<Message>::kName);
    auto reader = impl->authors
                      ? create_guarded_reader(subscriber,
                                              impl->topic.get(),
                                              qos.get(),
                                              impl->authors,
                                              claim_of_key<Message>,
                                              sizeof(typename Topic<Message>::Wire))
                      : own(dds_create_reader(subscriber, impl->topic.get(), qos.get(), nullptr),
                            fmt::format("a reader of {}", Topic<Message>::kName));
    if (!reader) return tl::unexpected(reader.error());
    impl->reader = std::move(*reader);
    impl->deadlines = std::make_unique<DeadlineCount>(profile.reader.deadline);
    EndpointQos announced = profile.reader;
    announced.deadline = kForever;  // see make_reader_qos
    impl->watched = impl->participant->peers.watch({Topic<Message>::kName,
                                                    impl->topic.get(),
                                                    impl->reader.get(),
                                                    *partitions,
                                                    announced,
                                                    /*is_reader=*/true});
    auto condition =
        own(dds_create_readcondition(impl->reader.get(), DDS_ANY_STATE), "a read condition");
    if (!condition) return tl::unexpected(condition.error());
    impl->anything = std::move(*condition);
    Reader result;
    result.impl_ = std::move(impl);
    return result;
}

template <typename Message>
TakeReport Reader<Message>::take(const std::function<void(Message&&)>& on_sample,
                                 const std::function<void(const Message&)>& on_gone) {
    return take(on_sample, [&on_gone](const Message& key, Ending /*how*/) {
        if (on_gone) on_gone(key);
    });
}

template <typename Message>
TakeReport Reader<Message>::take(const std::function<void(Message&&)>& on_sample,
                                 const std::function<void(const Message&, Ending)>& on_gone) {
    return take_written(
        [&on_sample](Message&& message, Timestamp /*written*/) {
            if (on_sample) on_sample(std::move(message));
        },
        on_gone);
}

template <typename Message>
TakeReport Reader<Message>::take_written(
    const std::function<void(Message&&, Timestamp)>& on_sample,
    const std::function<void(const Message&, Ending)>& on_gone) {
    TakeReport report;
    const auto now = DeadlineCount::Clock::now();
    for (std::size_t batch = 0; batch < kMaxBatchesPerTake; ++batch) {
        const Loan loan(impl_->reader.get());
        for (int i = 0; i < loan.size(); ++i) {
            const auto& wire = *static_cast<const typename Topic<Message>::Wire*>(loan.sample(i));
            const dds_sample_info_t& info = loan.info(i);
            // Without valid data the sample has only the key and reports a change of state.
            if (info.valid_data) {
                if (const auto ended = impl_->lives.ended_before(info); ended && on_gone) {
                    if (const auto key = key_from_wire<Message>(wire)) on_gone(*key, *ended);
                }
                impl_->deadlines->heard(info.instance_handle, now);
                if (auto message = from_wire<Message>(wire)) {
                    ++report.num_taken;
                    enter_rights(*message, impl_->authors.get(), info);
                    if (on_sample) on_sample(std::move(*message), when_written(info));
                } else {
                    reject(report, message.error());
                }
            }
            if (!is_end_of_instance(info)) continue;
            impl_->deadlines->gone(info.instance_handle);
            impl_->lives.gone(info);
            if (const auto key = key_from_wire<Message>(wire)) {
                const bool is_disposed =
                    info.instance_state == DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE;
                if (on_gone) on_gone(*key, is_disposed ? Ending::kDisposed : Ending::kLost);
            } else if (!info.valid_data) {
                reject(report, key.error());
            }
        }
        if (loan.size() < static_cast<int>(kTakeBatch)) break;
    }
    return report;
}

template <typename Message>
int Reader<Message>::num_writers() const {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(impl_->reader.get(), &status);
    return static_cast<int>(status.current_count);
}

template <typename Message>
std::uint64_t Reader<Message>::num_deadlines_missed() const {
    return impl_->deadlines->num_missed();
}

template class Writer<SiteDescription>;
template class Writer<SiteMesh>;
template class Writer<CameraTexture>;
template class Writer<CameraSilhouette>;
template class Writer<SiteOrders>;
template class Writer<ClockAnswer>;
template class Writer<CameraNodeStatus>;
template class Writer<RegionOrder>;
template class Writer<RegionMeshes>;
template class Writer<RegionNodeStatus>;
template class Writer<SitePlacement>;
template class Writer<SceneObject>;
template class Writer<SoftBody>;
template class Writer<SoftBodyState>;
template class Writer<Scenery>;
template class Writer<SceneState>;
template class Writer<PersonProxy>;
template class Writer<ObjectProxy>;
template class Writer<SceneCommand>;
template class Writer<SceneEdit>;
template class Writer<EditResult>;
template class Writer<SavedWorlds>;
template class Writer<RoomRecordOrder>;
template class Writer<RoomRecording>;
template class Writer<SiteStatus>;
template class Writer<WorldStatus>;
template class Writer<ViewerStatus>;
template class Writer<StreamFeedback>;
template class Writer<Presence>;
template class Writer<RevokedKeys>;

template class Reader<SiteDescription>;
template class Reader<SiteMesh>;
template class Reader<CameraTexture>;
template class Reader<CameraSilhouette>;
template class Reader<SiteOrders>;
template class Reader<ClockAnswer>;
template class Reader<CameraNodeStatus>;
template class Reader<RegionOrder>;
template class Reader<RegionMeshes>;
template class Reader<RegionNodeStatus>;
template class Reader<SitePlacement>;
template class Reader<SceneObject>;
template class Reader<SoftBody>;
template class Reader<SoftBodyState>;
template class Reader<Scenery>;
template class Reader<SceneState>;
template class Reader<PersonProxy>;
template class Reader<ObjectProxy>;
template class Reader<SceneCommand>;
template class Reader<SceneEdit>;
template class Reader<EditResult>;
template class Reader<SavedWorlds>;
template class Reader<RoomRecordOrder>;
template class Reader<RoomRecording>;
template class Reader<SiteStatus>;
template class Reader<WorldStatus>;
template class Reader<ViewerStatus>;
template class Reader<StreamFeedback>;
template class Reader<Presence>;
template class Reader<RevokedKeys>;

}  // namespace atrium::bus
