#pragma once

#include "tools/plan/site_plan.hpp"

#include <string>

namespace atrium::plan::testing {

/// Round figures: a picture of 1 MP costs 2 ms and 1 ms, a hull of 16 views and 4800 segments
/// 0.5 us * 16 * 4800 = 38.4 ms.
inline Costs round_costs() {
    Costs costs;
    costs.machine = "test";
    costs.score = 100.0;
    costs.silhouette_ms = {1.0, 1.0};
    costs.texture_ms = {0.5, 0.5};
    costs.texture_bytes = {1000.0, 9000.0};
    costs.segments = {100.0, 200.0};
    costs.hull_us_per_segment = 0.5;
    costs.hull_power = 1.0;
    costs.hull_two_threads = 2.0;
    costs.triangles_per_segment = 4.0;
    costs.mesh_ms_per_ktriangle = 0.1;
    costs.mesh_bytes_per_triangle = 1.5;
    costs.message_ms = {0.2, 0.0};
    return costs;
}

/// Cameras of 1 MP on `num_nodes` hosts and a model part.
inline PlanInput an_input(std::size_t num_cameras, std::size_t num_nodes, double rate_hz) {
    PlanInput input;
    input.site = "hall";
    input.rate_hz = rate_hz;
    input.costs = round_costs();
    for (std::size_t i = 0; i < num_cameras; ++i) {
        geometry::CalibratedCamera& camera = input.rig.cameras.emplace_back();
        camera.name = "cam" + std::to_string(i);
        camera.intrinsics.width = camera.intrinsics.height = 1000;
    }
    for (std::size_t node = 0; node < num_nodes; ++node) {
        hosts::HostEntry& host = input.hosts.emplace_back();
        host.name = "node" + std::to_string(node);
        for (std::size_t i = node; i < num_cameras; i += num_nodes)
            host.cameras.push_back("cam" + std::to_string(i));
    }
    if (num_nodes > 0) {
        hosts::HostEntry& model = input.hosts.emplace_back();
        model.name = "hull";
        model.is_model = true;
    }
    return input;
}

}  // namespace atrium::plan::testing
