#include "tools/doctor/checks/finding.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace atrium::doctor {
namespace {

constexpr std::array kKnown{
    // programs
    KnownFinding{"program_missing", Severity::kStops},
    KnownFinding{"library_missing", Severity::kStops},
    KnownFinding{"versions_mixed", Severity::kStops},
    // site file
    KnownFinding{"host_not_in_file", Severity::kStops},
    KnownFinding{"rig_unusable", Severity::kStops},
    KnownFinding{"recording_missing", Severity::kStops},
    KnownFinding{"cores_too_few", Severity::kCosts},
    KnownFinding{"nice_not_permitted", Severity::kCosts},
    // network
    KnownFinding{"no_network_card", Severity::kStops},
    KnownFinding{"card_missing", Severity::kStops},
    KnownFinding{"card_chosen_by_chance", Severity::kNote},
    KnownFinding{"card_without_multicast", Severity::kStops},
    KnownFinding{"no_multicast_route", Severity::kNote},
    KnownFinding{"multicast_not_heard", Severity::kStops},
    KnownFinding{"receive_buffer_small", Severity::kCosts},
    KnownFinding{"send_buffer_small", Severity::kCosts},
    KnownFinding{"fragments_kept_long", Severity::kCosts},
    KnownFinding{"fragment_memory_small", Severity::kCosts},
    KnownFinding{"link_slow", Severity::kCosts},
    KnownFinding{"link_half_duplex", Severity::kCosts},
    KnownFinding{"card_loses_packets", Severity::kCosts},
    KnownFinding{"cable_bad", Severity::kCosts},
    KnownFinding{"cards_in_one_subnet", Severity::kCosts},
    KnownFinding{"firewall_drops_dds", Severity::kStops},
    KnownFinding{"firewall_drops_cameras", Severity::kStops},
    // cameras
    KnownFinding{"no_camera", Severity::kStops},
    KnownFinding{"camera_missing", Severity::kStops},
    KnownFinding{"mtu_small", Severity::kCosts},
    KnownFinding{"mtu_mixed", Severity::kCosts},
    KnownFinding{"cameras_exceed_link", Severity::kCosts},
    KnownFinding{"reverse_path_strict", Severity::kCosts},
    KnownFinding{"no_packet_socket", Severity::kCosts},
    KnownFinding{"no_realtime", Severity::kCosts},
    KnownFinding{"usb_camera_not_permitted", Severity::kStops},
    KnownFinding{"usb_memory_small", Severity::kCosts},
    KnownFinding{"usb_link_slow", Severity::kCosts},
    // clock
    KnownFinding{"no_time_daemon", Severity::kCosts},
    KnownFinding{"clock_unsynchronised", Severity::kCosts},
    KnownFinding{"clock_error_large", Severity::kCosts},
    KnownFinding{"two_time_daemons", Severity::kCosts},
    // graphics
    KnownFinding{"no_gpu", Severity::kCosts},
    KnownFinding{"gpu_without_driver", Severity::kCosts},
    KnownFinding{"gpu_not_permitted", Severity::kCosts},
    KnownFinding{"egl_driver_missing", Severity::kCosts},
    KnownFinding{"renderer_is_software", Severity::kCosts},
    // load
    KnownFinding{"cpu_busy", Severity::kCosts},
    KnownFinding{"cpu_powersave", Severity::kCosts},
    KnownFinding{"cpu_capped", Severity::kCosts},
    KnownFinding{"cpu_throttled", Severity::kCosts},
    KnownFinding{"cpu_quota", Severity::kCosts},
    KnownFinding{"memory_low", Severity::kCosts},
    KnownFinding{"swap_used", Severity::kNote},
    KnownFinding{"program_runs_twice", Severity::kNote},
    // disk
    KnownFinding{"folder_not_writable", Severity::kStops},
    KnownFinding{"cache_not_writable", Severity::kCosts},
    KnownFinding{"disk_full", Severity::kStops},
    KnownFinding{"disk_slow", Severity::kCosts},
    // keys
    KnownFinding{"keys_missing", Severity::kStops},
    KnownFinding{"openssl_missing", Severity::kNote},
    KnownFinding{"key_expired", Severity::kStops},
    KnownFinding{"key_not_yet_valid", Severity::kStops},
    KnownFinding{"key_expires_soon", Severity::kNote},
    KnownFinding{"private_key_readable", Severity::kNote},
    KnownFinding{"bundle_not_usable", Severity::kStops},
};

bool is_plain(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./:=@%+,").find(c) != std::string_view::npos;
}

}  // namespace

std::span<const KnownFinding> known_findings() { return kKnown; }

Finding make_finding(std::string id, std::string text, std::string cure, std::string keep) {
    const auto known = std::find_if(
        kKnown.begin(), kKnown.end(), [&](const KnownFinding& one) { return id == one.id; });
    assert(known != kKnown.end());
    return {std::move(id), known->severity, std::move(text), std::move(cure), std::move(keep)};
}

const char* name_of(Severity severity) {
    constexpr std::array kNames{"stops", "costs", "note"};
    return kNames[static_cast<std::size_t>(severity)];
}

std::string shell_word(const std::string& word) {
    if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
    std::string text = "'";
    for (const char c : word) {
        if (c == '\'') {
            text += "'\\''";
        } else {
            text += c < ' ' && c >= 0 ? '?' : c;
        }
    }
    return text + "'";
}

std::string write_line(const std::string& line, const std::string& file) {
    return fmt::format("echo {} | sudo tee {}", shell_word(line), shell_word(file));
}

std::string set_sysctl(const std::string& name, const std::string& value) {
    return fmt::format("sudo sysctl -w {}={}", shell_word(name), value);
}

std::string keep_sysctl(const std::string& name, const std::string& value) {
    return write_line(fmt::format("{} = {}", name, value),
                      // after all others, also 99-sysctl.conf
                      fmt::format("/etc/sysctl.d/99-zz-atrium-{}.conf",
                                  name.substr(name.find_last_of("./") + 1)));
}

std::string size_text(std::uint64_t bytes) {
    constexpr std::array kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
    auto value = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; value >= 1024.0 && unit + 1 < kUnits.size(); ++unit) value /= 1024.0;
    return fmt::format("{:.3g} {}", value, kUnits[unit]);
}

}  // namespace atrium::doctor
