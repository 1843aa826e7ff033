#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/presence/membership.hpp"
#include "site_node/config.hpp"
#include "tools/site_control/control.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace atrium::site_control {
namespace {

namespace fs = std::filesystem;

struct Named {
    const char* name;
    Command command;
    const char* what;
};
constexpr Named kCommands[] = {
    {"up", Command::kUp, "send the site's file and rig to all hosts and start their programs"},
    {"down", Command::kDown, "end the programs of a site on all hosts"},
    {"status", Command::kStatus, "say which programs of a site run, and their last warning"},
    {"logs", Command::kLogs, "print the last lines of the logs of all hosts"}};

struct Options {
    fs::path file;
    std::string ssh;
    std::string programs;
    std::string this_host;
    std::vector<std::string> only;
    int lines = 20;
    double patience_s = 30.0;
};

void declare(CLI::App& command, Options& options, Command which) {
    command.set_version_flag("--version", "site_control " + app::version());
    command.add_option("FILE", options.file, "the site's file, with [[host]]");
    command.add_option("--only", options.only, "this host only; several: separated by commas")
        ->delimiter(',')
        ->allow_extra_args(false);
    command.add_option(
        "--ssh",
        options.ssh,
        "how to reach a host; \"ssh -o BatchMode=yes -o ConnectTimeout=5\" without it");
    command.add_option(
        "--this-host", options.this_host, "the name of this host, where no SSH is needed");
    command.add_option("--patience", options.patience_s, "seconds to wait for each host (30)")
        ->check(CLI::Range(1.0, 600.0));
    if (which == Command::kUp)
        command.add_option("--programs",
                           options.programs,
                           "folder of the programs on the hosts; as here without it");
    if (which == Command::kLogs)
        command.add_option("--lines", options.lines, "of each log (20)")
            ->check(CLI::Range(1, 100000));
}

std::string read_text(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// What the hosts could not start with.
Expected<void> check_start(const site_node::SiteNodeConfig& config, const Options& options) {
    const bool is_recording = config.capture.source == "recording";
    const auto rig = config::load_rig(is_recording ? config.capture.recording : config.capture.rig);
    if (!rig) return tl::unexpected(rig.error());
    if (auto fits = site_node::check_hosts(config, *rig); !fits) return fits;
    if (!options.programs.empty() && fs::path(options.programs).is_relative())
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("--programs: '{}' must be an absolute path: it is that of all hosts",
                        options.programs));
    return {};
}

// Files of the network that the file names by a path of its own: they are not sent.
Expected<void> check_network_files(config::TableReader written, const fs::path& file) {
    config::TableReader bus = written.table("bus");
    for (const std::string key : {"network", "profiles_file"}) {
        std::string text;
        bus.read(key, text);
        const bool is_word = key == "network" && text.find_first_of("/.") == std::string::npos;
        if (text.empty() || is_word || fs::path(text).is_absolute()) continue;
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: bus.{}: '{}' is not sent to the hosts: give it an "
                                      "absolute path, and copy it there",
                                      file.string(),
                                      key,
                                      text));
    }
    return {};
}

Expected<ControlOptions> prepare(const Options& options, Command command) {
    auto loaded = site_node::load_site_file(options.file);
    if (!loaded) return tl::unexpected(loaded.error());
    site_node::SiteNodeConfig& config = *loaded;
    // as written: the reader makes it relative to the file
    auto written = config::TableReader::parse(read_text(options.file), options.file.string());
    fs::path written_rig;
    if (written) {
        written->table("capture").read("rig", written_rig);
        if (auto sent = check_network_files(*written, options.file);
            !sent && command == Command::kUp)
            return tl::unexpected(sent.error());
    }
    if (written_rig.is_absolute())
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: capture.rig: '{}' must be a relative path, so that all "
                                      "hosts find the file that is sent",
                                      options.file.string(),
                                      written_rig.string()));
    if (config.hosts.empty())
        return make_error(ErrorKind::kConfiguration,
                          options.file.string() +
                              ": has no [[host]]: the site is one process, "
                              "site_node (docs/site_hosts.md)");
    if (command == Command::kUp) {
        // programs that run can be ended whatever became of the rig
        if (auto right = check_start(config, options); !right) return tl::unexpected(right.error());
    }
    ControlOptions out;
    out.command = command;
    out.site = config.name;
    for (const hosts::HostEntry& host : config.hosts) {
        if (options.only.empty() ||
            std::ranges::find(options.only, host.name) != options.only.end())
            out.hosts.push_back(host);
    }
    for (const std::string& name : options.only) {
        if (auto found = hosts::find_host(config.hosts, name); !found)
            return tl::unexpected(found.error());
    }
    out.site_file = options.file;
    if (config.capture.source != "recording")
        out.rig_file = config.capture.rig;  // a recording is too large
    out.this_host = options.this_host.empty() ? presence::host_name() : options.this_host;
    out.programs = options.programs.empty() ? app::program_folder().string() : options.programs;
    out.num_lines = options.lines;
    out.patience = std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * options.patience_s));
    if (!options.ssh.empty()) {
        out.ssh.clear();
        std::istringstream words(options.ssh);
        for (std::string word; words >> word;) out.ssh.push_back(word);
    }
    return out;
}

int run(int argc, char** argv) {
    // `atrium up` runs atrium-up, a link to this program
    std::vector<std::string> words(argv + 1, argv + argc);
    const std::string own_name = fs::path(argv[0]).filename().string();
    for (const Named& named : kCommands) {
        if (own_name == std::string("atrium-") + named.name)
            words.insert(words.begin(), named.name);
    }
    CLI::App cli(
        "Runs the programs of a site on all its hosts, over SSH. Files are in ~/.atrium/SITE "
        "there.",
        "site_control");
    cli.require_subcommand(0, 1);
    cli.set_version_flag("--version", "site_control " + app::version());
    cli.footer(
        "Examples:\n"
        "  atrium up hall.toml\n"
        "  atrium logs hall.toml --only left --lines 100\n\n"
        "Exit codes: 0 all is as wanted; 1 a host does not answer, or a program does not run; 2 "
        "wrong "
        "command line or file; 3 a file is missing");
    Options options;
    for (const Named& named : kCommands)
        declare(*cli.add_subcommand(named.name, named.what), options, named.command);
    try {
        std::reverse(words.begin(), words.end());  // as CLI11 wants them
        cli.parse(words);
    } catch (const CLI::ParseError& error) {
        return cli.exit(error) == 0 ? 0 : 2;
    }
    app::log::set_program("site_control");
    app::log::set_level(app::log::Level::kWarn);
    for (const Named& named : kCommands) {
        if (!cli.got_subcommand(named.name)) continue;
        // not required: CLI11 would say that before it names an unknown option
        if (options.file.empty())
            return app::fail({ErrorKind::kConfiguration, "FILE is missing: the site's file"});
        const auto prepared = prepare(options, named.command);
        if (!prepared) return app::fail(prepared.error());
        const bool is_good = control(*prepared, [](const std::string& line) {
            std::printf("%s\n", line.c_str());
            std::fflush(stdout);
        });
        return is_good ? 0 : 1;
    }
    return app::fail({ErrorKind::kConfiguration, "a command is missing: up, down, status or logs"});
}

}  // namespace
}  // namespace atrium::site_control

int main(int argc, char** argv) { return atrium::site_control::run(argc, argv); }
