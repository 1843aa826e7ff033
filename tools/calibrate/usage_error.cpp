#include "core/config/spelling.hpp"
#include "tools/calibrate/subcommands.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace atrium::calibrate {
namespace {

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        const auto& long_names = option->get_lnames();
        names.insert(names.end(), long_names.begin(), long_names.end());
    }
    return names;
}

// "record" for "recording"
std::vector<std::string> names_beginning_with(const std::string& written,
                                              std::vector<std::string> names) {
    constexpr std::size_t kFewestLetters = 3;
    std::erase_if(names, [&](const std::string& name) {
        return written.size() < kFewestLetters || !name.starts_with(written);
    });
    return names;
}

}  // namespace

std::string usage_error(const CLI::App& app, const std::string& reason) {
    const std::vector<const CLI::App*> chosen = app.get_subcommands({});
    const auto parsed =
        std::ranges::find_if(chosen, [](const CLI::App* command) { return command->parsed(); });
    const CLI::App& command = parsed == chosen.end() ? app : **parsed;
    const std::vector<std::string> unknown = app.remaining(true);
    if (!unknown.empty()) {
        const std::string& first = unknown.front();
        const std::size_t begin = first.find_first_not_of('-');
        std::string hint;
        if (begin == 0 && parsed == chosen.end()) {
            std::vector<std::string> names;
            for (const CLI::App* one : chosen) names.push_back(one->get_name());
            hint = config::ask_which(config::names_meant_by(first, names));
            if (hint.empty()) hint = fmt::format("the subcommands are {}", fmt::join(names, ", "));
        } else if (begin != std::string::npos && begin > 0) {
            const std::string written = first.substr(begin, first.find('=') - begin);
            std::vector<std::string> names = config::names_meant_by(written, option_names(command));
            if (names.empty()) names = names_beginning_with(written, option_names(command));
            hint = config::ask_which(names, "--");
        }
        return fmt::format("unexpected: {}{}",
                           fmt::join(unknown, " "),
                           hint.empty() ? "; --help lists the options" : "; " + hint);
    }
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        if (reason == name + " is required")
            return fmt::format("{}: {}", reason, option->get_description());
        const auto num_words = static_cast<std::size_t>(option->get_expected_max());
        const std::vector<std::string>& words = option->results();
        if (reason.starts_with(name + ":") && reason.find("received") != std::string::npos &&
            num_words > 1 && words.size() > num_words) {
            return fmt::format(
                "{0} is given once, with {1}, for example {0} {2}",
                name,
                option->get_type_name(),
                fmt::join(
                    words.begin(), words.begin() + static_cast<std::ptrdiff_t>(num_words), " "));
        }
    }
    return reason + "; --help lists the options";
}

}  // namespace atrium::calibrate
