#include "tests/unit/doctor/faults.hpp"

namespace atrium::doctor {
namespace {

const std::string kFrequency = "/sys/devices/system/cpu/cpu0/cpufreq/";

// As if chronyd had not been started.
void stop_chronyd(FakeHost& host) { host.remove("/proc/700"); }

std::vector<Fault> clock_faults() {
    return {{"NoTimeDaemon",
             "no_time_daemon",
             [](FakeHost& host, Options&) {
                 stop_chronyd(host);
                 host.kernel_clock.is_synchronised = false;
             },
             "No program keeps the clock right",
             "sudo apt install chrony"},
            {"ClockUnsynchronised",
             "clock_unsynchronised",
             [](FakeHost& host, Options&) { host.kernel_clock.is_synchronised = false; },
             "although chrony runs",
             "chronyc sources && sudo chronyc makestep"},
            {"TimesyncdUnsynchronised",
             "clock_unsynchronised",
             [](FakeHost& host, Options&) {
                 stop_chronyd(host);
                 host.add_process(710, "systemd-timesyn");
                 host.kernel_clock.is_synchronised = false;
             },
             "although systemd-timesyncd runs",
             "sudo systemctl restart systemd-timesyncd"},
            {"ClockErrorLarge",
             "clock_error_large",
             [](FakeHost& host, Options&) {
                 host.outputs["chronyc -n -c tracking"] = {0, tracking(-0.0012, 0.09, 0.005)};
             },
             "wrong by 51.2 ms; a latency between hosts wants 50 ms",
             "/etc/chrony/sources.d/atrium.sources && sudo chronyc reload sources"},
            {"ClockErrorLargeByTheKernel",
             "clock_error_large",
             [](FakeHost& host, Options&) { host.kernel_clock.max_error_ms = 1100.0; },
             "wrong by 1.1e+03 ms; a latency between hosts wants 50 ms",
             "/etc/chrony/sources.d/atrium.sources && sudo chronyc reload sources"},
            {"ClockErrorLargeForTriggers",
             "clock_error_large",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.outputs["chronyc -n -c tracking"] = {0, tracking(0.0001, 0.004, 0.0, 0.002)};
             },
             "wrong by 2.1 ms; a host of a site on several hosts, whose cameras trigger by it, "
             "wants 2 ms",
             "/etc/chrony/sources.d/atrium.sources && sudo chronyc reload sources"},
            {"ClockDiffersFromTheServerInTheLan",
             "clock_error_large",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.outputs["chronyc -n -c tracking"] = {
                     0, tracking(0.0001, 0.0, 0.0, 0.001, "10.0.0.7")};
             },
             "wrong by 3.1 ms; a host of a site on several hosts",
             "/etc/chrony/sources.d/atrium.sources && sudo chronyc reload sources"},
            {"ClockErrorLargeForTriggersByTheKernel",
             "clock_error_large",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.kernel_clock.max_error_ms = 2.3;
             },
             "wrong by 2.3 ms; a host of a site on several hosts",
             "/etc/chrony/sources.d/atrium.sources && sudo chronyc reload sources"},
            {"TwoTimeDaemons",
             "two_time_daemons",
             [](FakeHost& host, Options&) { host.add_process(710, "systemd-timesyn"); },
             "chronyd and systemd-timesyn set the clock at the same time",
             "sudo systemctl disable --now systemd-timesyncd"},
            {"TwoTimeDaemonsWithoutChrony",
             "two_time_daemons",
             [](FakeHost& host, Options&) {
                 stop_chronyd(host);
                 host.add_process(711, "ntpd");
                 host.add_process(712, "systemd-timesyn");
             },
             "ntpd and systemd-timesyn set the clock at the same time",
             "sudo systemctl disable --now systemd-timesyncd"}};
}

std::vector<Fault> graphics_faults() {
    const auto with_display = [](FakeHost& host) {
        host.remove("/dev/dri");
        host.variables["DISPLAY"] = ":0";
    };
    return {{"NoGpu",
             "no_gpu",
             [with_display](FakeHost& host, Options&) { with_display(host); },
             "no GPU (no /dev/dri/renderD*)",
             "/bin/viewer --view.width 640"},
            {"NvidiaWithoutDriver",
             "gpu_without_driver",
             [with_display](FakeHost& host, Options&) {
                 with_display(host);
                 host.remove("/sys/bus/pci/devices/0000:01:00.0/driver");
                 host.write("/sys/bus/pci/devices/0000:01:00.0/vendor", "0x10de");
             },
             "Debian has it in non-free, which /etc/apt/sources.list must name",
             "sudo apt install nvidia-driver"},
            {"GpuWithoutDriver",
             "gpu_without_driver",
             [with_display](FakeHost& host, Options&) {
                 with_display(host);
                 host.remove("/sys/bus/pci/devices/0000:01:00.0/driver");
             },
             "per second. Debian has it in non-free-firmware, which",
             "sudo apt install firmware-amd-graphics"},
            {"GpuClosed",
             "gpu_not_permitted",
             [](FakeHost& host, Options&) { host.write("/dev/dri/renderD128", "", 0660); },
             "lab may not open the GPU (/dev/dri/renderD128)",
             "sudo usermod -aG render,video lab"},
            {"NoEglDriver",
             "egl_driver_missing",
             [](FakeHost& host, Options&) {
                 host.outputs["graphics_probe"] = {
                     3, "EGL: no driver for rendering without a display; install libegl-mesa0\n"};
             },
             "no EGL driver",
             "sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri"},
            {"NoEglLibrary",
             "egl_driver_missing",
             [](FakeHost& host, Options&) {
                 host.outputs["graphics_probe"] = {
                     127,
                     "graphics_probe: error while loading shared libraries: libEGL.so.1: cannot "
                     "open shared object file\n"};
             },
             "libEGL.so.1",
             "sudo apt install libegl1"},
            {"SoftwareRenderer",
             "renderer_is_software",
             [](FakeHost& host, Options&) {
                 host.outputs["graphics_probe"] = {
                     3, "EGL: a device has no hardware driver (renderer: llvmpipe)\n"};
             },
             "renderer: llvmpipe",
             "libgl1-mesa-dri"}};
}

std::vector<Fault> load_faults() {
    return {
        {"BusyProcessor",
         "cpu_busy",
         [](FakeHost& host, Options&) {
             host.in_one_second = [](const FakeHost& later) {
                 later.write("/proc/stat", processor_ticks(1400, 9400));
             };
         },
         "Other programs use 4.0 of 8 cores",
         "top -b -n 1 -o %CPU"},
        {"PowersaveGovernor",
         "cpu_powersave",
         [](FakeHost& host, Options&) {
             host.write(kFrequency + "scaling_governor", "powersave\n");
         },
         "scaling_governor is powersave",
         "echo performance | sudo tee "
         "/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor",
         "/etc/tmpfiles.d/atrium-scaling_governor.conf"},
        {"PowersavePreference",
         "cpu_powersave",
         [](FakeHost& host, Options&) {
             host.write(kFrequency + "scaling_governor", "powersave\n");
             host.write(kFrequency + "energy_performance_preference", "balance_power\n");
         },
         "energy_performance_preference is balance_power",
         "cpufreq/energy_performance_preference",
         "/etc/tmpfiles.d/"},
        {"CappedProcessor",
         "cpu_capped",
         [](FakeHost& host, Options&) { host.write(kFrequency + "scaling_max_freq", "1400000\n"); },
         "limited to 1.4 GHz; it can do 4.2 GHz",
         "echo 4200000 | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_max_freq",
         "/etc/tmpfiles.d/"},
        {"HotProcessor",
         "cpu_throttled",
         [](FakeHost& host, Options&) {
             // two packages, the first of two cores
             const auto set = [](const FakeHost& now, int first, int second) {
                 for (const int core : {0, 1, 2}) {
                     const std::string cpu = "/sys/devices/system/cpu/cpu" + std::to_string(core);
                     now.write(cpu + "/topology/physical_package_id", core < 2 ? "0" : "1");
                     now.write(cpu + "/thermal_throttle/package_throttle_count",
                               std::to_string(core < 2 ? first : second));
                 }
             };
             set(host, 12, 5);
             host.in_one_second = [set](const FakeHost& later) { set(later, 15, 6); };
         },
         "slowed down 4 times in one second",
         "thermal_zone"},
        {"ProcessorQuota",
         "cpu_quota",
         [](FakeHost& host, Options&) {
             host.write("/proc/self/cgroup", "0::/system.slice/atrium-site.service\n");
             host.write("/sys/fs/cgroup/system.slice/atrium-site.service/cpu.max",
                        "150000 100000\n");
         },
         "may use 1.5 of 8 cores",
         "sudo systemctl set-property atrium-site.service CPUQuota="},
        {"LittleMemory",
         "memory_low",
         [](FakeHost& host, Options&) {
             host.write("/proc/meminfo", "MemTotal: 32000000 kB\nMemAvailable: 400000 kB\n");
         },
         "391 MiB of memory are free",
         "ps -eo pid,rss,comm --sort=-rss"},
        {"SwapUsed",
         "swap_used",
         [](FakeHost& host, Options&) {
             host.write("/proc/meminfo",
                        "MemTotal: 32000000 kB\nMemAvailable: 9000000 kB\n"
                        "SwapTotal: 8000000 kB\nSwapFree: 4000000 kB\n");
         },
         "3.81 GiB of memory are swapped out",
         "sudo swapoff -a; sudo swapon -a"},
        {"MoreSwapUsedThanFreeMemory",
         "swap_used",
         [](FakeHost& host, Options&) {
             host.write("/proc/meminfo",
                        "MemTotal: 32000000 kB\nMemAvailable: 3000000 kB\n"
                        "SwapTotal: 8000000 kB\nSwapFree: 4000000 kB\n");
         },
         "costs pictures. End the programs that the command lists.",
         "ps -eo pid,rss,comm --sort=-rss"},
        {"TwoSites",
         "program_runs_twice",
         [](FakeHost& host, Options&) {
             host.add_process(801, "site_node");
             host.add_process(802, "site_node");
         },
         "site_node runs 2 times on this host (processes 801, 802)",
         "kill 801"},
        {"TwoCameraNodes",
         "program_runs_twice",
         [](FakeHost& host, Options&) {
             host.add_process(801, "camera_node");
             host.add_process(802, "atrium-camera");
         },
         "camera_node runs 2 times on this host (processes 801, 802)",
         "kill 801"},
        {"TwoSimulatedCameras",
         "program_runs_twice",
         [](FakeHost& host, Options&) {
             host.add_process(801, "simulated_camer");
             host.add_process(802, "atrium-cameras");
         },
         "simulated_cameras runs 2 times",
         "kill 801"}};
}

}  // namespace

std::vector<Fault> machine_faults() {
    std::vector<Fault> faults = clock_faults();
    for (std::vector<Fault> more : {graphics_faults(), load_faults()})
        std::move(more.begin(), more.end(), std::back_inserter(faults));
    return faults;
}

std::vector<Fault> all_faults() {
    std::vector<Fault> faults;
    for (std::vector<Fault> more :
         {network_faults(), camera_faults(), machine_faults(), file_faults(), host_faults()})
        std::move(more.begin(), more.end(), std::back_inserter(faults));
    return faults;
}

}  // namespace atrium::doctor
