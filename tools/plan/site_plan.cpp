#include "tools/plan/site_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

namespace atrium::plan {
namespace {

constexpr double kBytesPerSegment = 16.0;       // two doubles
constexpr double kBytesPerMessage = 330.0;      // names, times and headers
constexpr double kBytesPerPixelOfCamera = 1.0;  // BayerRG8, Mono8

double megapixels(const geometry::CalibratedCamera& camera) {
    return 1e-6 * camera.intrinsics.width * camera.intrinsics.height;
}

double mbit_per_s(double bytes, double rate_hz) { return 8e-6 * bytes * rate_hz; }

// How many people a camera sees: one in each region that it watches.
double people_of(const PlanInput& input, const std::string& camera) {
    return static_cast<double>(std::ranges::count_if(input.regions, [&](const PlanRegion& region) {
        return std::ranges::find(region.cameras, camera) != region.cameras.end();
    }));
}

// Sums over some cameras.
struct Sums {
    double silhouette_ms = 0.0;
    double texture_ms = 0.0;
    double texture_bytes = 0.0;
    double segments = 0.0;
    double camera_bytes = 0.0;
    std::size_t num = 0;

    double silhouette_bytes() const {
        return kBytesPerSegment * segments + kBytesPerMessage * static_cast<double>(num);
    }
};

// `num_people` of each camera; empty: one in each region that it watches.
Sums sums_of(const PlanInput& input,
             const std::vector<std::string>& names,
             std::optional<double> num_people = {}) {
    Sums sums;
    for (const geometry::CalibratedCamera& camera : input.rig.cameras) {
        if (std::ranges::find(names, camera.name) == names.end()) continue;
        const double mp = megapixels(camera);
        const double people = num_people.value_or(people_of(input, camera.name));
        sums.silhouette_ms += input.costs.silhouette_ms.of(mp);
        sums.texture_ms += people * input.costs.texture_ms.of(mp);
        sums.texture_bytes += people * input.costs.texture_bytes.of(mp);
        sums.segments += people * input.costs.segments.of(std::sqrt(mp));
        sums.camera_bytes += kBytesPerPixelOfCamera * 1e6 * mp;
        ++sums.num;
    }
    return sums;
}

// Messages that a host writes or takes.
struct Messages {
    double num = 0.0;
    double bytes = 0.0;

    void add(double more, double more_bytes) {
        num += more;
        bytes += more_bytes;
    }
    // half of a message's costs are the other side's
    double work_ms(const Costs& costs) const {
        return 0.5 * (costs.message_ms.fixed * num + 1e-3 * costs.message_ms.slope * bytes);
    }
};

// The hulls and meshes of some regions.
struct HullSums {
    double hull_ms = 0.0;        // on one core
    double hull_lasts_ms = 0.0;  // with the threads of the host
    double mesh_ms = 0.0;
    double mesh_bytes = 0.0;
    double order_bytes = 0.0;  // of their silhouettes
    std::vector<std::string> names;
};

HullSums hulls_of(const PlanInput& input, const std::string& host, int num_threads) {
    const Costs& costs = input.costs;
    HullSums sums;
    std::vector<std::string> cameras;
    for (const PlanRegion& region : input.regions) {
        if (region.host != host) continue;
        // the silhouettes of people elsewhere are work, too, but give no surface
        const Sums seen = sums_of(input, region.cameras);
        const Sums own = sums_of(input, region.cameras, 1.0);
        const double triangles = costs.triangles_per_segment * own.segments;
        sums.hull_ms += costs.hull_ms(seen.num, seen.segments, 1);
        sums.hull_lasts_ms += costs.hull_ms(seen.num, seen.segments, num_threads);
        sums.mesh_ms += 1e-3 * costs.mesh_ms_per_ktriangle * triangles;
        sums.mesh_bytes += costs.mesh_bytes_per_triangle * triangles;
        sums.names.push_back(region.name);
        cameras.insert(cameras.end(), region.cameras.begin(), region.cameras.end());
    }
    // each silhouette once, however many regions of the host need it
    sums.order_bytes = sums_of(input, cameras).silhouette_bytes();
    return sums;
}

std::vector<std::string> all_names(const config::Rig& rig) {
    std::vector<std::string> names;
    for (const auto& camera : rig.cameras) names.push_back(camera.name);
    return names;
}

void find_problems(const HostPlan& host, double rate_hz, std::vector<std::string>& problems) {
    if (host.load > kMostUsed) {
        const double fits_hz = rate_hz * kMostUsed / host.load;
        problems.push_back(fmt::format(
            "host {}: its work takes {:.0f} % of its {} cores; {:.0f} % may be used. Give it {} "
            "cores, fewer cameras, or capture.rate_hz = {}",
            host.name,
            100.0 * host.load,
            host.cores,
            100.0 * kMostUsed,
            static_cast<int>(std::ceil(host.cores * host.load / kMostUsed)),
            fits_hz >= 1.0 ? fmt::format("{:.0f}", std::floor(fits_hz))
                           : fmt::format("{:.2g}", fits_hz)));
    }
    const double period_ms = 1e3 / rate_hz;
    for (const Stage& stage : host.stages) {
        if (stage.lasts_ms <= period_ms) continue;
        problems.push_back(fmt::format(
            "host {}: {} of a metaframe lasts {:.0f} ms with {} thread{}, the period is {:.1f} ms: "
            "{:.0f} metaframes/s at most{}",
            host.name,
            stage.name,
            stage.lasts_ms,
            host.threads,
            host.threads == 1 ? "" : "s",
            period_ms,
            1e3 / stage.lasts_ms,
            stage.name == "hull" ? ". Use [[hull.region]] with fewer cameras each, or fewer cameras"
                                 : ""));
    }
    const double link = host.link_mbit_per_s;
    for (const auto& [way, used] : {std::pair("from its cameras", host.cameras_mbit_per_s),
                                    std::pair("into it", host.in_mbit_per_s),
                                    std::pair("out of it", host.out_mbit_per_s)}) {
        if (used <= kMostUsed * link) continue;
        problems.push_back(fmt::format(
            "host {}: {:.0f} Mbit/s {}, its link carries {:.0f}: use a "
            "faster link{}",
            host.name,
            used,
            way,
            link,
            std::string(way) == "from its cameras" ? ", several network cards, or fewer cameras"
                                                   : ""));
    }
}

}  // namespace

int threads_on(const PlanInput& input, int cores) {
    return input.num_threads > 0 ? input.num_threads : std::max(1, cores - 1);
}

SitePlan make_plan(PlanInput input) {
    SitePlan plan;
    std::vector<hosts::HostEntry> entries = input.hosts;
    const bool is_one_process = entries.empty();
    if (is_one_process) {
        hosts::HostEntry one;
        one.name = "this host";
        one.cameras = all_names(input.rig);
        one.is_model = true;
        one.cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        entries.push_back(one);
    }
    const Costs& costs = input.costs;
    if (input.regions.empty()) input.regions.push_back({"", all_names(input.rig), ""});
    const Sums all = sums_of(input, all_names(input.rig));
    const auto num_region_hosts = std::ranges::count_if(
        entries, [&](const auto& entry) { return !hulls_of(input, entry.name, 1).names.empty(); });
    double mesh_bytes = hulls_of(input, "", 1).mesh_bytes;
    double order_bytes = 0.0;
    for (const hosts::HostEntry& entry : entries) {
        const HullSums elsewhere = hulls_of(input, entry.name, 1);
        mesh_bytes += elsewhere.mesh_bytes;
        order_bytes += elsewhere.order_bytes;
    }
    const double viewers = input.num_viewers;
    double slowest_node_ms = 0.0;
    double slowest_hull_ms = 0.0;
    for (const hosts::HostEntry& entry : entries) {
        HostPlan host;
        host.name = entry.name;
        host.cores = entry.cores;
        host.threads = threads_on(input, entry.cores);
        host.speed = entry.score > 0.0 && costs.score > 0.0 ? entry.score / costs.score : 1.0;
        host.is_model = entry.is_model;
        host.cameras = hosts::cameras_of(entry, entries, input.rig);
        host.link_mbit_per_s = 1e3 * entry.link_gbit_per_s;
        const Sums own = sums_of(input, host.cameras);
        const auto on = [&](double work_ms) { return work_ms / host.speed; };
        const auto on_link = [&](double bytes) { return 8e-3 * bytes / host.link_mbit_per_s; };
        // cameras after each other on each thread
        const auto rounds = std::ceil(static_cast<double>(own.num) / host.threads);
        Messages messages;
        if (own.num > 0) {
            const double silhouettes = on(own.silhouette_ms);
            const double lasts = rounds * silhouettes / static_cast<double>(own.num);
            host.stages.push_back({"silhouettes", silhouettes, lasts});
            const double textures = on(own.texture_ms);
            host.stages.push_back({"textures", textures, textures / host.threads});
            if (!is_one_process) {
                messages.add(static_cast<double>(own.num), own.silhouette_bytes());
                host.programs.push_back("camera_node --config FILE --host " + host.name);
            }
            slowest_node_ms = std::max(slowest_node_ms, lasts + (is_one_process ? 0.0 : kWay_ms));
            if (input.are_live)
                host.cameras_mbit_per_s = mbit_per_s(own.camera_bytes, input.rate_hz);
            host.out_mbit_per_s += mbit_per_s(own.texture_bytes, input.rate_hz) * viewers;
            if (!host.is_model)
                host.out_mbit_per_s += mbit_per_s(own.silhouette_bytes(), input.rate_hz);
        }
        const HullSums hulls = hulls_of(input, host.is_model ? "" : host.name, host.threads);
        host.regions = hulls.names;
        double hull_lasts_ms = 0.0;
        if (!hulls.names.empty()) {
            const double mesh = on(hulls.mesh_ms);
            host.stages.push_back({"hull", on(hulls.hull_ms), on(hulls.hull_lasts_ms)});
            host.stages.push_back({"mesh", mesh, mesh});
            hull_lasts_ms = on(hulls.hull_lasts_ms) + mesh;
        }
        if (host.is_model) {
            if (!is_one_process) {
                messages.add(static_cast<double>(all.num), all.silhouette_bytes());
                messages.add(static_cast<double>(num_region_hosts), order_bytes);
                messages.add(static_cast<double>(num_region_hosts), mesh_bytes - hulls.mesh_bytes);
                host.in_mbit_per_s +=
                    mbit_per_s(all.silhouette_bytes() - own.silhouette_bytes(), input.rate_hz) +
                    mbit_per_s(mesh_bytes - hulls.mesh_bytes, input.rate_hz);
                host.out_mbit_per_s += mbit_per_s(order_bytes, input.rate_hz);
                host.programs.push_back("site_node --config FILE --host " + host.name);
                // the orders leave one after another
                if (num_region_hosts > 0) plan.order_ms = kWay_ms + on_link(order_bytes);
            } else {
                host.programs.push_back("site_node --config FILE");
            }
            // the world server takes the mesh, too
            host.out_mbit_per_s += mbit_per_s(mesh_bytes, input.rate_hz) * (viewers + 1.0);
        } else if (!hulls.names.empty()) {
            messages.add(2.0, hulls.order_bytes + hulls.mesh_bytes);
            host.in_mbit_per_s += mbit_per_s(hulls.order_bytes, input.rate_hz);
            host.out_mbit_per_s += mbit_per_s(hulls.mesh_bytes, input.rate_hz);
            host.programs.push_back("site_node --config FILE --host " + host.name);
        }
        if (messages.num > 0.0) {
            const double work = on(messages.work_ms(costs));
            host.stages.push_back({"messages", work, work / host.cores});
        }
        slowest_hull_ms = std::max(
            slowest_hull_ms,
            hull_lasts_ms +
                (host.is_model || hulls.names.empty() ? 0.0 : kWay_ms + on_link(hulls.mesh_bytes)));
        double work_ms = 0.0;
        for (const Stage& stage : host.stages) work_ms += stage.work_ms;
        host.load = 1e-3 * work_ms * input.rate_hz / host.cores;
        find_problems(host, input.rate_hz, plan.problems);
        plan.hosts.push_back(std::move(host));
    }
    plan.latency_ms = slowest_node_ms + plan.order_ms + slowest_hull_ms;
    plan.assumptions = {
        fmt::format("one person {}; costs of {} (score {:.0f}), {}",
                    input.regions.size() > 1 ? "in each region, whom its cameras see whole"
                                             : "whom all cameras see whole",
                    costs.machine,
                    costs.score,
                    costs.measured),
        "[[host]] cores (4), score (that of the costs) and link_gbit_per_s (1) where the file does "
        "not say them",
        fmt::format("{} viewer{} and one world server; camera pictures of one byte per pixel",
                    input.num_viewers,
                    input.num_viewers == 1 ? "" : "s"),
        "cameras have network cards of their own, as fast as the host's link",
        fmt::format("{:.1f} ms for a message's way through the network; no other work on the hosts",
                    kWay_ms)};
    plan.input = std::move(input);
    return plan;
}

}  // namespace atrium::plan
