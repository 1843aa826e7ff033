#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/wire.hpp"
#include "core/keys/topics.hpp"

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <unordered_map>

/// Ties the keys of instances to identities, which DDS Security does not do: a member may publish
/// only in partitions that have its name, but in them samples of any key. Private to core/bus.
namespace atrium::bus {

/// Whose an instance is, as its key says.
struct Claim {
    std::string name;                // of a member, or SITE.HOST
    std::optional<keys::Kind> kind;  // nullopt: the key does not say
};

/// True if `author` may write the instances of `claim`.
bool may_write(const keys::PartitionAuthor& author, const Claim& claim);

keys::Kind key_kind(ProgramKind kind);

/// The claim of a message that has its key fields.
template <typename Message>
Claim claim_of(const Message& message) {
    if constexpr (std::is_same_v<Message, Presence>) {
        return {message.name, key_kind(message.kind)};
    } else if constexpr (std::is_same_v<Message, RoomRecording>) {
        return {message.site, {}};  // its sender is no key: that of the order it answers
    } else if constexpr (requires { message.viewer; }) {
        return {message.viewer, {}};
    } else if constexpr (requires { message.sender; }) {
        return {message.sender, {}};
    } else if constexpr (requires { message.site; }) {
        return {message.site, {}};
    } else {
        return {};
    }
}

/// Who wrote the samples of one reader. Thread-safe.
class Authors {
public:
    Authors(std::string world, std::string topic)
        : world_(std::move(world)), topic_(std::move(topic)) {}

    /// The author of a sample that the reader took, by its writer's instance handle.
    std::optional<keys::PartitionAuthor> find(dds_instance_handle_t writer) const;

    // for the cache
    const std::string& world() const { return world_; }
    const std::string& topic() const { return topic_; }
    void add(dds_instance_handle_t writer, keys::PartitionAuthor author);

private:
    const std::string world_;
    const std::string topic_;
    mutable std::mutex mutex_;
    std::unordered_map<dds_instance_handle_t, keys::PartitionAuthor> authors_;
};

/// The claim of an instance from its key as Cyclone holds it: of a wire struct with key fields.
using ClaimOfKey = std::optional<Claim> (*)(const void* wire);

template <typename Message>
std::optional<Claim> claim_of_key(const void* wire) {
    const auto key = key_from_wire<Message>(*static_cast<const WireOf<Message>*>(wire));
    return key ? std::optional(claim_of(*key)) : std::nullopt;
}

/// Creates a reader whose cache takes only what authors may write: no sample, dispose or end of
/// life of others changes an instance, and none counts in the cache's limits. What is refused is
/// logged (Participant::take_dds_log). `wire_bytes` is the size of the topic's struct.
Expected<Entity> create_guarded_reader(dds_entity_t subscriber,
                                       dds_entity_t topic,
                                       const dds_qos_t* qos,
                                       std::shared_ptr<Authors> authors,
                                       ClaimOfKey claim_of_key,
                                       std::size_t wire_bytes);

}  // namespace atrium::bus
