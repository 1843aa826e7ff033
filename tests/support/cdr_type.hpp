#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::test {

/// The type of one topic, as Cyclone DDS reads it from the network.
class CdrType {
public:
    struct Release {
        void operator()(ddsi_serdata* data) const { ddsi_serdata_unref(data); }
    };
    using Serialised = std::unique_ptr<ddsi_serdata, Release>;

    /// `good_sample` is a wire struct that can be written. Aborts if Cyclone fails.
    CdrType(const dds_topic_descriptor_t& descriptor, const char* name, const void* good_sample);

    /// The sample that Cyclone makes of a datagram's payload, or null if it drops the payload.
    /// `kind` is SDK_DATA for samples and SDK_KEY for the end of an instance.
    Serialised accept(std::span<const std::uint8_t> payload, ddsi_serdata_kind kind) const;

    /// The payload that carries `sample`.
    std::vector<std::uint8_t> payload_of(const void* sample, ddsi_serdata_kind kind) const;

    /// The wire structs that `take` returns, for a sample and for the end of its instance. `sample`
    /// is a wire struct, all zeros or from an earlier call. Returns false if Cyclone fails.
    bool read(const ddsi_serdata& data, void* sample) const;
    bool read_key(const ddsi_serdata& data, void* sample) const;

    /// Frees the memory that a wire struct owns after `read`.
    void free_contents(void* sample) const;

private:
    const dds_topic_descriptor_t& descriptor_;
    Serialised any_;  // holds the type
};

}  // namespace atrium::test
