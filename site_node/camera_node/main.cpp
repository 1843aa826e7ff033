#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus_options.hpp"
#include "site_node/camera_node/camera_node.hpp"
#include "site_node/list_cameras.hpp"

int main(int argc, char** argv) {
    using namespace atrium;
    site_node::SiteNodeConfig config;
    config::OptionSet options;
    site_node::declare(config, options);
    const app::ProgramInfo info{
        "camera_node",
        "Runs the cameras of one host of a site: finds the people in their pictures, sends their "
        "silhouettes to the host that computes the hull and their textures to the viewers.",
        "  camera_node --config deploy/sites/hall.toml\n"
        "  camera_node --config deploy/sites/hall.toml --host north\n"
        "  camera_node --config deploy/sites/hall.toml --host north --learn-background "
        "--segmentation.background_folder BACKGROUNDS",
        [&] { return config.list_cameras; },
        {},
        [&] { return bus::enter_keys(config.bus, keys::Kind::kSite, config.name); },
        [&] {
            site_node::resolve(config);
            return camera_node::check_files(config);
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
    app::apply(config.process);
    const app::StopOnSignal stop;
    if (config.learn_background) {
        const auto done = camera_node::learn_background(config, stop.token());
        return done ? 0 : app::fail(done.error());
    }
    auto node = camera_node::CameraNode::create(config, stop.token());
    if (!node) return stop.token().stop_requested() ? 0 : app::fail(node.error());
    const auto done = (*node)->run(stop.token());
    return done ? 0 : app::fail(done.error());
}
