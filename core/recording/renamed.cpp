#include "core/recording/renamed.hpp"

#include "core/bus/messages.hpp"
#include "core/recording/topic_roles.hpp"

#include <algorithm>

namespace atrium::recording {
namespace {

void rename(std::string& name, const Names& names) {
    if (const auto found = names.find(name); found != names.end()) name = found->second;
}

// The name of its site in a message.
template <typename Message>
std::string& site_in(Message& message) {
    if constexpr (std::is_same_v<Message, bus::Presence>)
        return message.name;
    else
        return message.site;
}

template <typename Message>
Expected<std::vector<std::byte>> rename_in(const bus::RawSample& sample,
                                           const Names& names,
                                           const Places& places) {
    auto message = bus::from_raw<Message>(sample);
    if (!message) return tl::unexpected(message.error());
    rename(site_in(*message), names);
    if constexpr (std::is_same_v<Message, bus::SitePlacement>) {
        if (const auto place = places.find(message->site); place != places.end())
            message->world_from_site = place->second;
    }
    return bus::to_cdr(*message);
}

template <typename... Messages>
Expected<std::vector<std::byte>> rename_in_one_of(const bus::RawTopic& topic,
                                                  const bus::RawSample& sample,
                                                  const Names& names,
                                                  const Places& places) {
    Expected<std::vector<std::byte>> out =
        std::vector<std::byte>(sample.cdr.begin(), sample.cdr.end());
    static_cast<void>(((topic.name() == bus::topic_name<Messages>() &&
                        (out = rename_in<Messages>(sample, names, places), true)) ||
                       ...));
    return out;
}

}  // namespace

Expected<std::vector<std::byte>> renamed(const bus::RawTopic& topic,
                                         const bus::RawSample& sample,
                                         const Names& names,
                                         const Places& places) {
    return rename_in_one_of<bus::SiteDescription,
                            bus::SiteMesh,
                            bus::CameraTexture,
                            bus::SitePlacement,
                            bus::PersonProxy,
                            bus::SiteStatus,
                            bus::CameraNodeStatus,
                            bus::RegionNodeStatus,
                            bus::RoomRecording,
                            bus::StreamFeedback,
                            bus::Presence>(topic, sample, names, places);
}

std::string renamed_key(const bus::RawTopic& topic, const std::string& key, const Names& names) {
    const auto site = site_of(topic, key);
    if (!site || !names.contains(*site)) return key;
    // The name stands between slashes: at the start, or behind the viewer or kind.
    const std::size_t at = key.starts_with(*site + "/") || key == *site ? 0 : key.find('/') + 1;
    std::string out = key;
    return out.replace(at, site->size(), names.at(*site));
}

}  // namespace atrium::recording
