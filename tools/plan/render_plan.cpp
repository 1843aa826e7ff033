#include "tools/plan/render_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace atrium::plan {
namespace {

using nlohmann::ordered_json;

std::string cameras_text(const HostPlan& host) {
    if (host.cameras.empty()) return "no cameras";
    return fmt::format("{} camera{}: {}",
                       host.cameras.size(),
                       host.cameras.size() == 1 ? "" : "s",
                       fmt::join(host.cameras, " "));
}

std::string stages_text(const HostPlan& host) {
    std::string text;
    for (const Stage& stage : host.stages)
        text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", stage.name, stage.work_ms);
    return text;
}

}  // namespace

std::string plan_text(const SitePlan& plan, const std::optional<SimulationResult>& simulated) {
    std::string text = fmt::format("site {}: {} cameras at {:g}/s on {} host{}\n",
                                   plan.input.site,
                                   plan.input.rig.cameras.size(),
                                   plan.input.rate_hz,
                                   plan.hosts.size(),
                                   plan.hosts.size() == 1 ? "" : "s");
    for (const HostPlan& host : plan.hosts) {
        text +=
            fmt::format("\n{}  ({} cores, {} thread{}{})\n",
                        host.name,
                        host.cores,
                        host.threads,
                        host.threads == 1 ? "" : "s",
                        host.speed == 1.0 ? "" : fmt::format(", {:.2f} times as fast", host.speed));
        for (const std::string& program : host.programs) text += "  runs     " + program + "\n";
        text += "  cameras  " + cameras_text(host) + "\n";
        if (plan.input.regions.size() > 1 && !host.regions.empty())
            text += fmt::format("  hulls    {} region{}: {}\n",
                                host.regions.size(),
                                host.regions.size() == 1 ? "" : "s",
                                fmt::join(host.regions, " "));
        text += fmt::format("  work     {:.0f} % of its cores; ms per metaframe: {}\n",
                            100.0 * host.load,
                            stages_text(host));
        text += fmt::format("  link     {:.1f} Mbit/s in, {:.1f} out{} of {:.0f}\n",
                            host.in_mbit_per_s,
                            host.out_mbit_per_s,
                            host.cameras_mbit_per_s > 0.0
                                ? fmt::format("; {:.0f} from its cameras", host.cameras_mbit_per_s)
                                : "",
                            host.link_mbit_per_s);
    }
    text +=
        fmt::format("\nlatency   {:.1f} ms from capture to the written mesh, if nothing waits\n",
                    plan.latency_ms);
    if (simulated) {
        text += fmt::format(
            "simulated {:.1f} metaframes/s, {:.1f} % dropped, {:.1f} ms from capture "
            "to the written mesh (p99 {:.1f})\n",
            simulated->metaframes_per_s,
            100.0 * simulated->dropped,
            simulated->median_ms,
            simulated->p99_ms);
    }
    text += plan.problems.empty() ? "\nit fits\n" : "\nit does not fit:\n";
    for (const std::string& problem : plan.problems) text += "  - " + problem + "\n";
    text += "\nassumed:\n";
    for (const std::string& assumption : plan.assumptions) text += "  - " + assumption + "\n";
    return text;
}

std::string plan_json(const SitePlan& plan, const std::optional<SimulationResult>& simulated) {
    ordered_json out;
    out["site"] = plan.input.site;
    out["num_cameras"] = plan.input.rig.cameras.size();
    out["rate_hz"] = plan.input.rate_hz;
    out["latency_ms"] = plan.latency_ms;
    out["fits"] = plan.problems.empty();
    out["problems"] = plan.problems;
    out["assumptions"] = plan.assumptions;
    out["hosts"] = ordered_json::array();
    for (const HostPlan& host : plan.hosts) {
        ordered_json stages = ordered_json::object();
        for (const Stage& stage : host.stages)
            stages[stage.name] = {{"work_ms", stage.work_ms}, {"lasts_ms", stage.lasts_ms}};
        out["hosts"].push_back({{"name", host.name},
                                {"cores", host.cores},
                                {"threads", host.threads},
                                {"speed", host.speed},
                                {"model", host.is_model},
                                {"cameras", host.cameras},
                                {"regions", host.regions},
                                {"programs", host.programs},
                                {"stages", stages},
                                {"load", host.load},
                                {"cameras_mbit_per_s", host.cameras_mbit_per_s},
                                {"in_mbit_per_s", host.in_mbit_per_s},
                                {"out_mbit_per_s", host.out_mbit_per_s},
                                {"link_mbit_per_s", host.link_mbit_per_s}});
    }
    out["simulation"] = nullptr;
    if (simulated) {
        out["simulation"] = {{"metaframes_per_s", simulated->metaframes_per_s},
                             {"dropped", simulated->dropped},
                             {"median_ms", simulated->median_ms},
                             {"p99_ms", simulated->p99_ms},
                             {"loads", simulated->loads}};
    }
    return out.dump(1) + "\n";
}

}  // namespace atrium::plan
