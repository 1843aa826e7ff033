#include "core/app/program.hpp"

#include "core/app/log.hpp"
#include "core/config/spelling.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#ifndef ATRIUM_VERSION
#error "ATRIUM_VERSION is set by the build"
#endif

namespace atrium::app {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitConfiguration = 2;
constexpr int kExitMissing = 3;

// The program and option for files with these tables; nothing if they tell nothing.
std::string use_of(config::TableReader& file) {
    if (file.has_array("camera")) return "site_node --capture.rig";
    if (file.has_array("tile")) return "viewer --display.wall";
    if (file.has("motions") || file.has("sites")) return "demo --config";
    if (file.has_array("site") || file.has_array("object") || file.has("physics"))
        return "world_server --config";
    if (file.has("capture") || file.has("site")) return "site_node --config";
    return file.has("view") ? "viewer --config" : "";
}

// Extends an error in a file that is meant for another option or program.
Error with_right_use(Error error, const std::filesystem::path& file, const std::string& program) {
    auto reader = config::TableReader::load(file);
    if (!reader) return error;  // not even TOML
    const std::string use = use_of(*reader);
    const bool is_right =
        use == program + " --config" || (program == "camera_node" && use == "site_node --config");
    if (!use.empty() && !is_right)
        error.message += fmt::format("; this looks like a file for {} {}", use, file.string());
    return error;
}

// Adds the options that the file sets to `set_keys`.
Expected<void> read_file(const std::filesystem::path& file,
                         const config::OptionSet& options,
                         const ReadMore& read_more,
                         std::set<std::string>& set_keys) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    options.read_file(*reader);
    for (const auto& entry : options.entries()) {
        if (reader->has(entry.key)) set_keys.insert(entry.key);
    }
    if (read_more) read_more(*reader);
    return reader->finish();
}

Start end_with_error(const std::string& program, const Error& error) {
    fmt::print(stderr, "{}: error: {}\n", program, error.message);
    return {false, exit_code(error)};
}

// The end of --help: examples and exit codes.
std::string footer(const ProgramInfo& info) {
    std::string text;
    if (!info.examples.empty()) text += "Examples:\n" + info.examples;
    if (!text.empty() && !text.ends_with('\n')) text += '\n';
    text +=
        "Exit codes: 0 done, 1 failed while running, 2 wrong command line or configuration,\n"
        "3 something that the program needs is missing";
    return text + (info.exit_codes.empty() ? "\n" : "; here: " + info.exit_codes + "\n");
}

// For the log. Hides what may be secret in addresses: their options, and the key of rtmp.
std::string in_one_line(std::string lines) {
    static const std::regex kOptions("(://[^\n?]*)[?][^\n]*");
    static const std::regex kKey("(rtmps?://[^\n]*/)[^\n]*");
    lines = std::regex_replace(lines, kOptions, "$1?...");
    lines = std::regex_replace(lines, kKey, "$1...");
    if (!lines.empty()) lines.pop_back();  // the last line's end
    std::replace(lines.begin(), lines.end(), '\n', ';');
    return lines;
}

std::vector<std::string> option_names(const CLI::App& cli) {
    std::vector<std::string> names;
    for (const CLI::Option* option : cli.get_options()) {
        const auto& long_names = option->get_lnames();
        names.insert(names.end(), long_names.begin(), long_names.end());
    }
    return names;
}

// Error text for unknown arguments, with a suggestion for the first.
std::string say_unknown(const CLI::App& cli) {
    const std::vector<std::string> unknown = cli.remaining();
    std::string text = fmt::format("unexpected: {}", fmt::join(unknown, " "));
    if (unknown.empty()) return text;
    const std::string& first = unknown.front();
    const auto begin = first.find_first_not_of('-');
    if (begin == 0) {
        const bool is_name = std::isalpha(static_cast<unsigned char>(first.front())) != 0 &&
                             first.find_first_of("./=") == std::string::npos;
        if (is_name && cli.get_option_no_throw("--world") != nullptr)
            return text + fmt::format("; a world is given as --world {}", first);
        return text + (first.ends_with(".toml")
                           ? fmt::format("; a file is given as --config {}", first)
                           : "; every value follows the name of its option, as in --name VALUE");
    }
    if (begin == std::string::npos) return text;
    const std::string written = first.substr(begin, first.find('=') - begin);
    const std::string hint =
        config::ask_which(config::names_meant_by(written, option_names(cli)), "--");
    return hint.empty() ? text : text + "; " + hint;
}

// '-' and '_' count as equal in the names of options: writes them as the program declares them.
std::vector<std::string> with_declared_names(const CLI::App& cli, int argc, char** argv) {
    const auto plain = [](std::string name) {
        std::replace(name.begin(), name.end(), '-', '_');
        return name;
    };
    std::map<std::string, std::string> declared;  // by the name with '_'
    for (const std::string& name : option_names(cli)) declared.emplace(plain(name), name);
    std::vector<std::string> words(argv + 1, argv + argc);
    for (std::string& word : words) {
        if (!word.starts_with("--")) continue;
        const std::size_t length = std::min(word.find('='), word.size()) - 2;
        const auto found = declared.find(plain(word.substr(2, length)));
        if (found != declared.end()) word.replace(2, length, found->second);
    }
    return words;
}

// What CLI11 found wrong, in our words.
std::string say_wrong(const CLI::App& cli, const CLI::ParseError& wrong) {
    if (dynamic_cast<const CLI::ExtrasError*>(&wrong) != nullptr) return say_unknown(cli);
    const std::string what = wrong.what();
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&wrong) != nullptr) {
        const std::string option = what.substr(0, what.find_first_of(": "));
        return option + ": needs one value, and may be given once";
    }
    return what;
}

sigset_t stop_signals() {
    sigset_t set;
    sigemptyset(&set);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set, signal);
    return set;
}

}  // namespace

std::string version() { return ATRIUM_VERSION; }

int exit_code(const Error& error) {
    switch (error.kind) {
        case ErrorKind::kConfiguration:
            return kExitConfiguration;
        case ErrorKind::kNotFound:
        case ErrorKind::kUnavailable:
            return kExitMissing;
        case ErrorKind::kInvalidData:
        case ErrorKind::kInternal:
            return kExitFailed;
    }
    return kExitFailed;
}

Start start(const ProgramInfo& info,
            const config::OptionSet& options,
            int argc,
            char** argv,
            const ReadMore& read_more) {
    CLI::App cli(info.summary, info.name);
    cli.set_version_flag("--version", fmt::format("{} {} (Atrium)", info.name, ATRIUM_VERSION));
    cli.footer(footer(info));
    std::filesystem::path config_file;
    cli.add_option("--config",
                   config_file,
                   "TOML file; its keys are the options below without the dashes, and more for "
                   "lists such as "
                   "cameras and objects (docs/)")
        ->type_name("FILE");
    std::string log_level = "info";
    cli.add_option("--log-level", log_level, "debug, info, warn or error")
        ->capture_default_str()
        ->type_name("TEXT");
    bool only_checks = false;
    cli.add_flag("--check", only_checks, "check file and options, and exit: 0 if they are right");
    std::map<std::string, std::string> given;
    for (const auto& entry : options.entries()) {
        const std::string shown_default =
            entry.default_value.empty() ? "none" : entry.default_value;
        const std::string dashes = entry.alias.size() == 1 ? ",-" : ",--";
        const std::string names =
            "--" + entry.key + (entry.alias.empty() ? "" : dashes + entry.alias);
        auto* option = cli.add_option_function<std::string>(
            names,
            [&given, key = entry.key, implicit_value = entry.implicit_value](
                const std::string& text) { given[key] = text.empty() ? implicit_value : text; },
            entry.help);
        option->type_name(fmt::format("({}; default {})", entry.type_name, shown_default));
        if (!entry.implicit_value.empty()) option->expected(0, 1);
        if (entry.key == info.positional) {
            cli.add_option_function<std::string>(
                   "FILE",
                   [&given, key = entry.key](const std::string& text) { given[key] = text; },
                   "the same as --" + entry.key)
                ->type_name("");
        }
    }
    try {
        std::vector<std::string> words = with_declared_names(cli, argc, argv);
        std::reverse(words.begin(), words.end());  // as CLI11 wants them
        cli.parse(std::move(words));
    } catch (const CLI::Success& asked) {
        return {false, cli.exit(asked)};
    } catch (const CLI::ParseError& wrong) {
        const std::string what = say_wrong(cli, wrong);
        return end_with_error(
            info.name,
            {ErrorKind::kConfiguration,
             fmt::format("{}{} --help lists the options", what, what.ends_with('?') ? "" : ";")});
    }
    log::set_program(info.name);
    if (!log::set_level(log_level)) {
        return end_with_error(
            info.name,
            {ErrorKind::kConfiguration,
             fmt::format("--log-level: must be one of debug, info, warn, error, got '{}'",
                         log_level)});
    }
    if (cli.count("--config") > 0 && config_file.empty()) {
        return end_with_error(info.name,
                              {ErrorKind::kConfiguration, "--config: needs the path of a file"});
    }
    std::set<std::string> set_keys;
    if (!config_file.empty()) {
        if (auto read = read_file(config_file, options, read_more, set_keys); !read)
            return end_with_error(info.name, with_right_use(read.error(), config_file, info.name));
    }
    for (const auto& [key, text] : given) {
        if (auto set = options.set(key, text, "--" + key); !set)
            return end_with_error(info.name, set.error());
        set_keys.insert(key);
    }
    if (info.check) {
        if (const auto valid = info.check(); !valid)
            return end_with_error(info.name, valid.error());
    }
    if (only_checks) {
        if (const auto right = info.check_files ? info.check_files() : Expected<void>(); !right)
            return end_with_error(info.name, right.error());
        return {false, 0};
    }
    // debug only: several thousand characters would hide a following error
    log::debug("effective options=\"{}\"", in_one_line(options.effective()));
    const bool only_prints = info.only_prints && info.only_prints();
    log::write(only_prints ? log::Level::kDebug : log::Level::kInfo,
               fmt::format("started version={} config={} options=\"{}\"",
                           ATRIUM_VERSION,
                           config_file.string(),
                           in_one_line(options.changed(set_keys))));
    return {true, 0};
}

struct StopOnSignal::Impl {
    std::stop_source source;
    std::atomic<bool> leaving{false};
    std::thread waiter;
};

StopOnSignal::StopOnSignal() : impl_(new Impl) {
    const sigset_t set = stop_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    impl_->waiter = std::thread([impl = impl_, set] {
        std::optional<std::chrono::steady_clock::time_point> asked;
        for (;;) {
            int signal = 0;
            if (sigwait(&set, &signal) != 0) continue;
            if (impl->leaving) return;
            // a terminal and a dying parent can both send a signal for the same event; a later one
            // means that the user insists
            const auto now = std::chrono::steady_clock::now();
            if (asked && now - *asked < std::chrono::seconds(1)) continue;
            // not exit(): a hanging thread may hold what destructors wait for
            if (asked) std::quick_exit(128 + signal);
            asked = now;
            log::info("stopping signal={}", signal);
            impl->source.request_stop();
        }
    });
}

StopOnSignal::~StopOnSignal() {
    impl_->leaving = true;
    pthread_kill(impl_->waiter.native_handle(), SIGTERM);
    impl_->waiter.join();
    delete impl_;
}

std::stop_token StopOnSignal::token() const { return impl_->source.get_token(); }

int fail(const Error& error) {
    log::error("failed reason=\"{}\"", error.message);
    return exit_code(error);
}

std::uint64_t resident_bytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t total_pages = 0;
    std::uint64_t resident_pages = 0;
    if (!(statm >> total_pages >> resident_pages)) return 0;
    return resident_pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace atrium::app
