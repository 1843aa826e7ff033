#include "core/recording/renamed.hpp"

#include "core/bus/messages.hpp"
#include "core/recording/topic_roles.hpp"

#include <algorithm>

namespace atrium::recording {
namespace {

// The first `length` characters of `name` are the site's.
void rename(std::string& name, std::size_t length, const Names& names) {
    if (const auto found = names.find(name.substr(0, length)); found != names.end())
        name.replace(0, found->first.size(), found->second);
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
    std::size_t length = site_in(*message).size();
    if constexpr (std::is_same_v<Message, bus::Presence>) {
        if (message->kind != bus::ProgramKind::kSiteNode)
            length = site_of_host(message->name).size();
    }
    rename(site_in(*message), length, names);
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
    std::string out = key;
    return out.replace(place_of_site(topic, key), site->size(), names.at(*site));
}

}  // namespace atrium::recording
