#include "tools/doctor/facts/collect.hpp"

#include <linux/capability.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace atrium::doctor {
namespace {

constexpr std::array kPrograms{"site_node",
                               "camera_node",
                               "world_server",
                               "viewer",
                               "calibrate",
                               "demo",
                               "doctor",
                               "keys",
                               "monitor",
                               "plan",
                               "simulated_cameras",
                               "site_control",
                               "visual_hull"};

// "libEGL.so.1 => not found" in the output of ldd.
std::vector<std::string> missing_libraries(const std::string& ldd) {
    std::vector<std::string> missing;
    for (const std::string& line : lines_of(ldd)) {
        const std::vector<std::string> words = words_of(line);
        if (words.size() != 4 || words[1] != "=>" || words[2] != "not") continue;
        if (std::find(missing.begin(), missing.end(), words[0]) == missing.end())
            missing.push_back(words[0]);
    }
    return missing;
}

Program examine_program(const System& system, const std::filesystem::path& path) {
    Program program{path.filename().string(), path, access(path.c_str(), X_OK) == 0, "", {}, {}};
    if (!program.is_there) return program;
    const auto output = system.run({path.string(), "--version"});
    if (!output) return program;
    const std::vector<std::string> words = words_of(output->text);
    if (output->exit_code == 0 && words.size() >= 2) {
        program.version = words[1];  // "site_node 0.1.0 (Atrium)"
    } else if (const auto ldd = system.run({"ldd", path.string()})) {
        program.missing_libraries = missing_libraries(ldd->text);
    }
    if (const auto capabilities = system.file_capabilities(path))
        program.has_net_raw = (*capabilities >> CAP_NET_RAW & 1U) != 0;
    return program;
}

std::vector<UsbCamera> usb_cameras(const System& system, const std::optional<User>& opens) {
    std::vector<UsbCamera> cameras;
    const std::string devices = "/sys/bus/usb/devices/";
    std::string last;
    for (const std::string& interface : system.names_in(devices)) {
        const std::size_t colon = interface.find(':');
        // USB3 Vision: class miscellaneous, subclass 5
        if (colon == std::string::npos ||
            system.read_word(devices + interface + "/bInterfaceClass") != "ef" ||
            system.read_word(devices + interface + "/bInterfaceSubClass") != "05") {
            continue;
        }
        const std::string device = devices + interface.substr(0, colon);
        if (device == last) continue;
        last = device;
        const auto bus = system.read_number(device + "/busnum");
        const auto number = system.read_number(device + "/devnum");
        if (!bus || !number || *bus > 999 || *number > 999) continue;
        UsbCamera camera;
        const auto three_digits = [](std::uint64_t value) {
            return std::to_string(1000 + value).substr(1);
        };
        camera.node = "/dev/bus/usb/" + three_digits(*bus) + "/" + three_digits(*number);
        camera.speed_mbit = static_cast<int>(
            std::min<std::uint64_t>(1'000'000, system.read_number(device + "/speed").value_or(0)));
        const auto status = system.status_of(camera.node);
        camera.is_permitted =
            opens ? !status || may_use(*status, *opens) : system.may_open(camera.node);
        cameras.push_back(std::move(camera));
    }
    return cameras;
}

}  // namespace

std::vector<Program> collect_programs(const System& system, const std::filesystem::path& folder) {
    std::vector<Program> programs;
    if (folder.empty()) return programs;
    for (const char* name : kPrograms) programs.push_back(examine_program(system, folder / name));
    return programs;
}

std::vector<FoundCamera> parse_camera_table(const std::string& table) {
    constexpr std::array kColumns{"vendor", "model", "serial", "address", "protocol"};
    std::vector<FoundCamera> cameras;
    std::array<std::size_t, kColumns.size()> begins{};
    bool has_head = false;
    for (const std::string& line : lines_of(table)) {
        if (!has_head) {
            std::size_t from = 0;
            has_head = line.rfind(kColumns[0], 0) == 0;
            for (std::size_t i = 0; i < kColumns.size() && has_head; ++i) {
                begins[i] = line.find(kColumns[i], from);
                has_head = begins[i] != std::string::npos;
                from = begins[i] + 1;
            }
            continue;
        }
        if (line.size() <= begins.back()) continue;
        const auto cell = [&](std::size_t i) {
            const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : line.size();
            const std::string text = line.substr(begins[i], end - begins[i]);
            return text.substr(0, text.find_last_not_of(' ') + 1);
        };
        cameras.push_back({cell(0) + " " + cell(1), cell(2), cell(3), cell(4) == "GigEVision"});
    }
    return cameras;
}

CameraFacts collect_cameras(const System& system,
                            const std::vector<Program>& programs,
                            const std::optional<User>& opens) {
    CameraFacts facts;
    facts.usb = usb_cameras(system, opens);
    facts.usb_memory_mb = system.read_number("/sys/module/usbcore/parameters/usbfs_memory_mb");
    constexpr int kNoneAnswers = 3;
    for (const Program& program : programs) {
        const bool lists = program.name == "site_node" || program.name == "camera_node";
        if (!lists || program.version.empty() || facts.found) continue;
        const auto output = system.run({program.path.string(), "--list-cameras"});
        if (output && (output->exit_code == 0 || output->exit_code == kNoneAnswers))
            facts.found = parse_camera_table(output->text);
    }
    return facts;
}

}  // namespace atrium::doctor
