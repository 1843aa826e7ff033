#include "tools/atrium/commands.hpp"

#include "core/config/spelling.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <system_error>

namespace atrium::front {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "atrium-";

bool is_program(const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

bool is_shipped(const std::string& name) {
    return std::ranges::any_of(shipped_commands(),
                               [&](const Command& command) { return command.name == name; });
}

// A name becomes part of a path: it must not lead out of the folder.
bool is_name(const std::string& word) {
    return !word.empty() && word.front() != '-' && word.find('/') == std::string::npos;
}

tl::unexpected<Error> unknown_command(const std::string& name, const fs::path& folder) {
    std::string message = fmt::format("no command '{}';", name);
    for (const Command& command : installed_commands(folder)) {
        if (!config::may_be_misspelling(name, command.name)) continue;
        message += fmt::format(" did you mean '{}'?", command.name);
        break;
    }
    return make_error(ErrorKind::kConfiguration, message + " `atrium help` lists all commands");
}

}  // namespace

std::span<const Command> shipped_commands() {
    static const std::array<Command, 20> commands{
        {{"site", "capture a room and publish the people in it"},
         {"camera", "run the cameras of one host of a room on several hosts"},
         {"world", "run the physics of a world"},
         {"viewer", "show a world in a window, pictures or a video"},
         {"demo", "run two simulated rooms, a world server and a viewer on this host"},
         {"monitor", "show the programs of a world: rates, latencies, losses"},
         {"record", "record a world into a file"},
         {"play", "play a recorded world for viewers, monitors and world servers"},
         {"export", "export recorded people for Blender and other programs"},
         {"calibrate", "make rig.toml, or a recording, from the calibration of another program"},
         {"cameras", "offer a simulated room or a recording as GigE Vision cameras"},
         {"plan", "say which host of a site does what, and whether it can"},
         {"up", "start the programs of a site on all its hosts, over SSH"},
         {"down", "end the programs of a site on all its hosts"},
         {"status", "say which programs of a site run, host by host"},
         {"logs", "print the logs of a site, host by host"},
         {"keys", "make and check the keys with which members join a closed world"},
         {"tunnel", "bring up the way through the internet of an invitation"},
         {"hull", "compute one visual hull from files"},
         {"doctor", "say what is wrong on this host, and the command that mends it"}}};
    return commands;
}

std::vector<Command> installed_commands(const fs::path& folder) {
    std::vector<Command> installed;
    for (const Command& command : shipped_commands()) {
        if (is_program(folder / (kPrefix + command.name))) installed.push_back(command);
    }
    const auto num_shipped = static_cast<std::ptrdiff_t>(installed.size());
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string file = entry->path().filename();
        if (!file.starts_with(kPrefix) || !is_program(entry->path())) continue;
        const std::string name = file.substr(std::string(kPrefix).size());
        if (is_name(name) && !is_shipped(name)) installed.push_back({name, ""});
    }
    std::sort(installed.begin() + num_shipped,
              installed.end(),
              [](const Command& l, const Command& r) { return l.name < r.name; });
    return installed;
}

std::string help(std::span<const Command> installed) {
    std::string text =
        "Runs the programs of Atrium: `atrium NAME ...` starts the program `atrium-NAME` beside "
        "it.\n"
        "Usage: atrium NAME [OPTIONS]\n"
        "       atrium help [NAME]\n"
        "\nCommands:\n";
    for (const Command& command : installed)
        text += fmt::format("  {:<12}{}\n", command.name, command.summary);
    if (installed.empty()) text += "  none: no program `atrium-NAME` is beside this one\n";
    text +=
        "\nOptions:\n"
        "  -h,--help   Print this help message and exit\n"
        "  --version   Display program version information and exit\n"
        "\n`atrium help NAME` explains a command.\n"
        "Exit codes: those of the tool; 2 no such tool or option, 3 the tool is not installed\n";
    return text;
}

Expected<std::vector<std::string>> program_for(std::span<const std::string> words,
                                               const fs::path& folder) {
    const bool wants_help = words.front() == "help" && words.size() > 1;
    if (wants_help) words = words.subspan(1);
    const std::string& name = words.front();
    if (name.starts_with("-")) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("unknown option '{}'; see `atrium --help`", name));
    }
    const fs::path program = folder / (kPrefix + name);
    if (!is_name(name) || !is_program(program)) {
        if (!is_shipped(name)) return unknown_command(name, folder);
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: not there; build or install the tool '{}'", program.string(), name));
    }
    std::vector<std::string> arguments{program.string()};
    if (wants_help) {
        arguments.emplace_back("--help");
    } else {
        arguments.insert(arguments.end(), words.begin() + 1, words.end());
    }
    return arguments;
}

}  // namespace atrium::front
