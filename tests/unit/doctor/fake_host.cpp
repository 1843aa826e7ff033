#include "tests/unit/doctor/fake_host.hpp"

#include "site_node/capture/camera_discovery.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <system_error>

namespace atrium::doctor {
namespace {

namespace fs = std::filesystem;

void write_card(const FakeHost& host, const std::string& name, const std::string& flags, int mtu) {
    const std::string folder = "/sys/class/net/" + name + "/";
    host.write(folder + "flags", flags);
    host.write(folder + "mtu", std::to_string(mtu));
    host.write(folder + "address", "00:11:22:33:44:0" + name.substr(name.size() - 1));
    host.write(folder + "statistics/rx_packets", "100000000");
    for (const char* counter :
         {"rx_missed_errors", "rx_fifo_errors", "rx_crc_errors", "rx_frame_errors"})
        host.write(folder + "statistics/" + counter, "3");
    host.write("/proc/sys/net/ipv4/conf/" + name + "/rp_filter", "0");
    if (name == "lo") return;
    host.write(folder + "device/vendor", "0x8086");
    host.write(folder + "speed", "1000");
    host.write(folder + "duplex", "full");
}

void write_network(const FakeHost& host) {
    host.write("/proc/sys/net/core/rmem_max", "16777216\n");
    host.write("/proc/sys/net/core/wmem_max", "16777216\n");
    host.write("/proc/sys/net/ipv4/ipfrag_time", "3\n");
    host.write("/proc/sys/net/ipv4/ipfrag_high_thresh", "134217728\n");
    host.write("/proc/sys/net/ipv4/conf/all/rp_filter", "0\n");
    host.write(
        "/proc/net/route",
        "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n"
        "eth0\t00000000\t0100000A\t0003\t0\t0\t0\t00000000\t0\t0\t0\n"
        "eth0\t0000000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n"
        "eth1\t0001A8C0\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0\n");
    write_card(host, "lo", "0x9", 65536);
    write_card(host, "eth0", "0x1003", 1500);
    write_card(host, "eth1", "0x1003", 9000);
    host.write("/etc/ufw/ufw.conf", "ENABLED=no\n");
}

void write_machine(const FakeHost& host) {
    host.write("/proc/sys/kernel/hostname", "left\n");
    host.write("/proc/stat", processor_ticks(1000, 9000));
    host.write("/proc/meminfo",
               "MemTotal:       32000000 kB\nMemFree: 20000000 kB\nMemAvailable:   28000000 kB\n"
               "SwapTotal: 8000000 kB\nSwapFree: 8000000 kB\nHugePages_Total: 0\n");
    host.write("/proc/self/limits",
               "Limit                     Soft Limit           Hard Limit           Units     \n"
               "Max nice priority         0                    0                    \n"
               "Max realtime priority     20                   20                   \n");
    host.write("/proc/self/cgroup", "0::/user.slice/session.scope\n");
    host.write("/sys/fs/cgroup/user.slice/cpu.max", "max 100000\n");
    host.write("/sys/devices/system/cpu/online", "0-7\n");
    const std::string cpu = "/sys/devices/system/cpu/cpu0/";
    host.write(cpu + "cpufreq/scaling_governor", "performance\n");
    host.write(cpu + "cpufreq/cpuinfo_max_freq", "4200000\n");
    host.write(cpu + "cpufreq/scaling_max_freq", "4200000\n");
    host.write(cpu + "thermal_throttle/package_throttle_count", "12\n");
    host.write("/sys/bus/pci/devices/0000:01:00.0/class", "0x030000\n");
    host.write("/sys/bus/pci/devices/0000:01:00.0/vendor", "0x1002\n");
    host.write("/sys/bus/pci/devices/0000:01:00.0/driver/module", "amdgpu\n");
    host.write("/dev/dri/renderD128", "", 0666);
    host.add_usb_camera("2-1", 3);
    host.write("/sys/module/usbcore/parameters/usbfs_memory_mb", "1000\n");
}

}  // namespace

std::string processor_ticks(int user, int idle) {
    return fmt::format("cpu  {} 0 0 {} 0 0 0 0 0 0\ncpu0 1 2 3 4 5 6 7 8 9 10\n", user, idle);
}

std::string tracking(double offset_s,
                     double root_delay_s,
                     double root_dispersion_s,
                     double rms_offset_s,
                     const std::string& source) {
    return fmt::format(
        "CB007105,{},3,1795844835.643459106,{:.9f},0.000000091,{:.9f},-0.011,0.002,0.089,{:.9f},"
        "{:.9f},64.2,Normal\n",
        source,
        offset_s,
        rms_offset_s,
        root_delay_s,
        root_dispersion_s);
}

std::string ring_of(int now, int largest) {
    const char* const part =
        "{}:\nRX:\t\t{}\nRX Mini:\tn/a\nRX Jumbo:\tn/a\nTX:\t\t{}\nTX push buff len:\tn/a\n";
    return "Ring parameters for eth1:\n" +
           fmt::format(fmt::runtime(part), "Pre-set maximums", largest, largest) +
           fmt::format(fmt::runtime(part), "Current hardware settings", now, now);
}

std::string camera_table_of(const std::vector<std::pair<std::string, std::string>>& cameras) {
    std::vector<capture::FoundCamera> found;
    for (const auto& [address, serial] : cameras)
        found.push_back({"Allied Vision", "Mako G-319", serial, address, "GigEVision"});
    return capture::camera_table(found);
}

FakeHost::FakeHost(const fs::path& folder)
    : System(folder / "root"),
      who{.name = "lab", .is_root = false, .groups = {60'000}, .id = 60'000},
      folder_(folder),
      programs_(folder / "bin") {
    fs::remove_all(folder);
    fs::create_directories(programs());
    write_network(*this);
    write_machine(*this);
    add_process(700, "chronyd", "/usr/sbin/chronyd");
    add_process(701, "bash");
    for (const char* name :
         {"site_node", "camera_node", "world_server", "viewer", "monitor", "graphics_probe"}) {
        std::ofstream(programs() / name) << "";
        fs::permissions(programs() / name, fs::perms::owner_all);
        outputs[std::string(name) + " --version"] = {0, std::string(name) + " 0.1.0 (Atrium)\n"};
    }
    outputs["graphics_probe"] = {0, "hardware\n"};
    set_cameras({{"192.168.1.11", "101"}, {"192.168.1.12", "102"}});
    outputs["nft -j list ruleset"] = {0, "{\"nftables\": [{\"metainfo\": {}}]}\n"};
    outputs["iptables-save"] = {127, ""};
    outputs["ethtool -g eth1"] = {0, ring_of(256, 2048)};
    addresses = {{"lo", 0x7F000001, 8}, {"eth0", 0x0A000002, 24}, {"eth1", 0xC0A80101, 24}};
    in_one_second = [](const FakeHost& host) {
        host.write("/proc/stat", processor_ticks(1010, 9790));
    };
}

FakeHost::~FakeHost() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void FakeHost::write(const std::string& file, const std::string& content, mode_t mode) const {
    fs::create_directories(at(file).parent_path());
    std::ofstream(at(file), std::ios::binary) << content;
    chmod(at(file).c_str(), mode);
}

void FakeHost::remove(const std::string& file) const { fs::remove_all(at(file)); }

void FakeHost::add_process(int id, const std::string& name, const std::string& command) const {
    const std::string folder = fmt::format("/proc/{}/", id);
    write(folder + "comm", name + "\n");
    write(folder + "cmdline", command);
    write(folder + "stat",
          fmt::format("{} ({}) S 1 1 1 0 -1 0 0 0 0 0 500 20 0 0 20 0\n", id, name));
}

fs::path FakeHost::write_beside(const std::string& name, const std::string& content) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
}

fs::path FakeHost::write_site(double rate_hz, const std::string& bus) const {
    std::string rig = fmt::format("units = \"m\"\nrate_hz = {:.1f}\n", rate_hz);
    std::string site = fmt::format(
        "[site]\nname = \"lab\"\n[bus]\nnetwork = \"{}\"\n[capture]\nsource = \"cameras\"\n"
        "rig = \"rig.toml\"\ntrigger = \"external\"\n",
        bus);
    for (const int i : {1, 2}) {
        rig += fmt::format(
            "[[camera]]\nname = \"cam{}\"\nwidth = 1000\nheight = 1000\nfx = 900\nfy = 900\n"
            "cx = 500\ncy = 500\nrotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]\ntranslation = [{}, 0, "
            "3]\n",
            i,
            i);
        site += fmt::format("[[capture.camera]]\nname = \"cam{0}\"\nserial = \"10{0}\"\n", i);
    }
    write_beside("rig.toml", rig);
    return write_beside("site.toml", site);
}

fs::path FakeHost::write_hosts(double rate_hz) const {
    std::ofstream(write_site(rate_hz), std::ios::app)
        << "[[host]]\nname = \"left\"\ncameras = [\"cam1\"]\n"
           "[[host]]\nname = \"right\"\ncameras = \"auto\"\n"
           "[[host]]\nname = \"hull\"\nmodel = true\n"
           "[[host]]\nname = \"stairs\"\nregions = [\"stairs\"]\n";
    return folder_ / "site.toml";
}

void FakeHost::name_cache(const fs::path& file, const std::string& folder) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::string content = text.str();
    const std::string table = "[site]\n";
    content.insert(content.find(table) + table.size(), "kept_silhouettes = \"" + folder + "\"\n");
    std::ofstream(file) << content;
}

fs::path FakeHost::install() {
    const fs::path to = at("/usr/lib/atrium/bin");
    fs::create_directories(to.parent_path());
    fs::rename(programs_, to);
    programs_ = to;
    for (const char* unit : {"atrium-site@.service", "atrium-world.service"})
        write(std::string("/lib/systemd/system/") + unit, "");
    write("/lib/udev/rules.d/60-atrium-cameras.rules", "");
    write("/usr/share/doc/atrium-common/copyright", "");
    write("/etc/group",
          "root:x:0:\nplugdev:x:46:lab\natrium:x:" + std::to_string(getegid()) + ":\n");
    write_site();
    fs::create_directories(at("/etc/atrium/sites"));
    for (const char* file : {"rig.toml", "site.toml"})
        fs::copy_file(folder_ / file, at("/etc/atrium/sites") / file);
    return at("/etc/atrium/sites/site.toml");
}

void FakeHost::add_usb_camera(const std::string& port, int number) const {
    const std::string usb = "/sys/bus/usb/devices/" + port;
    write(usb + ":1.0/bInterfaceClass", "ef\n");
    write(usb + ":1.0/bInterfaceSubClass", "05\n");
    write(usb + "/busnum", "2\n");
    write(usb + "/devnum", std::to_string(number) + "\n");
    write(usb + "/speed", "5000\n");
    write(fmt::format("/dev/bus/usb/002/{:03}", number), "", 0666);
}

void FakeHost::set_cameras(const std::vector<std::pair<std::string, std::string>>& cameras) {
    for (const char* program : {"site_node", "camera_node"})
        outputs[std::string(program) + " --list-cameras"] = {0, camera_table_of(cameras)};
}

std::optional<std::uint64_t> FakeHost::file_capabilities(const fs::path& file) const {
    const auto own = capabilities_of.find(file.filename());
    return own == capabilities_of.end() ? capabilities : own->second;
}

Expected<Report> FakeHost::examine_json(Options options) const {
    options.programs = programs();
    options.is_json = true;
    return examine(options, *this, {});
}

std::optional<System::Output> FakeHost::run(const std::vector<std::string>& command) const {
    std::string line = fs::path(command.front()).filename();
    for (std::size_t i = 1; i < command.size(); ++i) line += " " + command[i];
    const auto known = outputs.find(line);
    return known == outputs.end() ? Output{127, ""} : known->second;
}

bool FakeHost::let_time_pass() const {
    in_one_second(*this);
    return true;
}

std::string FakeHost::variable(const std::string& name) const {
    const auto known = variables.find(name);
    return known == variables.end() ? "" : known->second;
}

}  // namespace atrium::doctor
