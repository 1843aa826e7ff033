#include "core/recording/topic_roles.hpp"

#include <algorithm>
#include <array>

namespace atrium::recording {
namespace {

// Topics whose key begins with the site's name.
constexpr std::array<std::string_view, 9> kOfSites{"SiteDescription",
                                                   "SiteMesh",
                                                   "CameraTexture",
                                                   "SitePlacement",
                                                   "PersonProxy",
                                                   "SiteStatus",
                                                   "CameraNodeStatus",
                                                   "RegionNodeStatus",
                                                   "RoomRecording"};

std::string part(std::string_view key, int number) {
    for (; number > 0; --number) {
        const auto slash = key.find('/');
        if (slash == std::string_view::npos) return {};
        key.remove_prefix(slash + 1);
    }
    return std::string(key.substr(0, key.find('/')));
}

}  // namespace

// Sites have names with dots more often than hosts do.
std::string site_of_host(const std::string& name) { return name.substr(0, name.rfind('.')); }

std::size_t place_of_site(const bus::RawTopic& topic, std::string_view key) {
    return std::ranges::find(kOfSites, topic.name()) != kOfSites.end() ? 0 : key.find('/') + 1;
}

bool is_kept(const bus::RawTopic& topic) { return topic.qos_class() == "description"; }

bool is_command(const bus::RawTopic& topic) {
    return topic.qos_class() == "command" || topic.name() == "EditResult";
}

bool is_of_people(const bus::RawTopic& topic) {
    return topic.name() == "SiteMesh" || topic.name() == "CameraTexture";
}

std::optional<std::string> site_of(const bus::RawTopic& topic, std::string_view key) {
    if (std::ranges::find(kOfSites, topic.name()) != kOfSites.end()) return part(key, 0);
    if (topic.name() == "StreamFeedback") return part(key, 1);
    if (topic.name() == "Presence") {
        // site node, camera node, region node
        const std::string kind = part(key, 0);
        const std::string name = part(key, 1);
        if (kind == "0") return name;
        if (kind == "4" || kind == "5") return site_of_host(name);
    }
    return std::nullopt;
}

}  // namespace atrium::recording
