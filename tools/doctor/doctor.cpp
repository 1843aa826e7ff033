#include "tools/doctor/doctor.hpp"

#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>

namespace atrium::doctor {
namespace {

// Root needs no sudo, and a small system may lack it.
std::string without_sudo(std::string command) {
    constexpr std::string_view kSudo = "sudo ";
    for (std::size_t at = command.find(kSudo); at != std::string::npos;
         at = command.find(kSudo, at)) {
        const std::string before = command.substr(0, at);
        const bool begins_command = before.empty() || before.ends_with("| ") ||
                                    before.ends_with("&& ") || before.ends_with("; ");
        if (begins_command) {
            command.erase(at, kSudo.size());
        } else {
            at += kSudo.size();
        }
    }
    return command;
}

// The programs know their files best. What they refuse as wrong is an error here as well, except a
// rig, which is a finding of its own.
Expected<void> ask_programs(const Options& options, const Wishes& wishes, const System& system) {
    if (options.programs.empty() || !options.root.empty()) return {};
    for (const Wishes::Reader& asked : wishes.readers) {
        std::vector<std::string> command{
            (options.programs / asked.program).string(), "--config", wishes.file.string()};
        // a site of one process takes no --host: it says so
        const std::string& host = asked.host.empty() ? options.host : asked.host;
        if (!host.empty()) command.insert(command.end(), {"--host", host});
        command.insert(command.end(), {"--log-level", "error", "--check"});
        const auto output = system.run(command);
        constexpr int kWrongFile = 2;
        if (!output || output->exit_code != kWrongFile) continue;
        const std::string before = asked.program + ": error: ";
        const std::size_t at = output->text.find(before);
        if (at == std::string::npos) continue;
        const std::size_t begin = at + before.size();
        return make_error(ErrorKind::kConfiguration,
                          output->text.substr(begin, output->text.find('\n', begin) - begin));
    }
    return {};
}

}  // namespace

Expected<Report> examine(const Options& options, const System& system, const TextStyle& style) {
    Request request{.roles = options.roles,
                    .programs = options.programs,
                    .recordings = options.recordings,
                    .keys = options.keys,
                    .wishes = {}};
    if (!options.file.empty()) {
        const std::string host = options.host.empty() ? host_name(system) : options.host;
        auto wishes = read_wishes(options.file, host);
        if (!wishes) return tl::unexpected(wishes.error());
        request.wishes = std::move(*wishes);
        if (!request.roles) {
            const auto roles = roles_of_file(options.file, host);
            if (!roles) return tl::unexpected(roles.error());
            request.roles = *roles;
        }
    }
    if (request.wishes.rig_problem.empty()) {
        if (auto right = ask_programs(options, request.wishes, system); !right)
            return tl::unexpected(right.error());
    }
    if (!options.network.empty()) request.wishes.network = options.network;
    if (!options.interface.empty()) request.wishes.interface = options.interface;
    const Facts facts = collect(system, request);
    Findings findings = check_all(facts);
    if (facts.user.is_root) {
        for (Finding& finding : findings) {
            finding.cure = without_sudo(std::move(finding.cure));
            finding.keep = without_sudo(std::move(finding.keep));
        }
    }
    const std::vector<Checked> checked = describe(facts);
    return Report{options.is_json ? report_json(findings, checked, facts.roles)
                                  : report_text(findings, checked, style),
                  is_ill(findings)};
}

}  // namespace atrium::doctor
