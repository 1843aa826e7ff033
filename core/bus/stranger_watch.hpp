#pragma once

#include <dds/dds.h>

#include <chrono>
#include <map>
#include <string>

namespace atrium::bus {

/// Says which programs in the domain do not talk to this one because of keys, which Cyclone DDS
/// does silently: with keys those that have none or do not accept this program's; without keys
/// those that tell this program nothing, if nobody else does. Logs through DdsLog. Used by one
/// thread. Private to core/bus.
class StrangerWatch {
public:
    StrangerWatch() = default;
    StrangerWatch(dds_entity_t participant, bool has_keys);

    /// Call it about once a second, with readers of the built-in topics of the domain.
    void look(dds_entity_t participants, dds_entity_t publications, dds_entity_t subscriptions);

private:
    struct Stranger {
        std::chrono::steady_clock::time_point since;
        bool is_reported = false;
    };

    std::string complaint_about(const dds_builtintopic_participant_t& stranger) const;

    bool has_keys_ = false;
    bool hears_others_ = false;  // without keys: somebody once did, and the rest is not asked for
    std::string own_;            // participant
    std::map<std::string, Stranger> strangers_;
};

}  // namespace atrium::bus
