#include "tools/doctor/facts/collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

namespace atrium::doctor {
namespace {

// The programs that run for long, by the names of their processes, of at most 15 characters;
// `atrium NAME` starts them as atrium-NAME.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kAtriumProcesses{
    {{"site_node", "site_node"},
     {"atrium-site", "site_node"},
     {"camera_node", "camera_node"},
     {"atrium-camera", "camera_node"},
     {"world_server", "world_server"},
     {"atrium-world", "world_server"},
     {"viewer", "viewer"},
     {"atrium-viewer", "viewer"},
     {"demo", "demo"},
     {"atrium-demo", "demo"},
     {"simulated_camer", "simulated_cameras"},
     {"atrium-cameras", "simulated_cameras"}}};
constexpr std::array kTimeDaemons{"chronyd", "ntpd", "systemd-timesyn", "phc2sys"};

struct Process {
    std::string id;
    std::string name;
};

std::vector<Process> processes_of(const System& system) {
    std::vector<Process> processes;
    for (const std::string& id : system.names_in("/proc")) {
        if (!parse_number(id)) continue;
        processes.push_back({id, system.read_word("/proc/" + id + "/comm").value_or("")});
    }
    return processes;
}

template <typename Names>
bool is_one_of(const Names& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// "0-3,5" has five.
int count_list(const std::string& list) {
    std::uint64_t count = 0;
    std::string text = list;
    std::replace(text.begin(), text.end(), ',', ' ');
    for (const std::string& part : words_of(text)) {
        const std::size_t dash = part.find('-');
        const auto first = parse_number(part.substr(0, dash));
        const auto last = dash == std::string::npos ? first : parse_number(part.substr(dash + 1));
        if (first && last && *first <= *last && *last < 65536) count += *last - *first + 1;
    }
    return static_cast<int>(std::min<std::uint64_t>(count, 65536));
}

struct Ticks {
    double total = 0.0;
    double busy = 0.0;
    double atrium = 0.0;
    std::optional<std::uint64_t> throttled;
};

Ticks ticks_now(const System& system, const std::vector<Process>& atrium_processes) {
    Ticks ticks;
    const std::vector<std::string> lines = lines_of(system.read("/proc/stat").value_or(""));
    const std::vector<std::string> words =
        lines.empty() ? std::vector<std::string>{} : words_of(lines.front());
    // user nice system idle iowait irq softirq steal; guests are part of user
    for (std::size_t i = 1; i < std::min<std::size_t>(words.size(), 9); ++i) {
        const auto value = static_cast<double>(parse_number(words[i]).value_or(0));
        ticks.total += value;
        if (i != 4 && i != 5) ticks.busy += value;
    }
    for (const Process& process : atrium_processes) {
        const std::string stat = system.read("/proc/" + process.id + "/stat").value_or("");
        const std::size_t name_end = stat.rfind(')');
        if (name_end == std::string::npos) continue;
        const std::vector<std::string> fields = words_of(stat.substr(name_end + 1));
        // the fields utime and stime, of which the first after the name is number 3
        if (fields.size() < 13) continue;
        for (const std::size_t i : {11, 12})
            ticks.atrium += static_cast<double>(parse_number(fields[i]).value_or(0));
    }
    std::map<std::uint64_t, std::uint64_t> packages;
    const std::string folder = "/sys/devices/system/cpu/";
    for (const std::string& cpu : system.names_in(folder)) {
        const auto count =
            system.read_number(folder + cpu + "/thermal_throttle/package_throttle_count");
        if (!count) continue;
        // each core shows the count of its package
        const auto package =
            system.read_number(folder + cpu + "/topology/physical_package_id").value_or(0);
        packages[package] = std::max(packages[package], *count);
    }
    for (const auto& [package, count] : packages)
        ticks.throttled = ticks.throttled.value_or(0) + count;
    return ticks;
}

void measure_load(const System& system,
                  const std::vector<Process>& atrium_processes,
                  LoadFacts& load) {
    const Ticks before = ticks_now(system, atrium_processes);
    if (!system.let_time_pass()) return;
    const Ticks after = ticks_now(system, atrium_processes);
    const double total = after.total - before.total;
    if (total > 0.0) {
        const double others =
            (after.busy - before.busy) - std::max(0.0, after.atrium - before.atrium);
        load.busy_cores = std::clamp(others / total, 0.0, 1.0) * load.cores;
    }
    if (before.throttled && after.throttled)
        load.num_throttled =
            *after.throttled > *before.throttled ? *after.throttled - *before.throttled : 0;
}

void read_frequency(const System& system, LoadFacts& load) {
    const std::string folder = "/sys/devices/system/cpu/cpu0/cpufreq/";
    load.governor = system.read_word(folder + "scaling_governor").value_or("");
    load.governor_preference =
        system.read_word(folder + "energy_performance_preference").value_or("");
    const auto ghz = [&](const std::string& file) {
        return 1e-6 * static_cast<double>(system.read_number(folder + file).value_or(0));
    };
    load.max_ghz = ghz("cpuinfo_max_freq");
    load.capped_ghz = ghz("scaling_max_freq");
}

// The smallest quota of the control group and those above it.
void read_quota(const System& system, LoadFacts& load) {
    std::string group;
    for (const std::string& line : lines_of(system.read("/proc/self/cgroup").value_or(""))) {
        if (line.rfind("0::/", 0) == 0) group = line.substr(3);
    }
    while (!group.empty()) {
        const auto words =
            words_of(system.read("/sys/fs/cgroup" + group + "/cpu.max").value_or(""));
        const auto quota = words.size() == 2 ? parse_number(words[0]) : std::nullopt;
        const auto period = words.size() == 2 ? parse_number(words[1]) : std::nullopt;
        if (quota && period && *period > 0) {
            const double cores = static_cast<double>(*quota) / static_cast<double>(*period);
            if (!load.quota_cores || cores < *load.quota_cores) {
                load.quota_cores = cores;
                load.quota_group = group;
            }
        }
        group.resize(group.rfind('/'));
    }
}

void read_memory(const System& system, LoadFacts& load) {
    std::map<std::string, std::uint64_t> bytes;
    for (const std::string& line : lines_of(system.read("/proc/meminfo").value_or(""))) {
        const std::vector<std::string> words = words_of(line);
        const auto kib = words.size() == 3 ? parse_number(words[1]) : std::nullopt;
        if (kib && *kib < (std::uint64_t{1} << 50U)) bytes[words[0]] = *kib << 10U;
    }
    if (bytes.contains("MemTotal:")) load.memory_total = bytes["MemTotal:"];
    if (bytes.contains("MemAvailable:")) load.memory_available = bytes["MemAvailable:"];
    if (bytes["SwapTotal:"] > bytes["SwapFree:"])
        load.swap_used = bytes["SwapTotal:"] - bytes["SwapFree:"];
}

// `chronyc -c tracking`: one line of fields. The bound is that of its manual.
std::optional<ChronyFacts> parse_tracking(const std::string& line) {
    constexpr std::size_t kNumFields = 14;
    constexpr double kMs_per_s = 1e3;
    std::vector<std::string> fields;
    std::istringstream stream(line);
    for (std::string field; std::getline(stream, field, ',');) fields.push_back(std::move(field));
    if (fields.size() != kNumFields) return std::nullopt;
    const auto ms = [&](std::size_t field) {
        const char* const end = fields[field].data() + fields[field].size();
        double value = 0.0;
        const auto [last, failure] = std::from_chars(fields[field].data(), end, value);
        return failure == std::errc() && last == end ? kMs_per_s * std::abs(value) : NAN;
    };
    const double offset = ms(4);
    const ChronyFacts facts{fields[1], offset + 0.5 * ms(10) + ms(11), offset + 3.0 * ms(6)};
    if (!std::isfinite(facts.bound_ms) || !std::isfinite(facts.follows_ms)) return std::nullopt;
    return facts;
}

void read_chrony(const System& system, ClockFacts& facts) {
    if (const auto output = system.run({"chronyc", "-n", "-c", "tracking"});
        output && output->exit_code == 0) {
        const auto lines = lines_of(output->text);
        if (lines.size() == 1) facts.chrony = parse_tracking(lines.front());
    }
    std::vector<std::string> files{"/etc/chrony/chrony.conf"};
    const std::string folder = "/etc/chrony/conf.d/";
    for (const std::string& name : system.names_in(folder)) files.push_back(folder + name);
    for (const std::string& file : files) {
        for (const std::string& line : lines_of(system.read(file).value_or(""))) {
            const std::vector<std::string> words = words_of(line);
            facts.serves_others |= !words.empty() && words[0] == "allow";
        }
    }
}

}  // namespace

std::string host_name(const System& system) {
    constexpr std::size_t kMaxName = 63;
    std::string name = system.read_word("/proc/sys/kernel/hostname").value_or("");
    for (char& c : name) {
        const bool is_allowed = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                                (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
        if (!is_allowed) c = '-';
    }
    return name.substr(0, kMaxName);
}

ClockFacts collect_clock(const System& system) {
    ClockFacts facts;
    if (const auto clock = system.clock()) {
        facts.is_synchronised = clock->is_synchronised;
        facts.max_error_ms = clock->max_error_ms;
    }
    for (const Process& process : processes_of(system)) {
        if (!is_one_of(kTimeDaemons, process.name) || is_one_of(facts.daemons, process.name))
            continue;
        // phc2sys beside chronyd may only hand its time over
        const std::string command = system.read("/proc/" + process.id + "/cmdline").value_or("");
        if (command.find("ntpshm") != std::string::npos) continue;
        facts.daemons.push_back(process.name);
    }
    if (is_one_of(facts.daemons, "chronyd")) read_chrony(system, facts);
    return facts;
}

// " --host north" of a program that runs as one host of several; else empty.
std::string host_option(const System& system, const std::string& process) {
    std::string words = system.read("/proc/" + process + "/cmdline").value_or("");
    std::ranges::replace(words, '\0', ' ');
    std::ranges::replace(words, '=', ' ');
    const std::vector<std::string> command = words_of(words);
    for (std::size_t i = 1; i + 1 < command.size(); ++i) {
        if (command[i] == "--host" || command[i] == "--site.host")
            return " --host " + command[i + 1];
    }
    return "";
}

LoadFacts collect_load(const System& system) {
    LoadFacts load;
    load.cores = count_list(system.read("/sys/devices/system/cpu/online").value_or(""));
    std::vector<Process> atrium;
    for (Process& process : processes_of(system)) {
        const auto* const known = std::ranges::find(
            kAtriumProcesses, process.name, [](const auto& one) { return one.first; });
        if (known == kAtriumProcesses.end()) continue;
        load.atrium_programs.push_back(std::string(known->second) +
                                       host_option(system, process.id) + " " + process.id);
        atrium.push_back(std::move(process));
    }
    read_frequency(system, load);
    read_quota(system, load);
    read_memory(system, load);
    measure_load(system, atrium, load);
    return load;
}

GraphicsFacts collect_graphics(const System& system, const std::filesystem::path& programs) {
    GraphicsFacts facts;
    const std::string devices = "/sys/bus/pci/devices/";
    for (const std::string& device : system.names_in(devices)) {
        const std::string folder = devices + device;
        if (system.read_word(folder + "/class").value_or("").rfind("0x03", 0) != 0) continue;
        facts.has_display_card = true;
        if (!system.exists(folder + "/driver"))
            facts.vendor_without_driver = system.read_word(folder + "/vendor").value_or("");
    }
    for (const std::string& name : system.names_in("/dev/dri")) {
        if (name.rfind("renderD", 0) != 0) continue;
        const std::string node = "/dev/dri/" + name;
        facts.nodes.push_back(node);
        if (!system.may_open(node)) facts.closed_nodes.push_back(node);
    }
    const std::filesystem::path probe = programs / "graphics_probe";
    std::error_code ignored;
    if (programs.empty() || !std::filesystem::exists(probe, ignored)) return facts;
    // a process of its own: drivers crash, and EGL may be missing
    if (const auto output = system.run({probe.string()})) {
        facts.is_hardware = output->exit_code == 0;
        const auto lines = lines_of(output->text);
        facts.reason = lines.empty() ? "the driver crashed" : lines.back();
    }
    return facts;
}

}  // namespace atrium::doctor
