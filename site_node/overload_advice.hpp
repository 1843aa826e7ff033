#pragma once

#include "core/status/bottleneck.hpp"
#include "site_node/stage_times.hpp"

#include <optional>
#include <string>

namespace atrium::site_node {

/// What a site knows about its own overload.
struct Overload {
    double asked_hz = 0.0;  // metaframes per second that the configuration or rig asks for
    double done_hz = 0.0;   // that are published
    double cores_used = 0.0;
    int threads = 1;    // site.threads
    int num_cores = 1;  // of the host
    std::optional<StageTimes::Work> largest_work;
};

/// Says which stage takes most of the work, and which threads or rate would do: "60/s asked, 11
/// done: segmentation takes 70 % of the work; raise site.threads to 7 (1.0 of 8 cores are used), or
/// set capture.rate_hz = 10". More threads help only if cores are free. Empty for other causes.
std::string overload_advice(const Overload& overload, atrium::status::Cause cause);

}  // namespace atrium::site_node
