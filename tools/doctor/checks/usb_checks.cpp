#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::doctor {
namespace {

constexpr std::uint64_t kUsbMemory_mb = 200;
constexpr int kUsb3_mbit = 5000;
// As deploy/packages/60-atrium-cameras.rules, which goes after it and wins once it is installed.
constexpr const char* kRule =
    "SUBSYSTEM==\"usb\", ENV{DEVTYPE}==\"usb_device\", ACTION!=\"remove\", "
    "ENV{ID_USB_INTERFACES}==\"*:ef0500:*\", GROUP=\"plugdev\", MODE=\"0660\"";
constexpr const char* kRuleFile = "/etc/udev/rules.d/59-atrium-cameras.rules";
constexpr const char* kApplyRules =
    "sudo udevadm control --reload && "
    "sudo udevadm trigger --subsystem-match=usb --action=change";

void check_permission(const Facts& facts, Findings& findings) {
    std::vector<std::string> closed;
    for (const UsbCamera& camera : facts.cameras.usb) {
        if (!camera.is_permitted) closed.push_back(camera.node);
    }
    if (closed.empty()) return;
    const bool is_service = facts.packages.runs_file;
    const auto join_group = [&](const char* group) {
        return fmt::format(" && sudo usermod -aG {} {}", group, shell_word(facts.user.name));
    };
    std::string cure = kApplyRules;
    if (!facts.packages.has_usb_rule) {
        cure = write_line(kRule, kRuleFile) + " && " + cure + join_group("plugdev");
    } else if (!is_service) {
        cure += join_group("atrium");
    }
    findings.push_back(
        make_finding("usb_camera_not_permitted",
                     fmt::format("{} may not open the USB3 Vision camera{} {}.{}",
                                 is_service ? "The service of the file" : facts.user.name,
                                 closed.size() > 1 ? "s" : "",
                                 fmt::join(closed, ", "),
                                 is_service ? "" : " Log in again afterwards."),
                     cure));
}

void check_speed(const CameraFacts& cameras, Findings& findings) {
    for (const UsbCamera& camera : cameras.usb) {
        if (camera.speed_mbit <= 0 || camera.speed_mbit >= kUsb3_mbit) continue;
        findings.push_back(make_finding(
            "usb_link_slow",
            fmt::format("The USB3 Vision camera {} runs at {} Mbit/s; USB 3 has {}: use a USB 3 "
                        "port (blue) and cable.",
                        camera.node,
                        camera.speed_mbit,
                        kUsb3_mbit),
            "lsusb -t"));
    }
}

void check_usb_memory(const CameraFacts& cameras, Findings& findings) {
    const auto& memory = cameras.usb_memory_mb;
    // 0: no limit
    if (cameras.usb.empty() || !memory || *memory == 0 || *memory >= kUsbMemory_mb) return;
    constexpr const char* kFile = "/sys/module/usbcore/parameters/usbfs_memory_mb";
    findings.push_back(make_finding(
        "usb_memory_small",
        fmt::format("All USB cameras share {} MB of buffers; wanted are 1000: pictures are lost.",
                    *memory),
        write_line("1000", kFile),
        write_line(fmt::format("w {} - - - - 1000", kFile), "/etc/tmpfiles.d/atrium-usb.conf")));
}

}  // namespace

Findings check_usb_cameras(const Facts& facts) {
    Findings findings;
    check_permission(facts, findings);
    check_speed(facts.cameras, findings);
    check_usb_memory(facts.cameras, findings);
    return findings;
}

}  // namespace atrium::doctor
