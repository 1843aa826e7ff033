#include "tests/unit/doctor/faults.hpp"

// Faults of one host of a site on several hosts.
namespace atrium::doctor {
namespace {

std::vector<Fault> part_faults() {
    return {{"HostNotInFile",
             "host_not_in_file",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.write("/proc/sys/kernel/hostname", "pc7\n");
             },
             "site.toml: left, right, hull, stairs. Name it by --host, also to its programs "
             "(replace HOST), or add a [[host]]",
             "site.toml --host HOST"},
            {"HostNotInFileByOption",
             "host_not_in_file",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "rihgt";
             },
             "Name it by --host, also to its programs, or add a [[host]]",
             "site.toml --host right"},
            {"HostNotInFileWithAnotherNumber",
             "host_not_in_file",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "right2";
             },
             "(replace HOST)",
             "site.toml --host HOST"},
            {"HostNotInFileWithItsDomain",
             "host_not_in_file",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.write("/proc/sys/kernel/hostname", "right.lab.example\n");
             },
             "This host, 'right.lab.example', is none of the hosts of ",
             "site.toml --host right"},
            {"HostWithoutName",
             "host_not_in_file",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.remove("/proc/sys/kernel/hostname");
             },
             "This host, whose name is unknown, is none of the hosts of ",
             "site.toml --host HOST"},
            {"CameraMissingOnItsHost",
             "camera_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.set_cameras({{"192.168.1.13", "103"}});
             },
             "Camera 'cam1' (serial 101) does not answer; 1 others do",
             "site_node --list-cameras"},
            {"CameraMissingOnTheHostOfTheRest",
             "camera_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "right";
                 host.set_cameras({{"192.168.1.11", "101"}});
             },
             "Camera 'cam2' (serial 102) does not answer; 1 others do",
             "site_node --list-cameras"},
            {"CameraMissingWithCameraNodeOnly",
             "camera_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 std::filesystem::remove(host.programs() / "site_node");
                 host.set_cameras({{"192.168.1.12", "102"}});
             },
             "Camera 'cam1' (serial 101)",
             "camera_node --list-cameras"},
            {"CameraNodeMissing",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 std::filesystem::remove(host.programs() / "camera_node");
             },
             "The program camera_node is missing in ",
             "deploy/build.sh build"},
            {"SiteNodeMissingOnTheModelHost",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "hull";
                 std::filesystem::remove(host.programs() / "site_node");
             },
             "The program site_node is missing in ",
             "deploy/build.sh build"},
            {"SiteNodeMissingOnAHostOfRegions",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "stairs";
                 std::filesystem::remove(host.programs() / "site_node");
             },
             "The program site_node is missing in ",
             "deploy/build.sh build"},
            {"CacheClosedOnTheModelHost",
             "cache_not_writable",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 options.host = "hull";
                 FakeHost::name_cache(options.file, "/srv/kept");
                 host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
             },
             "cannot keep silhouettes",
             "sudo install -d -o lab /srv/kept"}};
}

std::vector<Fault> size_faults() {
    return {{"CamerasOfAHostExceedLink",
             "cameras_exceed_link",
             [](FakeHost& host, Options& options) { options.file = host.write_hosts(125.0); },
             "The cameras at eth1 send 1000 Mbit/s at 125 Hz; its link of 1000 Mbit/s carries 900; "
             "all hosts of the site need the same rate",
             "site.toml --host left --capture.rate_hz 112"},
            {"FewCoresForAHost",
             "cores_too_few",
             [](FakeHost& host, Options& options) {
                 host.write("/sys/devices/system/cpu/online", "0\n");
                 host.in_one_second = [](const FakeHost&) {};
                 host.write("/sys/class/net/eth1/speed", "10000");
                 options.file = host.write_hosts(1000.0);
             },
             "1000 megapixels/s (1 cameras at 1000 Hz) need about 2.0 cores; this host has 1; all "
             "hosts of the site need the same rate",
             "site.toml --host left --capture.rate_hz 500"},
            {"DiskSlowForAHost",
             "disk_slow",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts(80.0);
                 options.recordings = host.folder();
                 host.disk_mb_per_s = 70.0;
             },
             "writes 70 MB/s; a recording wants 80",
             "lsblk"}};
}

}  // namespace

std::vector<Fault> host_faults() {
    std::vector<Fault> faults = part_faults();
    for (Fault& fault : size_faults()) faults.push_back(fault);
    return faults;
}

}  // namespace atrium::doctor
