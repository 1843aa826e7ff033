#pragma once

#include "core/base/timestamp.hpp"
#include "core/bus/bus.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

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

/// Notices that an instance ended and began again between two takes: Cyclone then reports only the
/// samples of its new life.
class Lives {
public:
    /// Call it for each sample with valid data. Returns how the instance's former life ended, if
    /// that was not seen.
    std::optional<Ending> ended_before(const dds_sample_info_t& info) {
        const Counts now{info.disposed_generation_count, info.no_writers_generation_count};
        const auto [found, is_new] = counts_.try_emplace(info.instance_handle, now);
        const Counts before = std::exchange(found->second, now);
        if (is_new || (now.disposed == before.disposed && now.lost == before.lost))
            return std::nullopt;
        return now.disposed != before.disposed ? Ending::kDisposed : Ending::kLost;
    }
    /// Call it when the end of the instance was seen.
    void gone(const dds_sample_info_t& info) { counts_.erase(info.instance_handle); }

private:
    struct Counts {
        std::uint32_t disposed = 0;
        std::uint32_t lost = 0;
    };
    std::unordered_map<dds_instance_handle_t, Counts> counts_;
};

}  // namespace atrium::bus
