#pragma once

#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "site_node/pipeline.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::site_node {

/// Collects stage durations and byte counts of a site for its status. Thread-safe.
class StageTimes {
public:
    void computed(const SiteFrame& frame);
    /// Records the payload sizes of one metaframe and how long it took to publish.
    void published(std::size_t mesh_bytes,
                   std::size_t texture_bytes,
                   std::chrono::nanoseconds duration,
                   std::chrono::nanoseconds capture_to_publish);

    /// Work of the pool per stage since the previous call, for advice about overload.
    struct Work {
        std::string name;
        double share = 0.0;    // of the work of all stages
        bool is_wait = false;  // for other hosts
        std::string remedy{};  // an option that saves this work; empty: there is none
    };
    /// The stage with the most work; nullopt without any.
    std::optional<Work> largest_work();

    /// Computes byte rates since the previous call. If nothing is published for three seconds, all
    /// durations are forgotten: they would show a site that works.
    void update_rates(std::chrono::steady_clock::time_point now);
    void put_into(bus::SiteStatus& status) const;

private:
    mutable std::mutex mutex_;
    std::array<double, 7> work_ms_{};  // since the last largest_work
    LatencyWindow silhouettes_;
    LatencyWindow hull_;
    LatencyWindow coding_;
    LatencyWindow publishing_;
    LatencyWindow capture_to_publish_;
    std::chrono::steady_clock::time_point last_published_{};  // seen by update_rates
    bool has_published_ = false;                              // since update_rates
    std::uint64_t num_mesh_bytes_ = 0;
    std::uint64_t num_texture_bytes_ = 0;
    RateMeter mesh_rate_;
    RateMeter texture_rate_;
    double mesh_bytes_per_s_ = 0.0;
    double texture_bytes_per_s_ = 0.0;
};

}  // namespace atrium::site_node
