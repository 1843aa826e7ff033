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
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
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

Expected<void> read_file(const std::filesystem::path& file,
                         const config::OptionSet& options,
                         const ReadMore& read_more) {
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    options.read_file(*reader);
    if (read_more) read_more(*reader);
    return reader->finish();
}

Start end_with_error(const std::string& program, const Error& error) {
    fmt::print(stderr, "{}: error: {}\n", program, error.message);
    return {false, exit_code(error)};
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

// Error text for unknown arguments, with a suggestion if the first resembles an option.
std::string say_unknown(const CLI::App& cli) {
    const std::vector<std::string> unknown = cli.remaining();
    std::string text = fmt::format("unexpected: {}", fmt::join(unknown, " "));
    if (unknown.empty() || !unknown.front().starts_with("--")) return text;
    const std::string written = unknown.front().substr(2, unknown.front().find('=') - 2);
    for (const CLI::Option* option : cli.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            if (config::may_be_misspelling(written, name))
                return text + fmt::format("; did you mean --{}?", name);
        }
    }
    return text;
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
    cli.footer(info.examples);
    std::filesystem::path config_file;
    cli.add_option(
           "--config", config_file, "TOML file; its keys are the options below without the dashes")
        ->type_name("FILE");
    std::string log_level = "info";
    cli.add_option("--log-level", log_level, "debug, info, warn or error")
        ->capture_default_str()
        ->type_name("TEXT");
    std::map<std::string, std::string> given;
    for (const auto& entry : options.entries()) {
        const std::string shown_default =
            entry.default_value.empty() ? "none" : entry.default_value;
        const std::string names =
            "--" + entry.key + (entry.alias.empty() ? "" : ",--" + entry.alias);
        auto* option = cli.add_option_function<std::string>(
            names,
            [&given, key = entry.key, implicit_value = entry.implicit_value](
                const std::string& text) { given[key] = text.empty() ? implicit_value : text; },
            entry.help);
        option->type_name(fmt::format("({}; default {})", entry.type_name, shown_default));
        if (!entry.implicit_value.empty()) option->expected(0, 1);
    }
    try {
        cli.parse(argc, argv);
    } catch (const CLI::Success& asked) {
        return {false, cli.exit(asked)};
    } catch (const CLI::ExtrasError&) {
        return end_with_error(
            info.name,
            {ErrorKind::kConfiguration, say_unknown(cli) + "; --help lists the options"});
    } catch (const CLI::ParseError& wrong) {
        return end_with_error(
            info.name,
            {ErrorKind::kConfiguration, fmt::format("{}; --help lists the options", wrong.what())});
    }
    log::set_program(info.name);
    if (!log::set_level(log_level)) {
        return end_with_error(
            info.name,
            {ErrorKind::kConfiguration,
             fmt::format("--log-level: must be one of debug, info, warn, error, got '{}'",
                         log_level)});
    }
    if (!config_file.empty()) {
        if (auto read = read_file(config_file, options, read_more); !read)
            return end_with_error(info.name, read.error());
    }
    for (const auto& [key, text] : given) {
        if (auto set = options.set(key, text, "--" + key); !set)
            return end_with_error(info.name, set.error());
    }
    // debug only: several thousand characters would hide a following error
    log::debug("effective options=\"{}\"", in_one_line(options.effective()));
    const bool only_prints = info.only_prints && info.only_prints();
    log::write(only_prints ? log::Level::kDebug : log::Level::kInfo,
               fmt::format("started version={} config={} options=\"{}\"",
                           ATRIUM_VERSION,
                           config_file.string(),
                           in_one_line(options.changed())));
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
