#pragma once

#include "core/bus/entity.hpp"
#include "core/bus/qos_profiles.hpp"

#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

/// Finds programs of the world that are present but incompatible. Private to core/bus.
namespace atrium::bus {

/// The partitions of an endpoint, names or patterns.
std::vector<std::string> worlds_of(const dds_qos_t* qos);

/// A reader or writer of this process.
struct WatchedEndpoint {
    std::string topic_name;
    dds_entity_t topic = 0;
    dds_entity_t entity = 0;
    std::vector<std::string> partitions;  // names or patterns
    EndpointQos qos;
    bool is_reader = false;
};

/// Compares the readers and writers that other processes announce with those of this participant.
/// DDS reports a QoS mismatch without the peer, and a type mismatch not at all. Thread-safe.
class PeerWatch {
    struct State;

public:
    /// Watches an endpoint for as long as this object lives. Owned by the reader or writer.
    class Registration {
    public:
        Registration() = default;
        Registration(Registration&&) = default;
        Registration& operator=(Registration&& other) noexcept;
        ~Registration();

    private:
        friend class PeerWatch;
        std::shared_ptr<State> state_;
        std::list<WatchedEndpoint>::iterator place_;
    };

    static Expected<PeerWatch> create(dds_entity_t participant,
                                      const std::string& world,
                                      bool has_keys);

    Registration watch(WatchedEndpoint endpoint);
    /// Returns the mismatches found since the last call: one line per program, topic and reason,
    /// reported once; at most 8 per call.
    std::vector<std::string> take_mismatches();

    /// Returns the names of other worlds in this domain that had programs at the last
    /// `take_mismatches`.
    std::vector<std::string> other_worlds() const;

private:
    std::shared_ptr<State> state_;
};

}  // namespace atrium::bus
