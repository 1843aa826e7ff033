#pragma once

#include <dds/dds.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

/// Reads what Cyclone DDS tells of other programs in its built-in topics. Private to core/bus.
namespace atrium::bus {

inline constexpr int kMaxRead = 4096;  // samples read at once

/// Calls `visit` with each valid sample of a built-in topic's reader. Reads, does not take.
template <typename Visit>
void read_each(dds_entity_t reader, std::uint32_t which, Visit&& visit) {
    std::vector<void*> samples(static_cast<std::size_t>(kMaxRead), nullptr);
    std::vector<dds_sample_info_t> infos(static_cast<std::size_t>(kMaxRead));
    const int num = dds_read_mask(reader, samples.data(), infos.data(), kMaxRead, kMaxRead, which);
    for (int i = 0; i < num; ++i) {
        const auto index = static_cast<std::size_t>(i);
        if (infos[index].valid_data) visit(samples[index], infos[index].instance_handle);
    }
    if (num > 0) dds_return_loan(reader, samples.data(), num);
}

/// Returns a property from an untrusted sender for the log: at most 64 printable characters.
std::string property_of(const dds_qos_t* qos, const char* key);

/// The participant's part of a GUID in hexadecimal.
std::string prefix_text(const dds_guid_t& guid);

/// "HOST pid PID" of a participant, by its own words; empty: it does not say.
std::string process_of(const dds_builtintopic_participant_t& participant);

}  // namespace atrium::bus
