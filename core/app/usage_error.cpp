#include "core/app/usage_error.hpp"

#include "core/config/spelling.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace atrium::app {
namespace {

std::string quoted(std::string text) { return "'" + std::move(text) + "'"; }

// ": did you mean '--json'?"; nothing if no name is near.
std::string suggestion(const std::string& written,
                       const std::vector<std::string>& names,
                       const std::string& before = "") {
    std::vector<std::string> meant = config::names_meant_by(written, names);
    for (std::string& name : meant) name = quoted(before + name);
    return meant.empty() ? "" : ": " + config::ask_which(meant);
}

}  // namespace

std::string usage_error(const CLI::App& cli, const CLI::ParseError& error) {
    const std::vector<const CLI::App*> commands = cli.get_subcommands({});
    const auto given =
        std::ranges::find_if(commands, [](const CLI::App* command) { return command->parsed(); });
    const bool is_given = given != commands.end();
    const CLI::App& command = is_given ? **given : cli;
    const auto with_help = [&](const std::string& text) {
        return fmt::format("{}{} `{}{} --help` shows all",
                           text,
                           text.ends_with('?') ? "" : ";",
                           cli.get_name(),
                           is_given ? " " + command.get_name() : "");
    };
    const std::vector<std::string> unknown = cli.remaining(true);
    if (unknown.empty()) return with_help(error.what());
    const std::string& first = unknown.front();
    std::vector<std::string> names;
    if (first.starts_with("-")) {
        const std::string written = first.substr(0, first.find('='));
        for (const CLI::Option* option : command.get_options())
            for (const std::string& name : option->get_lnames()) names.push_back(name);
        const std::size_t begin = std::min(written.find_first_not_of('-'), written.size());
        return with_help("unknown option " + quoted(written) +
                         suggestion(written.substr(begin), names, "--"));
    }
    if (is_given) return with_help("one word too many: " + quoted(first));
    for (const CLI::App* one : commands) names.push_back(one->get_name());
    std::string hint = suggestion(first, names);
    if (hint.empty()) hint = fmt::format(": it must be one of {}", fmt::join(names, ", "));
    return with_help("unknown command " + quoted(first) + hint);
}

}  // namespace atrium::app
