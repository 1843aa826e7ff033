#include "core/bus/stranger_watch.hpp"

#include "core/bus/authentication.hpp"
#include "core/bus/builtin_topics.hpp"
#include "core/bus/dds_log.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

namespace atrium::bus {
namespace {

constexpr std::chrono::seconds kPatience{3};  // for a handshake, or endpoints
constexpr std::size_t kMaxStrangers = 4096;   // they are untrusted
constexpr std::uint32_t kAlive =
    DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_ALIVE_INSTANCE_STATE;

// The participants that tell this one of a reader or writer.
std::set<std::string> talkers(dds_entity_t publications, dds_entity_t subscriptions) {
    std::set<std::string> found;
    for (const dds_entity_t reader : {publications, subscriptions})
        read_each(reader, kAlive, [&](const void* sample, dds_instance_handle_t /*handle*/) {
            const auto& endpoint = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
            found.insert(prefix_text(endpoint.participant_key));
        });
    return found;
}

}  // namespace

StrangerWatch::StrangerWatch(dds_entity_t participant, bool has_keys) : has_keys_(has_keys) {
    dds_guid_t guid{};
    dds_get_guid(participant, &guid);
    own_ = prefix_text(guid);
}

std::string StrangerWatch::complaint_about(const dds_builtintopic_participant_t& stranger) const {
    const std::string who = process_of(stranger);
    if (!has_keys_)
        return fmt::format(
            "closed_world peer=\"{}\" reason=\"it tells nothing to programs without keys: if its "
            "world is closed, start this program with --security BUNDLE\"",
            who);
    const std::string known = refusal_of(stranger.key);
    if (!known.empty()) return fmt::format("refused peer=\"{}\" reason=\"{}\"", who, known);
    switch (standing_of(stranger.key)) {
        case Standing::kNoKeys:
            return fmt::format("refused peer=\"{}\" reason=\"it has no keys\"", who);
        case Standing::kWaits:
            return fmt::format(
                "refused peer=\"{}\" reason=\"no handshake comes about: it has keys of another "
                "world, or refuses this program's key, which may be revoked (its owner runs "
                "`atrium keys list`)\"",
                who);
        default:
            return {};  // proven, or refused by name already
    }
}

void StrangerWatch::look(dds_entity_t participants,
                         dds_entity_t publications,
                         dds_entity_t subscriptions) {
    const auto now = std::chrono::steady_clock::now();
    if (hears_others_) return;
    std::set<std::string> talking;
    if (!has_keys_) talking = talkers(publications, subscriptions);
    hears_others_ = talking.size() > talking.count(own_);
    std::map<std::string, Stranger> still_there;
    read_each(participants, kAlive, [&](const void* sample, dds_instance_handle_t /*handle*/) {
        const auto& found = *static_cast<const dds_builtintopic_participant_t*>(sample);
        const std::string guid = prefix_text(found.key);
        if (guid == own_ || talking.contains(guid) || still_there.size() >= kMaxStrangers) return;
        if (has_keys_ && standing_of(found.key) == Standing::kProven) return;
        const auto known = strangers_.find(guid);
        Stranger stranger = known == strangers_.end() ? Stranger{now} : known->second;
        if (!stranger.is_reported && now - stranger.since >= kPatience && !hears_others_) {
            stranger.is_reported = true;
            const std::string line = complaint_about(found);
            if (!line.empty()) DdsLog::of_process().add(line, line);
        }
        still_there.emplace(guid, stranger);
    });
    strangers_ = std::move(still_there);
}

}  // namespace atrium::bus
