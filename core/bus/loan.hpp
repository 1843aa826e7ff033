#pragma once

#include "core/base/timestamp.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

/// Samples taken from Cyclone without a copy. Private to core/bus.
namespace atrium::bus {

inline constexpr std::size_t kTakeBatch = 32;
// Bounds a take of 8192 samples, the most that any profile lets a reader hold. A take thus ends
// even if samples arrive as fast as they are taken.
inline constexpr std::size_t kMaxBatchesPerTake = 256;

/// Takes samples on loan from Cyclone. Returns them at the end of the scope, exceptions included.
class Loan {
public:
    explicit Loan(dds_entity_t reader) : reader_(reader) {
        num_samples_ = dds_take(reader_, samples_.data(), infos_.data(), kTakeBatch, kTakeBatch);
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;
    ~Loan() {
        if (num_samples_ > 0) dds_return_loan(reader_, samples_.data(), num_samples_);
    }
    int size() const { return num_samples_; }  // negative: an error
    const void* sample(int i) const { return samples_[static_cast<std::size_t>(i)]; }
    const dds_sample_info_t& info(int i) const { return infos_[static_cast<std::size_t>(i)]; }

private:
    dds_entity_t reader_;
    std::array<void*, kTakeBatch> samples_{};  // null at [0] asks for a loan
    std::array<dds_sample_info_t, kTakeBatch> infos_{};
    int num_samples_ = 0;
};

/// The time, which is untrusted, is clamped: differences of two times must not overflow.
inline Timestamp when_written(const dds_sample_info_t& info) {
    constexpr dds_time_t kLast = std::numeric_limits<dds_time_t>::max() / 2;
    return {std::clamp<dds_time_t>(info.source_timestamp, 0, kLast)};
}

/// True if an instance has ended and this is its last sample of the batch. The last sample and the
/// end of its writer can arrive as one, with valid data; the instance state is the current one.
inline bool is_end_of_instance(const dds_sample_info_t& info) {
    return info.instance_state != DDS_ALIVE_INSTANCE_STATE && info.sample_rank == 0;
}

}  // namespace atrium::bus
