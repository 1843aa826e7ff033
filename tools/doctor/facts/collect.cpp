#include "tools/doctor/facts/collect.hpp"

#include <algorithm>
#include <limits>

namespace atrium::doctor {
namespace {

constexpr std::uint64_t kTestBytes = 16U << 20U;
constexpr std::uint64_t kCacheTestBytes = 0;  // only whether a file can be made

// A soft limit of this process, by the name in /proc.
std::optional<std::uint64_t> limit_of(const System& system, const std::string& name) {
    constexpr std::uint64_t kUnlimited = 99;
    for (const std::string& line : lines_of(system.read("/proc/self/limits").value_or(""))) {
        if (line.rfind(name, 0) != 0) continue;
        const auto words = words_of(line.substr(name.size()));
        if (!words.empty() && words[0] == "unlimited") return kUnlimited;
        return words.empty() ? std::nullopt : parse_number(words[0]);
    }
    return std::nullopt;
}

bool has_program(const std::vector<Program>& programs, const std::string& name) {
    return std::any_of(programs.begin(), programs.end(), [&](const Program& program) {
        return program.name == name && program.is_there;
    });
}

// Without a file and --for: by the programs that are there. A viewer needs a display or a GPU.
Roles fitting_roles(const System& system, const std::vector<Program>& programs) {
    Roles roles;
    roles.site = has_program(programs, "site_node");
    roles.world = has_program(programs, "world_server");
    const bool can_show = !system.variable("DISPLAY").empty() ||
                          !system.variable("WAYLAND_DISPLAY").empty() || system.exists("/dev/dri");
    roles.viewer = can_show && has_program(programs, "viewer");
    if (!roles.site && !roles.world && !roles.viewer) roles.site = roles.world = true;
    return roles;
}

std::optional<unsigned> group_named(const System& system, const std::string& name) {
    for (const std::string& line : lines_of(system.read("/etc/group").value_or(""))) {
        if (line.rfind(name + ":", 0) != 0) continue;
        const std::size_t begin = line.find(':', name.size() + 1) + 1;
        const auto id = parse_number(line.substr(begin, line.find(':', begin) - begin));
        if (begin > 0 && id && *id <= std::numeric_limits<unsigned>::max())
            return static_cast<unsigned>(*id);
    }
    return std::nullopt;
}

bool exists_in_lib(const System& system, const std::string& file) {
    return system.exists("/lib/" + file) || system.exists("/usr/lib/" + file);
}

bool is_below(const std::filesystem::path& path, const std::filesystem::path& folder) {
    std::error_code error;
    // a link in the folder counts as in it
    const auto whole = std::filesystem::absolute(path, error).lexically_normal();
    const auto above = std::filesystem::absolute(folder, error).lexically_normal();
    return std::mismatch(above.begin(), above.end(), whole.begin(), whole.end()).first ==
           above.end();
}

PackageFacts collect_packages(const System& system, const Request& request, const Roles& roles) {
    PackageFacts facts;
    // not an installation by hand, which lies there too
    facts.has_programs = !request.programs.empty() &&
                         is_below(request.programs, system.at("/usr/lib/atrium/bin")) &&
                         system.exists("/usr/share/doc/atrium-common/copyright");
    const std::string unit = roles.site ? "atrium-site@.service" : "atrium-world.service";
    const auto& file = request.wishes.file;
    facts.runs_file = !file.empty() && (roles.site || roles.world) &&
                      is_below(file, system.at("/etc/atrium")) &&
                      exists_in_lib(system, "systemd/system/" + unit);
    facts.group = group_named(system, "atrium");
    facts.has_usb_rule = exists_in_lib(system, "udev/rules.d/60-atrium-cameras.rules");
    return facts;
}

// The folder itself, or its nearest parent that exists.
std::filesystem::path existing_part(std::filesystem::path folder) {
    std::error_code error;
    folder = std::filesystem::absolute(folder, error);
    while (!std::filesystem::is_directory(folder, error) && folder.has_relative_path())
        folder = folder.parent_path();
    return folder;
}

}  // namespace

Facts collect(const System& system, const Request& request) {
    Facts facts;
    facts.now = system.now();
    facts.user = system.user();
    facts.wishes = request.wishes;
    facts.programs = collect_programs(system, request.programs);
    facts.roles = request.roles ? *request.roles : fitting_roles(system, facts.programs);
    facts.packages = collect_packages(system, request, facts.roles);
    facts.load = collect_load(system);  // before other programs are started
    facts.network = collect_network(system, request.wishes);
    facts.clock = collect_clock(system);
    facts.realtime_limit = limit_of(system, "Max realtime priority");
    facts.nice_limit = limit_of(system, "Max nice priority");
    const bool may_have_cameras = facts.roles.site && request.wishes.file.empty();
    if (facts.roles.camera || may_have_cameras) {
        std::optional<User> service;
        if (facts.packages.runs_file && facts.packages.group) {
            service = User{.name = "atrium", .groups = {*facts.packages.group}};
            service->id = std::numeric_limits<unsigned>::max();
        }
        facts.cameras = collect_cameras(system, facts.programs, service);
        const bool has_cameras =
            !facts.cameras.usb.empty() || (facts.cameras.found && !facts.cameras.found->empty());
        if (!request.roles) facts.roles.camera |= has_cameras;
    }
    if (facts.roles.viewer) facts.graphics = collect_graphics(system, request.programs);
    if (!request.recordings.empty())
        facts.recordings = collect_folder(system, request.recordings, kTestBytes);
    // the service writes as its own user, into a folder that systemd makes
    if (!request.wishes.cache.empty() && !facts.packages.runs_file) {
        facts.cache = collect_folder(system, existing_part(request.wishes.cache), kCacheTestBytes);
    }
    const auto& keys = request.keys.empty() ? request.wishes.keys : request.keys;
    if (!keys.empty()) {
        facts.keys = collect_keys(system, keys);
    } else if (system.exists(kKeys)) {
        facts.keys = collect_keys(system, system.at(kKeys));
    }
    return facts;
}

}  // namespace atrium::doctor
