#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::doctor {
namespace {

std::string driver_of(const std::string& vendor) {
    if (vendor == "0x10de") return "nvidia-driver";
    if (vendor == "0x1002") return "firmware-amd-graphics";
    return "firmware-misc-nonfree";
}

std::string component_of(const std::string& vendor) {
    return vendor == "0x10de" ? "non-free" : "non-free-firmware";
}

}  // namespace

Findings check_graphics(const Facts& facts) {
    Findings findings;
    if (!facts.roles.viewer) return findings;
    const GraphicsFacts& graphics = facts.graphics;
    const auto add = [&](const char* id, std::string text, std::string cure) {
        findings.push_back(make_finding(id, std::move(text), std::move(cure)));
    };
    if (graphics.nodes.empty()) {
        if (!graphics.vendor_without_driver.empty()) {
            add("gpu_without_driver",
                fmt::format("The GPU (PCI vendor {}) has no driver: the processor draws, a few "
                            "pictures per second. Debian has it in {}, which "
                            "/etc/apt/sources.list must name.",
                            graphics.vendor_without_driver,
                            component_of(graphics.vendor_without_driver)),
                fmt::format("sudo apt install {} && sudo reboot",
                            driver_of(graphics.vendor_without_driver)));
        } else {
            add("no_gpu",
                "This host shows no GPU (no /dev/dri/renderD*): the processor draws, a few "
                "pictures "
                "per second.",
                path_of(facts, "viewer") + " --view.width 640 --view.height 360");
        }
        return findings;
    }
    if (!graphics.closed_nodes.empty()) {
        add("gpu_not_permitted",
            fmt::format(
                "{} may not open the GPU ({}): the processor draws. Log in again afterwards.",
                facts.user.name,
                fmt::join(graphics.closed_nodes, ", ")),
            fmt::format("sudo usermod -aG render,video {}", shell_word(facts.user.name)));
        return findings;
    }
    if (graphics.is_hardware != false) return findings;
    if (graphics.reason.find("no driver for rendering") != std::string::npos ||
        graphics.reason.find("libEGL") != std::string::npos) {
        add("egl_driver_missing",
            fmt::format("There is a GPU, but no EGL driver ({}).", graphics.reason),
            "sudo apt install libegl1 libegl-mesa0 libgl1-mesa-dri");
    } else {
        add("renderer_is_software",
            fmt::format("There is a GPU ({}), but pictures are drawn in software ({}).",
                        fmt::join(graphics.nodes, ", "),
                        graphics.reason),
            "sudo apt install libgl1-mesa-dri mesa-utils && eglinfo -B");
    }
    return findings;
}

}  // namespace atrium::doctor
