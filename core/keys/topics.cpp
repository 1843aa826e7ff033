#include "core/keys/topics.hpp"

#include <algorithm>
#include <array>

namespace atrium::keys {
namespace {

constexpr std::array kTopics{
    Topic{"SiteDescription", Author::kSite},
    Topic{"SiteMesh", Author::kSite},
    Topic{"CameraTexture", Author::kSite},
    Topic{"CameraNodeStatus", Author::kSite},
    Topic{"RegionNodeStatus", Author::kSite},
    Topic{"SiteStatus", Author::kSite},
    Topic{"RoomRecording", Author::kSite},
    Topic{"CameraSilhouette", Author::kPart},
    Topic{"SiteOrders", Author::kPart},
    Topic{"ClockAnswer", Author::kPart},
    Topic{"RegionOrder", Author::kPart},
    Topic{"RegionMeshes", Author::kPart},
    Topic{"SitePlacement", Author::kWorld},
    Topic{"SceneObject", Author::kWorld},
    Topic{"SoftBody", Author::kWorld},
    Topic{"SoftBodyState", Author::kWorld},
    Topic{"Scenery", Author::kWorld},
    Topic{"SceneState", Author::kWorld},
    Topic{"PersonProxy", Author::kWorld},
    Topic{"ObjectProxy", Author::kWorld},
    Topic{"EditResult", Author::kWorld},
    Topic{"SavedWorlds", Author::kWorld},
    Topic{"WorldStatus", Author::kWorld},
    Topic{"ViewerStatus", Author::kViewer},
    Topic{"StreamFeedback", Author::kViewer, true},
    Topic{"SceneCommand", Author::kCommand},
    Topic{"SceneEdit", Author::kCommand},
    Topic{"RoomRecordOrder", Author::kCommand, true, Right::kRecord},
    Topic{"Presence", Author::kAll, true},
    Topic{"RevokedKeys", Author::kAll, true},
};

std::vector<std::string> part_of(const Member& site) {
    const std::string part = site.world + "/part/" + site.name;
    return {part, part + "/*"};
}

// The partition that only this member writes.
std::string own_partition(const Member& member) {
    if (member.kind == Kind::kWorld) return member.world + "/world";
    return member.world + "/" + std::string(kind_text(member.kind)) + "/" + member.name;
}

bool may_command(const Member& member) {
    return member.kind == Kind::kViewer ||
           (member.kind == Kind::kMonitor && !member.rights.is_empty());
}

}  // namespace

std::span<const Topic> topics() { return kTopics; }

const Topic* find_topic(std::string_view name) {
    const auto found = std::ranges::find(kTopics, name, &Topic::name);
    return found == kTopics.end() ? nullptr : &*found;
}

std::optional<Author> author_of(std::string_view topic) {
    const Topic* found = find_topic(topic);
    return found == nullptr ? std::nullopt : std::optional(found->author);
}

std::vector<std::string> partitions_written(const Member& member, const Topic& topic) {
    if (topic.needs_right && !member.rights.has(*topic.needs_right)) return {};
    switch (topic.author) {
        case Author::kSite:
            if (member.kind != Kind::kSite) return {};
            break;
        case Author::kPart:
            return member.kind == Kind::kSite ? part_of(member) : std::vector<std::string>();
        case Author::kWorld:
            if (member.kind != Kind::kWorld) return {};
            break;
        case Author::kViewer:
            if (member.kind != Kind::kViewer) return {};
            break;
        case Author::kCommand:
            if (!may_command(member)) return {};
            return {member.world + "/command/" + member.name + "/" + rights_text(member.rights)};
        case Author::kAll:
            break;
    }
    return {own_partition(member)};
}

std::vector<std::string> partitions_read(const Member& member, const Topic& topic) {
    const std::string& world = member.world;
    const bool is_site = member.kind == Kind::kSite;
    switch (topic.author) {
        case Author::kSite:
            // its own: what its other hosts write
            return {is_site ? own_partition(member) : world + "/site/*"};
        case Author::kPart:
            return is_site ? part_of(member) : std::vector<std::string>();
        case Author::kWorld:
            return {world + "/world"};
        case Author::kViewer:
            if (is_site && !topic.is_for_sites) return {};
            return {world + "/viewer/*"};
        case Author::kCommand:
            if (member.kind == Kind::kViewer || (is_site && !topic.is_for_sites)) return {};
            return {world + "/command/*"};
        case Author::kAll:
            return {world + "/world", world + "/site/*", world + "/viewer/*", world + "/monitor/*"};
    }
    return {};
}

std::optional<PartitionAuthor> author_of_partition(std::string_view partition,
                                                   std::string_view world) {
    if (!partition.starts_with(world)) return std::nullopt;
    partition.remove_prefix(world.size());
    if (partition == "/world") return PartitionAuthor{std::string(world), Kind::kWorld, {}};
    const auto next = [&partition]() -> std::string_view {
        if (!partition.starts_with('/')) return {};
        partition.remove_prefix(1);
        const std::string_view word = partition.substr(0, partition.find('/'));
        partition.remove_prefix(word.size());
        return word;
    };
    const std::string_view what = next();
    const std::string_view name = next();
    if (!check_key_name(name, "a member")) return std::nullopt;
    if (what == "part") return PartitionAuthor{std::string(name), Kind::kSite, {}};
    if (what == "command") {
        const auto rights = rights_of_text(next());
        if (!rights || !partition.empty()) return std::nullopt;
        return PartitionAuthor{std::string(name), std::nullopt, *rights};
    }
    const auto kind = find_kind(what);
    if (!kind || *kind == Kind::kWorld || !partition.empty()) return std::nullopt;
    return PartitionAuthor{std::string(name), *kind, {}};
}

}  // namespace atrium::keys
