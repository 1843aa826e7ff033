#include "core/bus/world_listener.hpp"

#include "core/bus/author_guard.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/names.hpp"
#include "core/bus/participant.hpp"
#include "core/bus/peer_watch.hpp"
#include "core/bus/topics.hpp"
#include "core/bus/wire.hpp"

#include <array>
#include <map>
#include <utility>

namespace atrium::bus {

namespace {

constexpr const char* kAllWorlds = "*";     // DDS matches partitions with wildcards
constexpr std::size_t kMaxPrograms = 4096;  // limit on data from untrusted senders
constexpr std::size_t kListenerBatch = 32;
constexpr std::size_t kMaxListenerBatches = 256;  // so a take ends while samples arrive

/// World of a writer: its only partition. Empty if it has none, several or an invalid one.
std::string world_of_writer(dds_entity_t reader, dds_instance_handle_t writer) {
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer);
    if (endpoint == nullptr) return {};
    const std::vector<std::string> worlds = worlds_of(endpoint->qos);
    dds_builtintopic_free_endpoint(endpoint);
    return worlds.size() == 1 && is_valid_name(worlds[0]) ? worlds[0] : std::string();
}

}  // namespace

struct WorldListener::Impl {
    // destroyed from the last to the first
    std::shared_ptr<Participant::Impl> participant;
    Entity subscriber;
    Entity topic;
    Entity reader;
    std::map<dds_instance_handle_t, HeardProgram> programs;

    Expected<void> open();
    void take(const void* sample, const dds_sample_info_t& info);
};

Expected<void> WorldListener::Impl::open() {
    const dds_entity_t of = participant->participant.get();
    const auto partitions = participant->keys
                                ? participant->partitions(Topic<Presence>::kName, "", true)
                                : Expected<std::vector<std::string>>({kAllWorlds});
    if (!partitions) return tl::unexpected(partitions.error());
    const QosPointer partition = partition_qos(*partitions);
    auto made_subscriber =
        own(dds_create_subscriber(of, partition.get(), nullptr), "a subscriber to all worlds");
    if (!made_subscriber) return tl::unexpected(made_subscriber.error());
    subscriber = std::move(*made_subscriber);
    auto made_topic =
        own(dds_create_topic(
                of, &Topic<Presence>::kDescriptor, Topic<Presence>::kName, nullptr, nullptr),
            "topic Presence");
    if (!made_topic) return tl::unexpected(made_topic.error());
    topic = std::move(*made_topic);
    const auto& profile = participant->profiles.find(Topic<Presence>::kProfile)->second;
    const QosPointer qos = make_reader_qos(profile.reader);
    auto made_reader =
        participant->keys
            ? create_guarded_reader(
                  subscriber.get(),
                  topic.get(),
                  qos.get(),
                  std::make_shared<Authors>(participant->world, Topic<Presence>::kName),
                  claim_of_key<Presence>,
                  sizeof(WireOf<Presence>))
            : own(dds_create_reader(subscriber.get(), topic.get(), qos.get(), nullptr),
                  "a reader of Presence in all worlds");
    if (!made_reader) return tl::unexpected(made_reader.error());
    reader = std::move(*made_reader);
    return {};
}

void WorldListener::Impl::take(const void* sample, const dds_sample_info_t& info) {
    if (info.instance_state != DDS_ALIVE_INSTANCE_STATE) {
        programs.erase(info.instance_handle);
        return;
    }
    if (!info.valid_data) return;
    auto presence = from_wire<Presence>(*static_cast<const WireOf<Presence>*>(sample));
    const std::string world = participant->keys
                                  ? participant->world
                                  : world_of_writer(reader.get(), info.publication_handle);
    if (!presence || world.empty()) return;
    if (programs.size() < kMaxPrograms || programs.contains(info.instance_handle))
        programs.insert_or_assign(info.instance_handle, HeardProgram{world, std::move(*presence)});
}

Expected<WorldListener> WorldListener::create(const BusOptions& options) {
    BusOptions any = options;
    any.world.clear();
    if (auto entered = enter_keys(any); !entered) return tl::unexpected(entered.error());
    // a participant needs a valid name; no endpoint of it is created
    if (!any.keys) any.world = "listener";
    auto participant = Participant::create(any);
    if (!participant) return tl::unexpected(participant.error());
    WorldListener listener;
    listener.impl_ = std::make_shared<Impl>();
    listener.impl_->participant = participant->impl();
    if (auto opened = listener.impl_->open(); !opened) return tl::unexpected(opened.error());
    return listener;
}

std::vector<HeardProgram> WorldListener::heard() {
    for (std::size_t batch = 0; batch < kMaxListenerBatches; ++batch) {
        std::array<void*, kListenerBatch> samples{};  // null at [0] asks for a loan
        std::array<dds_sample_info_t, kListenerBatch> infos{};
        const dds_entity_t reader = impl_->reader.get();
        const int num =
            dds_take(reader, samples.data(), infos.data(), kListenerBatch, kListenerBatch);
        for (int i = 0; i < num; ++i) {
            const auto at = static_cast<std::size_t>(i);
            impl_->take(samples[at], infos[at]);
        }
        if (num > 0) dds_return_loan(reader, samples.data(), num);
        if (num < static_cast<int>(kListenerBatch)) break;
    }
    std::vector<HeardProgram> all;
    for (const auto& [handle, program] : impl_->programs) all.push_back(program);
    return all;
}

}  // namespace atrium::bus
