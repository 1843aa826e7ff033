#include "tests/support/cdr_type.hpp"

#include <cstdio>
#include <cstdlib>

namespace atrium::test {
namespace {

int must(int result, const char* what) {
    if (result < 0) {
        std::fprintf(stderr, "%s: %s\n", what, dds_strretcode(result));
        std::abort();
    }
    return result;
}

// An isolated configuration: no peer can find this participant, and it finds none.
dds_entity_t lonely_participant() {
    constexpr dds_domainid_t kDomain = 203;
    constexpr const char* kSettings = R"(<CycloneDDS><Domain Id="any">
        <General>
            <Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
            <AllowMulticast>false</AllowMulticast>
        </General>
        <Discovery><ParticipantIndex>none</ParticipantIndex></Discovery>
    </Domain></CycloneDDS>)";
    must(dds_create_domain(kDomain, kSettings), "domain");
    return must(dds_create_participant(kDomain, nullptr, nullptr), "participant");
}

}  // namespace

// Cyclone creates its types with the topic and exposes them with a written sample.
CdrType::CdrType(const dds_topic_descriptor_t& descriptor,
                 const char* name,
                 const void* good_sample)
    : descriptor_(descriptor) {
    static const dds_entity_t participant = lonely_participant();
    const dds_entity_t topic =
        must(dds_create_topic(participant, &descriptor, name, nullptr, nullptr), name);
    const dds_entity_t reader = must(dds_create_reader(participant, topic, nullptr, nullptr), name);
    const dds_entity_t writer = must(dds_create_writer(participant, topic, nullptr, nullptr), name);
    must(dds_write(writer, good_sample), name);
    ddsi_serdata* written = nullptr;
    dds_sample_info_t info;
    must(dds_takecdr(reader, &written, 1, &info, DDS_ANY_STATE) - 1, name);
    any_.reset(written);
}

CdrType::Serialised CdrType::accept(std::span<const std::uint8_t> payload,
                                    ddsi_serdata_kind kind) const {
    constexpr std::size_t kHeaderBytes = 4;  // Cyclone drops shorter payloads before this point
    if (payload.size() < kHeaderBytes) return nullptr;
    // an exact-size copy, which shows reads beyond the end
    std::vector<std::uint8_t> copy(payload.begin(), payload.end());
    const ddsrt_iovec_t vector{copy.data(), copy.size()};
    return Serialised(ddsi_serdata_from_ser_iov(any_->type, kind, 1, &vector, copy.size()));
}

std::vector<std::uint8_t> CdrType::payload_of(const void* sample, ddsi_serdata_kind kind) const {
    const Serialised data(ddsi_serdata_from_sample(any_->type, kind, sample));
    if (!data) return {};
    std::vector<std::uint8_t> payload(ddsi_serdata_size(data.get()));
    ddsi_serdata_to_ser(data.get(), 0, payload.size(), payload.data());
    return payload;
}

bool CdrType::read(const ddsi_serdata& data, void* sample) const {
    return ddsi_serdata_to_sample(&data, sample, nullptr, nullptr);
}

bool CdrType::read_key(const ddsi_serdata& data, void* sample) const {
    const Serialised key(ddsi_serdata_to_untyped(&data));
    return key && ddsi_serdata_untyped_to_sample(any_->type, key.get(), sample, nullptr, nullptr);
}

void CdrType::free_contents(void* sample) const {
    dds_sample_free(sample, &descriptor_, DDS_FREE_CONTENTS);
}

}  // namespace atrium::test
