#include "tests/unit/doctor/faults.hpp"

namespace atrium::doctor {
namespace {

std::vector<Fault> presence_faults() {
    return {{"NoCamera",
             "no_camera",
             [](FakeHost& host, Options&) {
                 host.outputs["site_node --list-cameras"] = {3, "no camera answers\n"};
             },
             "No camera answers",
             "sudo ip address add 169.254.0.1/16 dev eth1"},
            {"NoCameraAndTheCardIsDown",
             "no_camera",
             [](FakeHost& host, Options&) {
                 host.outputs["site_node --list-cameras"] = {3, "no camera answers\n"};
                 host.write("/sys/class/net/eth1/flags", "0x1002");
             },
             "No camera answers",
             "sudo ip link set dev eth1 up && sudo ip address add 169.254.0.1/16 dev eth1 && /"},
            {"NoCameraWithAnAddress",
             "no_camera",
             [](FakeHost& host, Options&) {
                 host.outputs["site_node --list-cameras"] = {3, "no camera answers\n"};
                 host.write("/sys/class/net/eth1/flags", "0x1002");
                 host.addresses.push_back({"eth1", 0xA9FE0001, 16});
             },
             "No camera answers",
             "sudo ip link set dev eth1 up && /"},
            {"NoCameraBesideVirtualCards",
             "no_camera",
             [](FakeHost& host, Options&) {
                 host.outputs["site_node --list-cameras"] = {3, "no camera answers\n"};
                 host.remove("/sys/class/net/eth1");
                 host.addresses.pop_back();
                 host.write("/sys/class/net/docker0/flags", "0x1003");
                 host.write("/sys/class/net/wlan0/flags", "0x1003");
                 host.write("/sys/class/net/wlan0/device/vendor", "0x8086");
                 host.write("/sys/class/net/wlan0/phy80211/index", "0");
             },
             "No camera answers",
             "sudo ip address add 169.254.0.1/16 dev eth0 && /"},
            {"CameraMissing",
             "camera_missing",
             [](FakeHost& host, Options& options) {
                 host.set_cameras({{"192.168.1.11", "101"}});
                 options.file = host.write_site();
             },
             "Camera 'cam2' (serial 102) does not answer; 1 others do",
             "site_node --list-cameras"},
            {"SmallMtu",
             "mtu_small",
             [](FakeHost& host, Options&) { host.write("/sys/class/net/eth1/mtu", "1500"); },
             "The MTU of eth1, which has cameras, is 1500; they want 9000",
             "sudo ip link set dev eth1 mtu 9000",
             "ATTR{mtu}=\"9000\""},
            {"SmallMtuOfTheOnlyCard",
             "mtu_small",
             [](FakeHost& host, Options&) {
                 host.set_cameras({{"10.0.0.11", "101"}});
             },
             "are lost sooner. All hosts and switches of its network need it, too.",
             "sudo ip link set dev eth0 mtu 9000"},
            {"MixedMtuWithTheCardOfHosts",
             "mtu_mixed",
             [](FakeHost& host, Options&) {
                 host.set_cameras({{"10.0.0.11", "101"}, {"192.168.1.12", "102"}});
             },
             "want 9000. All hosts and switches of its network need it, too.",
             "sudo ip link set dev eth0 mtu 9000"},
            {"MixedMtu",
             "mtu_mixed",
             [](FakeHost& host, Options&) {
                 host.write("/sys/class/net/eth2/flags", "0x1003");
                 host.write("/sys/class/net/eth2/mtu", "1500");
                 host.addresses.push_back({"eth2", 0xC0A80201, 24});
                 host.set_cameras({{"192.168.1.11", "101"}, {"192.168.2.11", "102"}});
             },
             "The MTU of eth2 is 1500, that of eth1 is 9000",
             "sudo ip link set dev eth2 mtu 9000",
             "KERNEL==\"eth2\""},
            {"CamerasExceedLink",
             "cameras_exceed_link",
             [](FakeHost& host, Options& options) { options.file = host.write_site(100.0); },
             "The cameras at eth1 send 1600 Mbit/s at 100 Hz; its link of 1000 Mbit/s carries 900",
             "site.toml --capture.rate_hz 56"},
            {"StrictReversePath",
             "reverse_path_strict",
             [](FakeHost& host, Options&) {
                 host.write("/proc/sys/net/ipv4/conf/all/rp_filter", "1");
                 host.set_cameras({{"169.254.7.7", "101"}});
             },
             "rp_filter of eth1 is 1 (strict)",
             "sudo sysctl -w net/ipv4/conf/eth1/rp_filter=2",
             "/etc/sysctl.d/99-zz-atrium-rp_filter.conf"}};
}

std::vector<Fault> rights_faults() {
    return {{"NoPacketSocket",
             "no_packet_socket",
             [](FakeHost& host, Options&) { host.capabilities = 0; },
             "site_node and camera_node may not open packet sockets (no cap_net_raw)",
             "bin/site_node cap_net_raw+ep "},
            {"NoPacketSocketOfASite",
             "no_packet_socket",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_site();
                 host.capabilities_of["site_node"] = 0;
             },
             "site_node may not open packet sockets",
             "sudo setcap cap_net_raw+ep "},
            {"NoPacketSocketOfAHost",
             "no_packet_socket",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_hosts();
                 host.capabilities = 0;
             },
             "camera_node may not open packet sockets",
             "bin/camera_node"},
            {"NoRealtime",
             "no_realtime",
             [](FakeHost& host, Options&) {
                 host.write("/proc/self/limits", "Max realtime priority     0      0       \n");
             },
             "lab may use real-time priority 0 at most",
             "echo 'lab - rtprio 20' | sudo tee /etc/security/limits.d/60-atrium.conf"},
            {"UsbCameraClosed",
             "usb_camera_not_permitted",
             [](FakeHost& host, Options&) { host.write("/dev/bus/usb/002/003", "", 0660); },
             "lab may not open the USB3 Vision camera /dev/bus/usb/002/003",
             "ENV{ID_USB_INTERFACES}==\"*:ef0500:*\", GROUP=\"plugdev\", MODE=\"0660\"' | sudo tee "
             "/etc/udev/rules.d/59-atrium-cameras.rules && "},
            {"UsbCamerasClosed",
             "usb_camera_not_permitted",
             [](FakeHost& host, Options&) {
                 host.add_usb_camera("2-2", 4);
                 host.write("/dev/bus/usb/002/003", "", 0660);
                 host.write("/dev/bus/usb/002/004", "", 0660);
             },
             "cameras /dev/bus/usb/002/003, /dev/bus/usb/002/004. Log in again",
             "&& sudo usermod -aG plugdev lab"},
            {"UsbCameraClosedWithThePackage",
             "usb_camera_not_permitted",
             [](FakeHost& host, Options&) {
                 host.write("/usr/lib/udev/rules.d/60-atrium-cameras.rules", "");
                 host.write("/dev/bus/usb/002/003", "", 0660);
             },
             "lab may not open",
             "sudo udevadm control --reload && sudo udevadm trigger --subsystem-match=usb "
             "--action=change && sudo usermod -aG atrium lab"},
            {"UsbCameraClosedToTheService",
             "usb_camera_not_permitted",
             [](FakeHost& host, Options& options) {
                 options.file = host.install();
                 host.write("/dev/bus/usb/002/003", "", 0644);
             },
             "The service of the file may not open the USB3 Vision camera /dev/bus/usb/002/003.",
             "sudo udevadm trigger --subsystem-match=usb --action=change"},
            {"UsbMemory",
             "usb_memory_small",
             [](FakeHost& host, Options&) {
                 host.write("/sys/module/usbcore/parameters/usbfs_memory_mb", "16");
             },
             "share 16 MB of buffers",
             "echo 1000 | sudo tee /sys/module/usbcore/parameters/usbfs_memory_mb",
             "/etc/tmpfiles.d/atrium-usb.conf"},
            {"UsbLink",
             "usb_link_slow",
             [](FakeHost& host, Options&) { host.write("/sys/bus/usb/devices/2-1/speed", "480"); },
             "runs at 480 Mbit/s",
             "lsusb -t"}};
}

}  // namespace

std::vector<Fault> camera_faults() {
    std::vector<Fault> faults = presence_faults();
    for (Fault& fault : rights_faults()) faults.push_back(fault);
    return faults;
}

}  // namespace atrium::doctor
