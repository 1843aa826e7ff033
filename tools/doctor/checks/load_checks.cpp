#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace atrium::doctor {
namespace {

constexpr double kBusyShare = 0.25;   // of all cores, by other programs
constexpr double kCappedShare = 0.9;  // of the processor's highest frequency
constexpr std::uint64_t kMinMemory = std::uint64_t{1} << 30U;
constexpr double kSwapShare = 0.05;  // of the memory
constexpr const char* kLargestPrograms = "ps -eo pid,rss,comm --sort=-rss | head";
constexpr const char* kFrequency = "/sys/devices/system/cpu/cpu*/cpufreq/";

// A command line that writes `value` to a file of each processor core; the shell expands the '*'.
std::string write_to_cores(const std::string& value, const std::string& file) {
    return fmt::format("echo {} | sudo tee {}{}", value, kFrequency, file);
}

std::string keep_on_cores(const std::string& value, const std::string& file) {
    return write_line(fmt::format("w {}{} - - - - {}", kFrequency, file, value),
                      fmt::format("/etc/tmpfiles.d/atrium-{}.conf", file));
}

void check_frequency(const LoadFacts& load, Findings& findings) {
    const std::string& preference = load.governor_preference;
    // with a preference, "powersave" only means that the processor decides itself
    if (preference == "power" || preference == "balance_power") {
        const std::string file = "energy_performance_preference";
        findings.push_back(make_finding(
            "cpu_powersave",
            fmt::format("The processor saves power (energy_performance_preference is {}; wanted is "
                        "performance): each picture takes longer.",
                        preference),
            write_to_cores("performance", file),
            keep_on_cores("performance", file)));
    } else if (load.governor == "powersave" && preference.empty()) {
        const std::string file = "scaling_governor";
        findings.push_back(make_finding(
            "cpu_powersave",
            "The processor runs at its lowest frequency (scaling_governor is powersave; wanted is "
            "performance).",
            write_to_cores("performance", file),
            keep_on_cores("performance", file)));
    }
    if (load.max_ghz > 0.0 && load.capped_ghz > 0.0 &&
        load.capped_ghz < kCappedShare * load.max_ghz) {
        const std::string file = "scaling_max_freq";
        const std::string khz = fmt::format("{:.0f}", 1e6 * load.max_ghz);
        findings.push_back(make_finding(
            "cpu_capped",
            fmt::format("The processor is limited to {:.2g} GHz; it can do {:.2g} GHz.",
                        load.capped_ghz,
                        load.max_ghz),
            write_to_cores(khz, file),
            keep_on_cores(khz, file)));
    }
    if (load.num_throttled.value_or(0) > 0) {
        findings.push_back(make_finding(
            "cpu_throttled",
            fmt::format("The processor is too hot: it was slowed down {} times in one second; free "
                        "its fans and air holes.",
                        *load.num_throttled),
            "grep . /sys/class/thermal/thermal_zone*/temp"));
    }
}

void check_memory(const LoadFacts& load, Findings& findings) {
    if (load.memory_available && *load.memory_available < kMinMemory) {
        findings.push_back(make_finding(
            "memory_low",
            fmt::format("{} of memory are free; a site or a viewer wants {}: end the programs that "
                        "the command lists.",
                        size_text(*load.memory_available),
                        size_text(kMinMemory)),
            kLargestPrograms));
    }
    const bool has_room = load.memory_available.value_or(0) > load.swap_used;
    if (load.memory_total && static_cast<double>(load.swap_used) >
                                 kSwapShare * static_cast<double>(*load.memory_total)) {
        findings.push_back(make_finding(
            "swap_used",
            fmt::format("{} of memory are swapped out to disk; their next use costs pictures.{}",
                        size_text(load.swap_used),
                        has_room ? "" : " End the programs that the command lists."),
            has_room ? "sudo swapoff -a; sudo swapon -a"  // swap is on again in any case
                     : kLargestPrograms));
    }
}

// Two sites or two viewers on one host take each other's cores. Programs with different --host are
// meant to be beside each other.
void check_twice(const LoadFacts& load, Findings& findings) {
    std::map<std::string, std::vector<std::string>> ids;
    for (const std::string& program : load.atrium_programs) {
        const std::size_t space = program.rfind(' ');
        if (space != std::string::npos)
            ids[program.substr(0, space)].push_back(program.substr(space + 1));
    }
    for (const auto& [name, list] : ids) {
        if (list.size() < 2) continue;
        findings.push_back(make_finding(
            "program_runs_twice",
            fmt::format("{} runs {} times on this host (processes {}): they share its cores; end "
                        "those that are not wanted.",
                        name,
                        list.size(),
                        fmt::join(list, ", ")),
            fmt::format("kill {}", list.front())));
    }
}

}  // namespace

Findings check_load(const Facts& facts) {
    Findings findings;
    const LoadFacts& load = facts.load;
    if (load.busy_cores && load.cores > 0 && *load.busy_cores > kBusyShare * load.cores) {
        findings.push_back(make_finding(
            "cpu_busy",
            fmt::format(
                "Other programs use {:.1f} of {} cores; wanted is less than {:.1f}: end the "
                "first that the command lists.",
                *load.busy_cores,
                load.cores,
                kBusyShare * load.cores),
            "top -b -n 1 -o %CPU | head -n 15"));
    }
    check_frequency(load, findings);
    if (load.quota_cores && load.cores > 0 && *load.quota_cores < load.cores) {
        const std::string unit = load.quota_group.substr(load.quota_group.rfind('/') + 1);
        const bool is_unit =
            unit.ends_with(".service") || unit.ends_with(".slice") || unit.ends_with(".scope");
        findings.push_back(make_finding(
            "cpu_quota",
            fmt::format("The control group {} may use {:.2g} of {} cores, then its programs stand "
                        "still for some milliseconds.",
                        load.quota_group,
                        *load.quota_cores,
                        load.cores),
            is_unit ? fmt::format("sudo systemctl set-property {} CPUQuota=", shell_word(unit))
                    : fmt::format("echo max | sudo tee {}",
                                  shell_word("/sys/fs/cgroup" + load.quota_group + "/cpu.max"))));
    }
    check_memory(load, findings);
    check_twice(load, findings);
    return findings;
}

}  // namespace atrium::doctor
