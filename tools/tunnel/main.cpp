#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/app/usage_error.hpp"
#include "core/keys/bundle.hpp"
#include "tools/tunnel/keeper.hpp"
#include "tools/tunnel/tunnel.hpp"

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

namespace atrium::tunnel_tool {
namespace {

// True in the process that goes on, without a terminal.
bool go_to_background() {
    if (::fork() != 0) return false;
    ::setsid();
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
    return true;
}

int run(int argc, char** argv) {
    CLI::App cli(
        "Brings up the WireGuard tunnel of an invitation (`atrium keys invite`) on this host, so "
        "that programs with `--join` reach the world through the internet.",
        "atrium tunnel");
    cli.require_subcommand(0, 1);
    cli.set_version_flag("--version", "tunnel " + app::version());
    cli.footer(
        "Examples:\n"
        "  sudo atrium tunnel up carol.invitation\n"
        "  sudo atrium tunnel status carol.invitation\n"
        "  atrium tunnel show carol.invitation > wg0.conf   # for other systems\n\n"
        "Exit codes: 0 done; 1 the file is damaged; 2 wrong command line; 3 a file, a program or "
        "the right to change the network is missing, or the tunnel is not up");
    std::filesystem::path file;
    CLI::App* up = cli.add_subcommand("up", "make the tunnel, or bring it up to date");
    CLI::App* down = cli.add_subcommand("down", "remove it");
    CLI::App* status = cli.add_subcommand("status", "show its places, and when each was heard");
    CLI::App* show = cli.add_subcommand("show", "print the configuration for wg-quick; secret");
    bool in_foreground = false;
    up->add_flag("--foreground", in_foreground, "stay until the tunnel is removed, or Ctrl-C");
    for (CLI::App* command : {up, down, status, show}) {
        command->add_option("FILE", file, "the invitation or bundle");
        command->set_version_flag("--version", "tunnel " + app::version());
    }
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return cli.exit(error);  // --help, --version
        fmt::print(stderr, "tunnel: error: {}\n", app::usage_error(cli, error));
        return 2;
    }
    app::log::set_program("tunnel");
    if (cli.get_subcommands().empty())
        return app::fail(
            {ErrorKind::kConfiguration, "a command is missing: up, down, status or show"});
    if (file.empty())
        return app::fail(
            {ErrorKind::kConfiguration, "FILE is missing: an invitation of `atrium keys invite`"});
    const auto bundle = keys::read_bundle(file);
    if (!bundle) return app::fail(bundle.error());
    if (!bundle->tunnel)
        return app::fail(
            {ErrorKind::kInvalidData,
             fmt::format("{}: has no tunnel; `atrium keys invite` makes files with one",
                         file.string())});
    const keys::Tunnel& tunnel = *bundle->tunnel;
    const std::string card = keys::tunnel_card(bundle->member.world);
    const Run run = [](const std::vector<std::string>& command, std::string_view input) {
        return run_command(command, input);
    };
    if (*show) {
        fmt::print(
            "# for wg-quick: `wg` itself knows no Address and no MTU\n{}Address = {}/24\nMTU = "
            "{}\n{}",
            "[Interface]\n",
            tunnel.own().address,
            kTunnelMtu,
            keys::wireguard_text(tunnel).substr(sizeof("[Interface]\n") - 1));
        return 0;
    }
    if (*status) {
        const auto text = describe(tunnel, card, Timestamp::now(), run);
        if (!text) return app::fail(text.error());
        std::fputs(text->c_str(), stdout);
        return 0;
    }
    if (*up && !tunnel.is_hub() && !knows_hub(tunnel))
        return app::fail({ErrorKind::kUnavailable,
                          fmt::format("this host does not know the hub's name in {}: no internet "
                                      "here, or a wrong --hub of `atrium keys invite`",
                                      tunnel.hub)});
    const auto done = *up ? bring_up(tunnel, card, run) : take_down(tunnel, card, run);
    if (!done) return app::fail(done.error());
    if (*down) {
        fmt::print("{} is down\n", card);
        return 0;
    }
    if (tunnel.is_hub()) {
        fmt::print("{} is up with {}, the hub of {} other places; UDP port {} must be open\n",
                   card,
                   tunnel.own().address,
                   tunnel.places.size() - 1,
                   keys::port_of_hub(tunnel.hub));
    } else {
        fmt::print("{} is up with {}, through {}\n", card, tunnel.own().address, tunnel.hub);
    }
    std::fflush(stdout);
    if (!in_foreground && !go_to_background()) return 0;
    if (auto alone = become_the_keeper(card, "/run"); !alone) return app::fail(alone.error());
    const app::StopOnSignal stop;
    keep(tunnel, card, run, stop.token());
    return 0;
}

}  // namespace
}  // namespace atrium::tunnel_tool

int main(int argc, char** argv) { return atrium::tunnel_tool::run(argc, argv); }
