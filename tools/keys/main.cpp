#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/app/usage_error.hpp"
#include "tools/keys/commands.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>

namespace atrium::keys_tool {
namespace {

using Command = Expected<Outcome> (*)(const Options&, Timestamp);

struct Named {
    const char* name;
    Command run;
    const char* what;
};
constexpr Named kCommands[] = {
    {"init", init, "make the authorities of a world, in the folder WORLD.keys"},
    {"add", add, "make the keys of a new member"},
    {"list", list, "show all members: rights, end, state"},
    {"revoke", revoke, "declare the key of a member invalid"},
    {"renew", renew, "give a member a new key, and revoke the old one"},
    {"export", export_bundle, "write the bundle that a member needs to join"},
    {"invite", invite, "write keys and a tunnel through the internet for a member, in one file"},
    {"check", check, "check a bundle, or the whole key store"}};

void add_days(CLI::App& command, Options& options, int days) {
    command.add_option("--days", options.days, fmt::format("days of validity ({})", days))
        ->check(CLI::Range(1, keys::kMaxDays));
}

void add_rights(CLI::App& command, Options& options, const char* without) {
    command.add_option("--rights",
                       options.rights,
                       fmt::format("of add, remove, reset, push, grab, edit, save, record; all or "
                                   "none ({})",
                                   without));
}

// Names are not required: CLI11 would say that before it names an unknown option.
void declare(CLI::App& command, Options& options, Command which) {
    command.set_version_flag("--version", "keys " + app::version());
    command.add_option("--keys",
                       options.keys,
                       which == init ? "the folder to make (WORLD.keys)"
                                     : "the key store; the only folder *.keys here without it");
    if (which == init) {
        command.add_option("WORLD", options.name, "name of the world");
        add_days(command, options, keys::kAuthorityDays);
        return;
    }
    if (which == check) command.add_option("BUNDLE", options.bundle, "without it: the key store");
    if (which == list) command.add_flag("--json", options.json, "print JSON");
    if (which == list || which == check) return;
    const bool adds = which == add || which == invite;
    if (adds) command.add_option("KIND", options.kind, "site, viewer, world or monitor");
    command.add_option(
        "NAME",
        options.name,
        adds ? "name of the member; that of the world for KIND world" : "name of the member");
    if (adds || which == renew) {
        add_rights(
            command, options, adds ? "grab,push for viewers, none for monitors" : "as before");
        add_days(command, options, keys::kMemberDays);
    }
    if (which == revoke)
        command.add_option("--reason", options.reason, "lost or left (lost); the list keeps it");
    if (which == invite)
        command.add_option("--hub",
                           options.hub,
                           "HOST or HOST:PORT of the world server's host, as others reach it over "
                           "the internet (as before; UDP port 51820)");
    if (which == export_bundle || which == invite) {
        command.add_option("-o,--output",
                           options.output,
                           which == invite ? "the file to write, mode 0600 (NAME.invitation)"
                                           : "the file to write, mode 0600");
        command.add_flag("--replace", options.replace, "overwrite the file");
    }
}

int run(int argc, char** argv) {
    CLI::App cli(
        "Makes and checks the keys with which sites, viewers and world servers join a world that "
        "is closed to all others.",
        "atrium keys");
    cli.require_subcommand(0, 1);
    cli.set_version_flag("--version", "keys " + app::version());
    cli.footer(
        "Examples:\n"
        "  atrium keys init playroom\n"
        "  atrium keys add site alice\n"
        "  atrium keys add viewer bob --rights grab,push,edit\n"
        "  atrium keys export alice -o alice.bundle\n"
        "  atrium keys revoke bob\n"
        "  atrium keys invite viewer carol --hub studio.example.org\n\n"
        "Exit codes: 0 done; 1 keys are damaged, expired or revoked; 2 wrong command line; 3 a "
        "file is missing, or another program holds the key store");
    Options options;
    cli.add_option("--keys", options.keys, "the key store; also after COMMAND");
    for (const Named& named : kCommands)
        declare(*cli.add_subcommand(named.name, named.what), options, named.run);
    try {
        cli.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return cli.exit(error);  // --help, --version
        fmt::print(stderr, "keys: error: {}\n", app::usage_error(cli, error));
        return 2;
    }
    app::log::set_program("keys");
    app::log::set_level(app::log::Level::kWarn);
    for (const Named& named : kCommands) {
        if (!cli.got_subcommand(named.name)) continue;
        const auto outcome = named.run(options, Timestamp::now());
        if (!outcome) return app::fail(outcome.error());
        std::fputs(outcome->text.c_str(), stdout);
        return outcome->exit_code;
    }
    return app::fail(
        {ErrorKind::kConfiguration,
         "a command is missing: init, add, list, revoke, renew, export, invite or check"});
}

}  // namespace
}  // namespace atrium::keys_tool

int main(int argc, char** argv) { return atrium::keys_tool::run(argc, argv); }
