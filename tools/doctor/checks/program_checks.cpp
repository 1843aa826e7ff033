#include "core/config/spelling.hpp"
#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace atrium::doctor {
namespace {

// Of Debian 12. The name of a library does not give that of its package.
constexpr std::array<std::pair<const char*, const char*>, 29> kPackages{
    {{"libEGL.so.1", "libegl1 libegl-mesa0"},
     {"libGL.so.1", "libgl1"},
     {"libOSMesa.so.8", "libosmesa6"},
     {"libX11.so.6", "libx11-6"},
     {"libaravis-0.8.so.0", "libaravis-0.8-0"},
     {"libassimp.so.5", "libassimp5"},
     {"libavcodec.so.59", "libavcodec59"},
     {"libavformat.so.59", "libavformat59"},
     {"libavutil.so.57", "libavutil57"},
     {"libceres.so.3", "libceres3"},
     {"libcrypto.so.3", "libssl3"},
     {"libddsc.so.0debian", "libddsc0debian"},
     {"libdraco.so.7", "libdraco7"},
     {"libfmt.so.9", "libfmt9"},
     {"libgio-2.0.so.0", "libglib2.0-0"},
     {"libglfw.so.3", "libglfw3"},
     {"libglib-2.0.so.0", "libglib2.0-0"},
     {"libgobject-2.0.so.0", "libglib2.0-0"},
     {"libjpeg.so.62", "libjpeg62-turbo"},
     {"libopencv_aruco.so.406", "libopencv-contrib406"},
     {"libopencv_calib3d.so.406", "libopencv-calib3d406"},
     {"libopencv_core.so.406", "libopencv-core406"},
     {"libopencv_imgcodecs.so.406", "libopencv-imgcodecs406"},
     {"libopencv_imgproc.so.406", "libopencv-imgproc406"},
     {"libopencv_videoio.so.406", "libopencv-videoio406"},
     {"libpugixml.so.1", "libpugixml1v5"},
     {"libspdlog.so.1.10", "libspdlog1.10"},
     {"libstb.so.0", "libstb0"},
     {"libturbojpeg.so.0", "libturbojpeg0"}}};

constexpr const char* kFromMakeDeb = " The command takes the files of make deb.";

// Of two cores, measured with eight cameras of 1 MP (docs/measurements/site.md), with a reserve.
constexpr double kCoreSecondsPerMegapixel = 0.003;
// Without the hull, on two thirds of the cores (deploy/costs.toml).
constexpr double kCameraNodeSecondsPerMegapixel = 0.002;

std::string cure_of_libraries(const std::vector<std::string>& libraries) {
    std::vector<std::string> packages;
    for (const std::string& library : libraries) {
        const auto known = std::find_if(kPackages.begin(), kPackages.end(), [&](const auto& one) {
            return library == one.first;
        });
        if (known == kPackages.end())
            return "sudo apt install apt-file && sudo apt-file update && apt-file search " +
                   shell_word(library);
        if (std::find(packages.begin(), packages.end(), known->second) == packages.end())
            packages.emplace_back(known->second);
    }
    return fmt::format("sudo apt install {}", fmt::join(packages, " "));
}

std::string package_of(const std::string& program) {
    if (program == "site_node" || program == "camera_node") return "atrium-site";
    if (program == "world_server") return "atrium-world";
    return program == "viewer" ? "atrium-viewer" : "atrium-tools";
}

// Packages need atrium-common of their own version.
std::string cure_of_programs(const Facts& facts, const std::vector<std::string>& programs) {
    if (!facts.packages.has_programs)
        return fmt::format("deploy/build.sh build && sudo cp -r build/bin/. {}",
                           shell_word(facts.programs.front().path.parent_path().string()));
    std::set<std::string> files{"./packages/atrium-common_*.deb"};
    for (const std::string& program : programs)
        files.insert("./packages/" + package_of(program) + "_*.deb");
    return fmt::format("sudo apt install {}", fmt::join(files, " "));
}

bool is_needed(const Facts& facts, const std::string& name) {
    const Roles& roles = facts.roles;
    const SiteHosts& hosts = facts.wishes.hosts;
    const bool is_one_process = hosts.names.empty();
    return (roles.site && name == "site_node" && (is_one_process || hosts.runs_site_node())) ||
           (roles.site && name == "camera_node" && hosts.has_cameras) ||
           (roles.world && name == "world_server") || (roles.viewer && name == "viewer");
}

void check_versions(const Facts& facts, Findings& findings) {
    std::map<std::string, std::vector<std::string>> by_version;
    for (const Program& program : facts.programs) {
        if (!program.version.empty()) by_version[program.version].push_back(program.name);
    }
    if (by_version.size() < 2) return;
    std::string text;
    std::vector<std::string> programs;
    for (const auto& [version, names] : by_version) {
        text +=
            fmt::format("{}{} ({})", text.empty() ? "" : " and ", version, fmt::join(names, ", "));
        programs.insert(programs.end(), names.begin(), names.end());
    }
    const std::string folder = facts.programs.front().path.parent_path().string();
    findings.push_back(make_finding(
        "versions_mixed",
        fmt::format("The programs in {} are of different versions, {}: they do not understand each "
                    "other.{}",
                    folder,
                    text,
                    facts.packages.has_programs ? kFromMakeDeb : ""),
        cure_of_programs(facts, programs)));
}

std::string digits_of(const std::string& text) {
    std::string digits;
    std::ranges::copy_if(
        text, std::back_inserter(digits), [](char c) { return c >= '0' && c <= '9'; });
    return digits;
}

// The only name that may be meant; else empty. Another number is another host.
std::string name_meant_by(const std::string& written, const std::vector<std::string>& names) {
    std::vector<std::string> meant = config::names_meant_by(written, names);
    std::erase_if(meant,
                  [&](const std::string& name) { return digits_of(name) != digits_of(written); });
    return meant.size() == 1 ? meant.front() : "";
}

// The programs of a site must know the name of their host.
void check_host(const Facts& facts, Findings& findings) {
    const Wishes& wishes = facts.wishes;
    const SiteHosts& hosts = wishes.hosts;
    const bool runs_site = facts.roles.site || facts.roles.camera;
    if (!runs_site || hosts.names.empty() || hosts.is_listed) return;
    // a host may be called by its name or with its domain
    const std::string short_name = hosts.own.substr(0, hosts.own.find('.'));
    const auto alike = std::ranges::find_if(hosts.names, [&](const std::string& name) {
        return !short_name.empty() && name.substr(0, name.find('.')) == short_name;
    });
    const std::string meant =
        alike != hosts.names.end() ? *alike : name_meant_by(short_name, hosts.names);
    findings.push_back(make_finding(
        "host_not_in_file",
        fmt::format("{} is none of the hosts of {}: {}. Name it by --host, also to its programs{}, "
                    "or add a [[host]] with its name to the file.",
                    hosts.own.empty() ? "This host, whose name is unknown,"
                                      : fmt::format("This host, '{}',", hosts.own),
                    wishes.file.string(),
                    fmt::join(hosts.names, ", "),
                    meant.empty() ? " (replace HOST)" : ""),
        fmt::format("atrium doctor {} --host {}",
                    shell_word(wishes.file.string()),
                    meant.empty() ? "HOST" : shell_word(meant))));
}

void check_cores(const Facts& facts, Findings& findings) {
    const Wishes& wishes = facts.wishes;
    const bool has_hull = wishes.hosts.names.empty() || wishes.hosts.runs_site_node();
    double megapixels = 0.0;
    for (const SiteCamera& camera : wishes.cameras) megapixels += camera.megapixels;
    const double per_s = megapixels * wishes.rate_hz;
    const double needed =
        (has_hull ? kCoreSecondsPerMegapixel : kCameraNodeSecondsPerMegapixel) * per_s;
    if (facts.load.cores > 0 && needed > facts.load.cores) {
        const double rate = std::max(1.0, std::floor(wishes.rate_hz * facts.load.cores / needed));
        findings.push_back(make_finding(
            "cores_too_few",
            fmt::format("{:.0f} megapixels/s ({} cameras at {:g} Hz) need about {:.1f} cores; this "
                        "host has {}{}.",
                        per_s,
                        wishes.cameras.size(),
                        wishes.rate_hz,
                        needed,
                        facts.load.cores,
                        same_rate_on_all(wishes)),
            capture_program(facts) + fmt::format(" --capture.rate_hz {:g}", rate)));
    }
}

// Each of RLIMIT_NICE's values allows one niceness below 20.
void check_nice(const Facts& facts, Findings& findings) {
    const int wanted = facts.wishes.nice;
    constexpr int kLevels = 20;
    if (wanted >= 0 || !facts.nice_limit || facts.user.has_sys_nice || facts.packages.runs_file)
        return;
    if (*facts.nice_limit >= static_cast<std::uint64_t>(kLevels - wanted)) return;
    findings.push_back(make_finding(
        "nice_not_permitted",
        fmt::format(
            "process.nice of {} is {}; {} may use {} at the lowest. Log in again afterwards.",
            facts.wishes.file.string(),
            wanted,
            facts.user.name,
            kLevels - static_cast<int>(*facts.nice_limit)),
        write_line(fmt::format("{} - nice {}", facts.user.name, wanted),
                   "/etc/security/limits.d/61-atrium-nice.conf")));
}

}  // namespace

std::string path_of(const Facts& facts, const std::string& name) {
    for (const Program& program : facts.programs) {
        if (program.name == name) return shell_word(program.path.string());
    }
    return name;
}

bool is_there(const Facts& facts, const std::string& name) {
    return std::ranges::any_of(facts.programs, [&](const Program& program) {
        return program.name == name && program.is_there;
    });
}

std::string path_of_any(const Facts& facts) {
    for (const auto& [is_wanted, name] : {std::pair(facts.roles.site, "site_node"),
                                          std::pair(facts.roles.world, "world_server"),
                                          std::pair(facts.roles.viewer, "viewer")}) {
        if (is_wanted && is_there(facts, name)) return path_of(facts, name);
    }
    return path_of(facts, "site_node");
}

Findings check_programs(const Facts& facts) {
    Findings findings;
    for (const Program& program : facts.programs) {
        if (!program.is_there && is_needed(facts, program.name)) {
            const std::string folder = program.path.parent_path().string();
            findings.push_back(
                make_finding("program_missing",
                             fmt::format("The program {} is missing in {}.{}",
                                         program.name,
                                         folder,
                                         facts.packages.has_programs ? kFromMakeDeb : ""),
                             cure_of_programs(facts, {program.name})));
        }
        if (!program.missing_libraries.empty()) {
            findings.push_back(make_finding("library_missing",
                                            fmt::format("{} does not start: missing {}.",
                                                        program.name,
                                                        fmt::join(program.missing_libraries, ", ")),
                                            cure_of_libraries(program.missing_libraries)));
        }
    }
    check_versions(facts, findings);
    return findings;
}

Findings check_site_file(const Facts& facts) {
    Findings findings;
    const Wishes& wishes = facts.wishes;
    check_nice(facts, findings);
    check_host(facts, findings);
    if (wishes.source.empty()) return findings;
    if (!wishes.is_recording_there) {
        findings.push_back(
            make_finding("recording_missing",
                         fmt::format("capture.recording of {} is not there: {}.",
                                     wishes.file.string(),
                                     wishes.recording.string()),
                         fmt::format("grep -n recording {}", shell_word(wishes.file.string()))));
    }
    if (!wishes.rig_problem.empty()) {
        findings.push_back(make_finding(
            "rig_unusable",
            fmt::format("The rig of {} cannot be used: {}{}",
                        wishes.file.string(),
                        wishes.rig_problem,
                        wishes.rig_problem.ends_with('?') ? "" : "."),
            wishes.source == "cameras"
                ? fmt::format("{}atrium calibrate wand --config {} -o {}",
                              facts.packages.runs_file ? "sudo " : "",
                              shell_word(wishes.file.string()),
                              wishes.rig.empty() ? "rig.toml" : shell_word(wishes.rig.string()))
                : fmt::format("grep -n rig {}", shell_word(wishes.file.string()))));
    }
    check_cores(facts, findings);
    return findings;
}

}  // namespace atrium::doctor
