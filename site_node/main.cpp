#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "site_node/list_cameras.hpp"
#include "site_node/region_node.hpp"
#include "site_node/silhouette_writer.hpp"
#include "site_node/site_node.hpp"

namespace {

template <typename Node>
int run(const atrium::site_node::SiteNodeConfig& config, const atrium::app::StopOnSignal& stop) {
    auto node = Node::create(config, stop.token());
    if (!node) return stop.token().stop_requested() ? 0 : atrium::app::fail(node.error());
    const auto done = (*node)->run(stop.token());
    return done ? 0 : atrium::app::fail(done.error());
}

}  // namespace

int main(int argc, char** argv) {
    using namespace atrium;
    site_node::SiteNodeConfig config;
    config::OptionSet options;
    site_node::declare(config, options);
    const app::ProgramInfo info{
        "site_node",
        "Captures one room of a shared world, computes the visual hull of "
        "the people in it, and publishes it.",
        "  site_node --config deploy/sites/alice.toml\n"
        "  site_node --site.name lab --capture.source recording "
        "--capture.recording DIR --capture.loop\n"
        "  site_node --list-cameras\n"
        "  site_node --recording DIR --learn-background "
        "--segmentation.background_folder BACKGROUNDS\n"
        "  site_node --recording DIR --write-silhouettes OUT",
        [&] { return config.list_cameras; },
        {},
        [&] { return bus::enter_keys(config.bus, keys::Kind::kSite, config.name); },
        [&] {
            site_node::resolve(config);
            return site_node::check_files(config);
        }};
    const app::Start start =
        app::start(info, options, argc, argv, [&](config::TableReader& reader) {
            site_node::read_tables(reader, config);
        });
    if (!start.go_on) return start.exit_code;
    if (config.list_cameras) {
        const auto listed = site_node::list_cameras();
        return listed ? 0 : app::fail(listed.error());
    }
    site_node::resolve(config);
    config.settings = options.effective();
    app::apply(config.process);
    const app::StopOnSignal stop;
    if (config.learn_background || !config.write_silhouettes.empty()) {
        const auto done = config.learn_background
                              ? site_node::learn_background(config, stop.token())
                              : site_node::write_silhouettes(config, stop.token());
        return done ? 0 : app::fail(done.error());
    }
    return site_node::is_region_host(config) ? run<site_node::RegionNode>(config, stop)
                                             : run<site_node::SiteNode>(config, stop);
}
