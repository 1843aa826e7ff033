#include "core/bus/peer_watch.hpp"

#include "core/bus/authentication.hpp"
#include "core/bus/builtin_topics.hpp"
#include "core/bus/names.hpp"
#include "core/bus/stranger_watch.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cstring>
#include <map>
#include <utility>

namespace atrium::bus {

namespace {

// Cyclone matches two endpoints shortly after it announces them.
constexpr std::chrono::seconds kMatchTimeout{2};
// Limits on data from untrusted senders.
constexpr std::size_t kMaxRemembered = 4096;
constexpr std::size_t kMaxLinesPerCall = 8;
constexpr std::size_t kMaxOtherWorlds = 8;

// As DDS matches partitions: one of two may be a pattern.
bool have_common(const std::vector<std::string>& theirs, const std::vector<std::string>& ours) {
    return std::ranges::any_of(theirs, [&ours](const std::string& their) {
        return std::ranges::any_of(ours, [&their](const std::string& our) {
            return ::fnmatch(their.c_str(), our.c_str(), 0) == 0 ||
                   ::fnmatch(our.c_str(), their.c_str(), 0) == 0;
        });
    });
}

std::chrono::nanoseconds from_dds(dds_duration_t duration) {
    return duration == DDS_INFINITY ? kForever : std::chrono::nanoseconds(duration);
}

EndpointQos get_qos(const dds_qos_t* qos) {
    EndpointQos out;
    dds_reliability_kind_t reliability{};
    dds_durability_kind_t durability{};
    dds_liveliness_kind_t liveliness{};
    dds_duration_t duration = 0;
    if (dds_qget_reliability(qos, &reliability, nullptr))
        out.reliable = reliability == DDS_RELIABILITY_RELIABLE;
    if (dds_qget_durability(qos, &durability))
        out.transient_local = durability >= DDS_DURABILITY_TRANSIENT_LOCAL;
    if (dds_qget_liveliness(qos, &liveliness, &duration)) out.lease = from_dds(duration);
    if (dds_qget_deadline(qos, &duration)) out.deadline = from_dds(duration);
    if (dds_qget_latency_budget(qos, &duration)) out.latency_budget = from_dds(duration);
    return out;
}

bool has_our_type_name(const dds_builtintopic_endpoint_t& theirs, dds_entity_t our_topic) {
    std::array<char, 256> our_name{};
    dds_get_type_name(our_topic, our_name.data(), our_name.size());
    return std::strcmp(theirs.type_name, our_name.data()) == 0;
}

bool is_matched(const WatchedEndpoint& ours, dds_instance_handle_t theirs) {
    std::vector<dds_instance_handle_t> matched(static_cast<std::size_t>(kMaxRead));
    const int num = ours.is_reader
                        ? dds_get_matched_publications(ours.entity, matched.data(), kMaxRead)
                        : dds_get_matched_subscriptions(ours.entity, matched.data(), kMaxRead);
    const auto end = matched.begin() + std::clamp<int>(num, 0, kMaxRead);
    return std::find(matched.begin(), end, theirs) != end;
}

/// Takes what is no longer there from a built-in topic's reader, which else keeps it for ever.
void forget_dead(dds_entity_t reader) {
    std::vector<void*> samples(static_cast<std::size_t>(kMaxRead), nullptr);
    std::vector<dds_sample_info_t> infos(static_cast<std::size_t>(kMaxRead));
    constexpr std::uint32_t kDead = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE |
                                    DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE |
                                    DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE;
    const int num = dds_take_mask(reader, samples.data(), infos.data(), kMaxRead, kMaxRead, kDead);
    if (num > 0) dds_return_loan(reader, samples.data(), num);
}

}  // namespace

std::vector<std::string> worlds_of(const dds_qos_t* qos) {
    std::uint32_t num = 0;
    char** names = nullptr;
    std::vector<std::string> worlds;
    if (!dds_qget_partition(qos, &num, &names)) return worlds;
    for (std::uint32_t i = 0; i < num; ++i) {
        worlds.emplace_back(names[i]);
        dds_free(names[i]);
    }
    dds_free(names);
    return worlds;
}

namespace {

// An endpoint by which a world is known.
struct Witness {
    dds_entity_t reader;  // of the built-in topic
    dds_instance_handle_t endpoint;
};

// Reads, does not take. Cyclone lends a reader's samples in one block and fills the whole buffer
// with it, however many are asked for: each read of a reader needs a buffer of the same size.
bool is_there(const Witness& witness) {
    std::vector<void*> samples(static_cast<std::size_t>(kMaxRead), nullptr);
    std::vector<dds_sample_info_t> infos(static_cast<std::size_t>(kMaxRead));
    constexpr std::uint32_t kAlive =
        DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;
    const int num = dds_read_instance_mask(
        witness.reader, samples.data(), infos.data(), kMaxRead, kMaxRead, witness.endpoint, kAlive);
    if (num > 0) dds_return_loan(witness.reader, samples.data(), num);
    return num > 0;
}

}  // namespace

struct PeerWatch::State {
    std::mutex mutex;
    std::string world;
    bool has_keys = false;
    Entity publications;   // reader of DCPSPublication: the writers in the domain
    Entity subscriptions;  // reader of DCPSSubscription: the readers in the domain
    Entity participants;   // reader of DCPSParticipant: their processes
    std::list<WatchedEndpoint> endpoints;
    bool endpoints_changed = false;
    std::set<std::string> reported;
    std::map<std::string, Witness> other_worlds;
    std::map<std::pair<dds_entity_t, dds_instance_handle_t>, std::chrono::steady_clock::time_point>
        waiting;              // compatible pairs that are not matched yet, and since when
    bool look_again = false;  // compare all endpoints again, because of `waiting`
    StrangerWatch strangers;

    void look(const Entity& builtin, bool theirs_write, std::vector<std::string>& lines);
    void compare(const dds_builtintopic_endpoint_t& theirs,
                 dds_instance_handle_t handle,
                 bool theirs_write,
                 std::vector<std::string>& lines);
    void remember_other_worlds(const std::vector<std::string>& worlds, const Witness& witness);
    void forget_gone_worlds();
    bool is_overdue(const WatchedEndpoint& ours, dds_instance_handle_t theirs);
    std::string name_of(const dds_guid_t& participant);
};

PeerWatch::Registration& PeerWatch::Registration::operator=(Registration&& other) noexcept {
    std::swap(state_, other.state_);
    std::swap(place_, other.place_);
    return *this;
}

PeerWatch::Registration::~Registration() {
    if (!state_) return;
    const std::lock_guard lock(state_->mutex);
    state_->endpoints.erase(place_);
}

Expected<PeerWatch> PeerWatch::create(dds_entity_t participant,
                                      const std::string& world,
                                      bool has_keys) {
    PeerWatch watch;
    watch.state_ = std::make_shared<State>();
    watch.state_->world = world;
    watch.state_->has_keys = has_keys;
    watch.state_->strangers = StrangerWatch(participant, has_keys);
    auto publications =
        own(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
            "a reader of DCPSPublication");
    if (!publications) return tl::unexpected(publications.error());
    auto subscriptions =
        own(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, nullptr, nullptr),
            "a reader of DCPSSubscription");
    if (!subscriptions) return tl::unexpected(subscriptions.error());
    auto participants =
        own(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
            "a reader of DCPSParticipant");
    if (!participants) return tl::unexpected(participants.error());
    watch.state_->participants = std::move(*participants);
    watch.state_->publications = std::move(*publications);
    watch.state_->subscriptions = std::move(*subscriptions);
    return watch;
}

PeerWatch::Registration PeerWatch::watch(WatchedEndpoint endpoint) {
    Registration registration;
    const std::lock_guard lock(state_->mutex);
    state_->endpoints.push_front(std::move(endpoint));
    state_->endpoints_changed = true;
    registration.place_ = state_->endpoints.begin();
    registration.state_ = state_;
    return registration;
}

std::vector<std::string> PeerWatch::take_mismatches() {
    std::vector<std::string> lines;
    const std::lock_guard lock(state_->mutex);
    state_->endpoints_changed |= std::exchange(state_->look_again, false);
    state_->forget_gone_worlds();
    state_->look(state_->publications, true, lines);
    state_->look(state_->subscriptions, false, lines);
    state_->endpoints_changed = false;
    state_->strangers.look(
        state_->participants.get(), state_->publications.get(), state_->subscriptions.get());
    for (const Entity* builtin :
         {&state_->publications, &state_->subscriptions, &state_->participants})
        forget_dead(builtin->get());
    return lines;
}

std::vector<std::string> PeerWatch::other_worlds() const {
    const std::lock_guard lock(state_->mutex);
    std::vector<std::string> names;
    for (const auto& [name, witness] : state_->other_worlds) names.push_back(name);
    return names;
}

// Reads only new samples, or all of them if an endpoint of this process was added or a pair is
// waiting.
void PeerWatch::State::look(const Entity& builtin,
                            bool theirs_write,
                            std::vector<std::string>& lines) {
    const std::uint32_t which =
        (endpoints_changed ? DDS_ANY_SAMPLE_STATE : DDS_NOT_READ_SAMPLE_STATE) |
        DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;
    read_each(builtin.get(), which, [&](const void* sample, dds_instance_handle_t handle) {
        compare(
            *static_cast<const dds_builtintopic_endpoint_t*>(sample), handle, theirs_write, lines);
    });
}

void PeerWatch::State::compare(const dds_builtintopic_endpoint_t& theirs,
                               dds_instance_handle_t handle,
                               bool theirs_write,
                               std::vector<std::string>& lines) {
    for (const WatchedEndpoint& ours : endpoints) {
        if (ours.is_reader != theirs_write || ours.topic_name != theirs.topic_name) continue;
        const std::vector<std::string> worlds = worlds_of(theirs.qos);
        if (!have_common(worlds, ours.partitions)) {
            const Entity& reader = theirs_write ? publications : subscriptions;
            remember_other_worlds(worlds, {reader.get(), handle});
            continue;
        }
        std::string why;
        const EndpointQos qos = get_qos(theirs.qos);
        const auto policy =
            theirs_write ? incompatible_policy(qos, ours.qos) : incompatible_policy(ours.qos, qos);
        if (!has_our_type_name(theirs, ours.topic)) {
            why = fmt::format("uses another type, {}; another version of Atrium, or not Atrium",
                              theirs.type_name);
        } else if (policy.empty()) {
            // whom the keys refuse is said elsewhere (stranger_watch.hpp)
            if (has_keys && proven_name(theirs.participant_key).empty()) continue;
            if (!is_overdue(ours, handle)) continue;
            why = has_keys
                      ? "its keys do not allow it this topic, or it is another version of Atrium"
                      : "uses a type of the same name with other members; another version of "
                        "Atrium";
        } else {
            why = fmt::format(
                "uses another {}: a reader asks for more than the writer offers; start both with "
                "the same bus.profiles_file",
                policy);
        }
        const std::string key = prefix_text(theirs.participant_key) + ours.topic_name + why;
        if (reported.size() >= kMaxRemembered || lines.size() >= kMaxLinesPerCall) return;
        if (!reported.insert(key).second) continue;
        lines.push_back(fmt::format("not_heard peer=\"{}\" topic={} reason=\"{}\"",
                                    name_of(theirs.participant_key),
                                    ours.topic_name,
                                    why));
    }
}

void PeerWatch::State::remember_other_worlds(const std::vector<std::string>& worlds,
                                             const Witness& witness) {
    for (const std::string& name : worlds) {
        // one with a slash is a part of a world
        if (other_worlds.size() < kMaxOtherWorlds && is_valid_name(name) && name != world)
            other_worlds.emplace(name, witness);
    }
}

// Others of a world may still be there: looking at all again finds them.
void PeerWatch::State::forget_gone_worlds() {
    const auto num_gone =
        std::erase_if(other_worlds, [](const auto& other) { return !is_there(other.second); });
    if (num_gone > 0) endpoints_changed = true;
}

// True if a compatible pair is not matched after kMatchTimeout. Its types then differ in their
// members, which only Cyclone compares.
bool PeerWatch::State::is_overdue(const WatchedEndpoint& ours, dds_instance_handle_t theirs) {
    const std::pair key{ours.entity, theirs};
    if (is_matched(ours, theirs)) return false;
    const auto now = std::chrono::steady_clock::now();
    if (waiting.size() >= kMaxRemembered) return false;
    const auto since = waiting.emplace(key, now).first->second;
    if (now - since < kMatchTimeout) {
        look_again = true;
        return false;
    }
    return true;
}

std::string PeerWatch::State::name_of(const dds_guid_t& participant) {
    std::string name = prefix_text(participant);
    read_each(participants.get(),
              DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ANY_INSTANCE_STATE,
              [&](const void* sample, dds_instance_handle_t /*handle*/) {
                  const auto& found = *static_cast<const dds_builtintopic_participant_t*>(sample);
                  if (std::memcmp(found.key.v, participant.v, sizeof participant.v) != 0) return;
                  if (std::string process = process_of(found); !process.empty())
                      name = std::move(process);
              });
    const std::string member = has_keys ? proven_name(participant) : std::string();
    if (!member.empty()) name = fmt::format("{} on {}", member, name);
    return name;
}

}  // namespace atrium::bus
