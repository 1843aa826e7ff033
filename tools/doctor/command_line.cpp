#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "tools/doctor/doctor.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string>
#include <vector>

namespace atrium::doctor {
namespace {

constexpr const char* kSummary =
    "Says what is wrong on this host for Atrium, and the command that mends it. A healthy host "
    "prints nothing.";

constexpr const char* kDetails =
    "Findings: \"stops\" Atrium, \"costs\" pictures, or \"note\". Without root it cannot read the "
    "firewall.\n"
    "To look for cameras it asks for them in the networks of all cards, as site_node does.\n"
    "Exit codes: 0 healthy (notes do not count), 1 something stops Atrium or costs pictures, 2 "
    "wrong "
    "command line or\n"
    "configuration, 3 a file that the command line names is missing.\n"
    "Examples:\n"
    "  atrium doctor\n"
    "  atrium doctor deploy/sites/cameras.toml --recordings /data\n"
    "  atrium doctor deploy/sites/hall.toml --host north\n"
    "  atrium doctor --for viewer --network wifi --json";

constexpr int kExitUsage = 2;

Start end_with_usage(const std::string& what) {
    fmt::print(stderr, "doctor: error: {}; --help lists the options\n", what);
    return {false, kExitUsage};
}

Roles roles_named(const std::vector<std::string>& names) {
    Roles roles;
    for (const std::string& name : names) {
        roles.site |= name == "site";
        roles.world |= name == "world";
        roles.viewer |= name == "viewer";
        roles.camera |= name == "camera";
    }
    return roles;
}

}  // namespace

Start parse_command_line(int argc, char** argv, Options& options) {
    CLI::App app{kSummary, "atrium doctor"};
    app.footer(kDetails);
    app.set_version_flag("--version", "doctor " + app::version() + " (Atrium)");
    app.add_option("file,--config",
                   options.file,
                   "TOML file of a site, world or viewer: also checks what it asks of this host")
        ->type_name("FILE");
    app.add_option("--host",
                   options.host,
                   "of a site on several hosts, [[host]] of FILE: the name of this one; else that "
                   "of the system")
        ->type_name("NAME");
    std::vector<std::string> roles;
    app.add_option("--for",
                   roles,
                   "check only for these, separated by commas: site, world, viewer, camera; else "
                   "for what the file is or what fits this host")
        ->type_name("ROLES")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::IsMember({"site", "world", "viewer", "camera"}));
    app.add_option(
           "--network",
           options.network,
           "network of the programs: loopback, lan, wifi, wan; else that of the file, or lan")
        ->type_name("NAME")
        ->check(CLI::IsMember({"loopback", "lan", "wifi", "wan"}));
    app.add_option("--interface", options.interface, "network card of the programs")
        ->type_name("CARD");
    app.add_option("--recordings",
                   options.recordings,
                   "folder for recordings: checks its disk with a file of 16 MiB")
        ->type_name("FOLDER")
        ->check(CLI::ExistingDirectory);
    app.add_option(
           "--keys,--security",
           options.keys,
           fmt::format("bundle or invitation of `atrium keys`, or a folder of certificates and "
                       "private keys; else {} if it is there",
                       kKeys))
        ->type_name("PATH");
    app.add_option(
           "--programs", options.programs, "folder of Atrium's programs; else that of this program")
        ->type_name("FOLDER")
        ->check(CLI::ExistingDirectory);
    app.add_option(
           "--root",
           options.root,
           "examine a copy of a host's /proc, /sys, /dev and /etc in this folder; what only "
           "a running host knows is left out")
        ->type_name("FOLDER")
        ->check(CLI::ExistingDirectory);
    app.add_flag("--json", options.is_json, "print one JSON object, also for a healthy host");
    app.add_flag("-v,--verbose", options.is_verbose, "also list what was checked");
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& asked) {
        return {false, app.exit(asked)};
    } catch (const CLI::ParseError& error) {
        return end_with_usage(error.what());
    }
    if (!options.host.empty() && options.file.empty())
        return end_with_usage("--host needs the FILE that has its [[host]]");
    if (!roles.empty()) options.roles = roles_named(roles);
    if (options.programs.empty() && options.root.empty()) options.programs = app::program_folder();
    return {true, 0};
}

}  // namespace atrium::doctor
