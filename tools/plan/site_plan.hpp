#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "site_node/hosts/site_hosts.hpp"
#include "tools/plan/costs.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::plan {

/// A part of the site with a hull of its own.
struct PlanRegion {
    std::string name;                  // empty: the whole site
    std::vector<std::string> cameras;  // that watch it
    std::string host;                  // that computes its hull; empty: the model part
};

/// What a plan is made from.
struct PlanInput {
    std::string site;
    config::Rig rig;
    double rate_hz = 30.0;
    std::vector<hosts::HostEntry> hosts;  // checked; empty: one process does all
    std::vector<PlanRegion> regions;      // empty: one hull of all cameras
    int num_threads = 0;                  // site.threads; 0: all cores of a host but one
    int num_viewers = 1;
    bool are_live = false;  // cameras on a network, whose pictures a link carries
    Costs costs;
};

/// One stage of the work on a metaframe on one host.
struct Stage {
    std::string name;
    double work_ms = 0.0;   // on one core of this host
    double lasts_ms = 0.0;  // with the cores that it can use
};

struct HostPlan {
    std::string name;
    int cores = 1;
    int threads = 1;     // that work on pictures and hulls
    double speed = 1.0;  // of one core, relative to the machine of the costs
    std::vector<std::string> cameras;
    bool is_model = false;
    std::vector<std::string> regions;   // whose hulls it computes, by name
    std::vector<std::string> programs;  // the command lines
    std::vector<Stage> stages;
    double load = 0.0;                // share of its cores
    double cameras_mbit_per_s = 0.0;  // from its cameras, uncompressed
    double in_mbit_per_s = 0.0;       // from other hosts
    double out_mbit_per_s = 0.0;      // to other hosts and viewers
    double link_mbit_per_s = 0.0;
};

/// Which host does what, what it costs, and where it does not fit.
struct SitePlan {
    PlanInput input;
    std::vector<HostPlan> hosts;
    double order_ms = 0.0;                 // until the last region's host has its silhouettes
    double latency_ms = 0.0;               // from capture to the written mesh, without waits
    std::vector<std::string> problems;     // what does not fit, with a cure
    std::vector<std::string> assumptions;  // by which it is computed
};

/// The threads that a program of a host with so many cores uses.
int threads_on(const PlanInput& input, int cores);

/// Predicts each stage from `costs`. A host fits if it has a third of its cores and links to spare:
/// people move, and so do costs.
SitePlan make_plan(PlanInput input);

/// A message's way through a wired network.
inline constexpr double kWay_ms = 0.3;

/// Largest share of cores and links that a plan uses.
inline constexpr double kMostUsed = 0.67;

}  // namespace atrium::plan
