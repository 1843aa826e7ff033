#pragma once

#include "core/bus/bus.hpp"
#include "core/bus/domain.hpp"
#include "core/bus/entity.hpp"
#include "core/bus/peer_watch.hpp"
#include "core/bus/qos_profiles.hpp"

#include <memory>

namespace atrium::bus {

struct DeleteQos {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using QosPointer = std::unique_ptr<dds_qos_t, DeleteQos>;

QosPointer partition_qos(const std::string& partition);
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

    /// The partition of a part of the world; of the world itself if `part` is empty.
    std::string partition(const std::string& part) const {
        return part.empty() ? world : world + "/" + part;
    }
};

}  // namespace atrium::bus
