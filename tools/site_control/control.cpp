#include "tools/site_control/control.hpp"

#include "tools/site_control/remote_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <thread>

namespace atrium::site_control {
namespace {

namespace fs = std::filesystem;

Expected<std::string> text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream.good() && text.empty())
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot be read", file.string()));
    return text;
}

std::string script_of(const ControlOptions& options,
                      const Place& place,
                      const std::vector<SentFile>& files,
                      const std::vector<Program>& programs) {
    switch (options.command) {
        case Command::kUp:
            return up_script(place, files, programs, options.programs);
        case Command::kDown:
            return down_script(place, programs);
        case Command::kLogs:
            return logs_script(place, programs, options.num_lines);
        default:
            return status_script(place, programs);
    }
}

// Whether a line says that something is not as wanted.
bool is_bad(Command command, const std::string& line) {
    if (command == Command::kUp) return line.starts_with("failed ");
    return command == Command::kStatus && line.starts_with("does not run ");
}

}  // namespace

Expected<std::vector<SentFile>> files_to_send(const fs::path& site_file, const fs::path& rig_file) {
    auto site = text_of(site_file);
    if (!site) return tl::unexpected(site.error());
    if (rig_file.empty()) return std::vector<SentFile>{{site_file.filename().string(), *site}};
    auto rig = text_of(rig_file);
    if (!rig) return tl::unexpected(rig.error());
    const fs::path folder = fs::absolute(site_file).parent_path().lexically_normal();
    const fs::path way = fs::absolute(rig_file).lexically_normal().lexically_relative(folder);
    // as many folders above the site's file as the way to the rig goes up
    fs::path own;
    for (const fs::path& part : way) {
        if (part == "..") own /= "site";
    }
    return std::vector<SentFile>{{(own / site_file.filename()).string(), *site},
                                 {(own / way).lexically_normal().string(), *rig}};
}

std::vector<Program> programs_of(const hosts::HostEntry& host, const std::string& site_file) {
    const std::vector<std::string> arguments{"--config", "files/" + site_file, "--host", host.name};
    std::vector<Program> programs;
    if (host.takes_any || !host.cameras.empty())
        programs.push_back({"camera_node", "atrium-camera", arguments});
    if (host.is_model || !host.regions.empty())
        programs.push_back({"site_node", "atrium-site", arguments});
    return programs;
}

bool control(const ControlOptions& options, const std::function<void(const std::string&)>& say) {
    std::vector<SentFile> files;
    if (options.command == Command::kUp) {
        auto made = files_to_send(options.site_file, options.rig_file);
        if (!made) return say(made.error().message), false;
        files = std::move(*made);
    }
    std::mutex mutex;
    bool is_good = true;
    std::vector<std::jthread> workers;
    for (const hosts::HostEntry& host : options.hosts) {
        workers.emplace_back([&] {
            const std::string site_file =
                files.empty() ? options.site_file.filename().string() : files[0].path;
            const auto answer = run_script(
                shell_of(host.name, options.this_host, options.ssh),
                script_of(options, {options.site, host.name}, files, programs_of(host, site_file)),
                options.patience);
            const std::lock_guard lock(mutex);
            if (!answer) {
                is_good = false;
                return say(host.name + ": " + answer.error().message);
            }
            is_good = is_good && answer->exit_code == 0;
            std::istringstream lines(answer->output);
            for (std::string line; std::getline(lines, line);) {
                is_good = is_good && !is_bad(options.command, line);
                say(host.name + ": " + line);
            }
            if (answer->exit_code != 0 && answer->output.empty())
                say(fmt::format("{}: its shell ended with {}", host.name, answer->exit_code));
        });
    }
    workers.clear();  // joins
    return is_good;
}

}  // namespace atrium::site_control
