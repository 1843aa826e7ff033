#pragma once

#include "core/bus/bus.hpp"
#include "core/bus/domain.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/peer_watch.hpp"
#include "core/bus/qos_profiles.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::bus {

struct DeleteQos {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, DeleteQos>;

QosPointer partition_qos(const std::vector<std::string>& partitions);
QosPointer make_writer_qos(const EndpointQos& qos);
QosPointer make_reader_qos(const EndpointQos& qos);

struct Participant::Impl {
    // The order matters: members are destroyed from the last to the first.
    Domain domain;
    QosProfiles profiles;
    NetworkReport network;
    std::string world;
    std::string place;
    Entity participant;
    Entity publisher;   // in the world's partition
    Entity subscriber;  // in the world's partition
    PeerWatch peers;
    std::shared_ptr<const keys::Bundle> keys;  // null: a world without keys

    /// The partitions of an endpoint of `topic`. Without keys that of the world, or that of a part
    /// of it if `part` is not empty. With keys those that its permissions have (core/keys); fails
    /// with kConfiguration if they have none.
    Expected<std::vector<std::string>> partitions(std::string_view topic,
                                                  const std::string& part,
                                                  bool is_reader) const;
};

}  // namespace atrium::bus
