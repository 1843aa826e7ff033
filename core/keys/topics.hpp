#pragma once

#include "core/keys/member.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The only table of the topics: who writes and who reads each, and in which DDS partitions.
/// Permissions are made from it. A topic that it lacks can be used by nobody in a secured world.
namespace atrium::keys {

/// The members that write a topic, and the partition that they write it in (W: the world's name).
enum class Author : std::uint8_t {
    kSite,     // sites, in W/site/NAME
    kPart,     // the hosts of one site among themselves, in W/part/NAME and W/part/NAME/*
    kWorld,    // world servers, in W/world
    kViewer,   // viewers, in W/viewer/NAME
    kCommand,  // viewers, and monitors with rights, in W/command/NAME/RIGHTS
    kAll,      // each in its own partition: W/site/NAME, W/world, W/viewer/NAME, W/monitor/NAME
};

struct Topic {
    std::string_view name;
    Author author;
    bool is_for_sites = false;           // sites read it although it is not from sites or worlds
    std::optional<Right> needs_right{};  // only members with this right may write it
};

/// All topics of core/bus.
std::span<const Topic> topics();
/// The topic of this name; null if there is none.
const Topic* find_topic(std::string_view name);
/// Who writes this topic; nullopt for an unknown one.
std::optional<Author> author_of(std::string_view topic);

/// The partitions in which `member` may write or read `topic`; empty: it may not. Readers may use
/// patterns that end in '*' exactly as they stand here. DDS permits an endpoint only if all of its
/// partitions are among these.
std::vector<std::string> partitions_written(const Member& member, const Topic& topic);
std::vector<std::string> partitions_read(const Member& member, const Topic& topic);

/// Who writes in a partition, as permissions bind it.
struct PartitionAuthor {
    std::string name;
    std::optional<Kind> kind;  // nullopt: of commands, from viewers or monitors
    Rights rights;             // of commands only
};
/// The only member that may write in `partition` of `world`: the inverse of `partitions_written`.
/// nullopt: nobody may.
std::optional<PartitionAuthor> author_of_partition(std::string_view partition,
                                                   std::string_view world);

}  // namespace atrium::keys
