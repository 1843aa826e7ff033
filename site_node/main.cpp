#include "core/app/program.hpp"
#include "site_node/list_cameras.hpp"
#include "site_node/site_node.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    site_node::SiteNodeConfig config;
    config::OptionSet options;
    site_node::declare(config, options);
    const app::ProgramInfo info{"site_node",
                                "One room of a shared world: takes pictures, computes the visual "
                                "hull of whoever is in it, publishes it.",
                                "Examples:\n  site_node --config deploy/sites/alice.toml\n"
                                "  site_node --site.name lab --capture.source recording "
                                "--capture.recording DIR --capture.loop true\n"
                                "  site_node --list-cameras"};
    const app::Start start =
        app::start(info, options, argc, argv, [&](config::TableReader& reader) {
            site_node::read_hull(reader, config);
            site_node::read_cameras(reader, config.capture.cameras);
        });
    if (!start.go_on) return start.exit_code;
    if (config.list_cameras) {
        const auto listed = site_node::list_cameras();
        return listed ? 0 : app::fail(listed.error());
    }
    const app::StopOnSignal stop;
    auto node = site_node::SiteNode::create(config, stop.token());
    if (!node) return stop.token().stop_requested() ? 0 : app::fail(node.error());
    const auto done = (*node)->run(stop.token());
    return done ? 0 : app::fail(done.error());
}
