#pragma once

#include "core/bus/entity.hpp"
#include "core/bus/qos_profiles.hpp"

#include <list>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

/// Finds programs that are there but can not be heard. Private to core/bus.
namespace atrium::bus {

/// One of our own readers or writers.
struct WatchedEndpoint {
    std::string topic_name;
    dds_entity_t topic = 0;
    dds_entity_t entity = 0;
    EndpointQos qos;
    bool is_reader = false;
};

/// Compares the readers and writers that others announce with those of this participant. DDS itself
/// says only that something did not fit, neither who it was nor, for types, that it happened.
/// Thread-safe.
class PeerWatch {
    struct State;

public:
    /// Ends with the reader or writer that it stands for.
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

    static Expected<PeerWatch> create(dds_entity_t participant, const std::string& world);

    Registration watch(WatchedEndpoint endpoint);
    /// What was found since the last call: one line per program, topic and reason, once.
    std::vector<std::string> take_complaints();

private:
    std::shared_ptr<State> state_;
};

}  // namespace atrium::bus
