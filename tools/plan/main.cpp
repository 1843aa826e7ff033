#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "site_node/config.hpp"
#include "site_node/start_check.hpp"
#include "tools/plan/render_plan.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

namespace atrium::plan {
namespace {

namespace fs = std::filesystem;

struct Options {
    fs::path file;
    fs::path costs;
    int num_viewers = 1;
    double rate_hz = 0.0;
    bool json = false;
    bool simulate = false;
    int shared_cores = 0;
    double seconds = 20.0;
};

// deploy/costs.toml: beside the programs' folder, or installed.
fs::path default_costs() {
    const fs::path folder = app::program_folder();
    for (const fs::path& candidate : {folder / ".." / "deploy" / "costs.toml",
                                      folder / ".." / ".." / "deploy" / "costs.toml"}) {
        std::error_code failure;
        if (fs::exists(candidate, failure)) return candidate.lexically_normal();
    }
    return "deploy/costs.toml";
}

Expected<SitePlan> make(const Options& options) {
    auto loaded = site_node::load_site_file(options.file);
    if (!loaded) return tl::unexpected(loaded.error());
    site_node::SiteNodeConfig& config = *loaded;
    const int num_threads = config.threads;  // before 0 becomes that of this host
    site_node::resolve(config);
    auto rig = site_node::load_checked_description(config);
    if (!rig) return tl::unexpected(rig.error());
    if (const auto sharing = hosts::hosts_that_share(config.hosts); !sharing.empty())
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("host: {} have cameras = \"auto\"; which has which shows only when they "
                        "run: name the cameras of each for a plan",
                        fmt::join(sharing, " and ")));
    auto costs = load_costs(options.costs.empty() ? default_costs() : options.costs);
    if (!costs) return tl::unexpected(costs.error());
    PlanInput input;
    input.site = config.name;
    input.rate_hz = options.rate_hz > 0.0 ? options.rate_hz : rig->rate_hz;
    input.rig = std::move(*rig);
    input.hosts = config.hosts;
    for (const site_node::RegionOptions& region : config.pipeline.hull.regions) {
        plan::PlanRegion planned{region.name, region.cameras, ""};
        if (planned.cameras.empty()) {
            for (const auto& camera : input.rig.cameras) planned.cameras.push_back(camera.name);
        }
        if (const auto* host = hosts::host_of_region(input.hosts, region.name))
            planned.host = host->name;
        input.regions.push_back(std::move(planned));
    }
    input.num_threads = num_threads;
    input.num_viewers = options.num_viewers;
    input.are_live = config.capture.source == "cameras";
    input.costs = std::move(*costs);
    return make_plan(std::move(input));
}

int run(int argc, char** argv) {
    Options options;
    CLI::App cli(
        "Says which host of a site runs what, how much work that is, and where it does not fit.",
        "atrium plan");
    cli.add_option(
        "FILE", options.file, "the site's file, with [[host]] for a site on several hosts");
    cli.add_option("--viewers", options.num_viewers, "viewers that receive the textures (1)")
        ->check(CLI::Range(0, 1000));
    cli.add_option("--rate", options.rate_hz, "metaframes per second; as the file says without it")
        ->check(CLI::Range(0.1, 1000.0));
    cli.add_option("--costs", options.costs, "what the work costs; deploy/costs.toml without it");
    cli.add_flag("--simulate", options.simulate, "play the plan, with waits and drops");
    cli.add_option("--seconds", options.seconds, "how long to play (20)")
        ->check(CLI::Range(1.0, 3600.0));
    cli.add_option("--shared-cores",
                   options.shared_cores,
                   "play all hosts on so many cores, as programs on one computer")
        ->check(CLI::Range(1, 1024));
    cli.add_flag("--json", options.json, "print JSON");
    cli.set_version_flag("--version", "plan " + app::version());
    cli.footer(
        "Examples:\n"
        "  atrium plan deploy/sites/hall.toml\n"
        "  atrium plan deploy/sites/hall.toml --simulate --viewers 3\n\n"
        "Exit codes: 0 it fits; 1 it does not; 2 wrong command line or file; 3 a file is missing");
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error) == 0 ? 0 : 2;
    }
    app::log::set_program("plan");
    // not required: CLI11 would say that before it names an unknown option
    if (options.file.empty())
        return app::fail({ErrorKind::kConfiguration, "FILE is missing: the site's file"});
    app::log::set_level(app::log::Level::kWarn);
    const auto plan = make(options);
    if (!plan) return app::fail(plan.error());
    std::optional<SimulationResult> simulated;
    if (options.simulate)
        simulated =
            simulate(*plan, {.seconds = options.seconds, .shared_cores = options.shared_cores});
    const std::string text =
        options.json ? plan_json(*plan, simulated) : plan_text(*plan, simulated);
    std::fputs(text.c_str(), stdout);
    return plan->problems.empty() ? 0 : 1;
}

}  // namespace
}  // namespace atrium::plan

int main(int argc, char** argv) { return atrium::plan::run(argc, argv); }
