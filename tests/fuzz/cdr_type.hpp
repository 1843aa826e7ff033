#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::test {

/// One topic's type, as Cyclone DDS reads it from the network.
class CdrType {
public:
    struct Release {
        void operator()(ddsi_serdata* data) const { ddsi_serdata_unref(data); }
    };
    using Serialised = std::unique_ptr<ddsi_serdata, Release>;

    /// `good_sample` is a wire struct that can be written. Aborts where Cyclone cannot be used.
    CdrType(const dds_topic_descriptor_t& descriptor, const char* name, const void* good_sample);

    /// What a datagram's payload is made into, or null where Cyclone drops it. `kind` is SDK_DATA
    /// for samples, SDK_KEY for what tells that a key is gone.
    Serialised accept(std::span<const std::uint8_t> payload, ddsi_serdata_kind kind) const;

    /// The payload that `sample` is sent as.
    std::vector<std::uint8_t> payload_of(const void* sample, ddsi_serdata_kind kind) const;

    /// What `take` hands out, of a sample and of the end of its key. `sample` is a wire struct, all
    /// zeros or from an earlier call; false where Cyclone fails.
    bool read(const ddsi_serdata& data, void* sample) const;
    bool read_key(const ddsi_serdata& data, void* sample) const;

    /// Gives back what a wire struct owns after `read`.
    void free_contents(void* sample) const;

private:
    const dds_topic_descriptor_t& descriptor_;
    Serialised any_;  // holds the type
};

}  // namespace atrium::test
